// Pixels that only the outer parts of discs reach: the surface's edge is nearer to their centres.
// Random points leave such pixels, and some that nothing reaches, inside a surface as well: with
// that surface on both sides along most lines they are no edge; what was reached stays, and larger
// discs close the rest.
// A pixel's rim: depth of the disc whose outer part is all that reaches it, 0 for none.
CONSTANT float kGap = 1e-6f;          // m, instead of a depth: nothing reaches it, inside of a surface
CONSTANT float kGapGrowth = 1.75f;    // of discs that close gaps
// Sum of weights of a rim. Inside a surface of random points it is 1.8 in the mean (splat scale 3).
CONSTANT float kRimCover = 0.2f;
CONSTANT float kBehind = 2.0f;   // radii: nearer, a disc may stick out of a surface that the rim ends at

// What lies behind a rim or closes a gap: how far off its middle squared a disc counts, 0 where it
// does not. First when the nearest is sought, then when what is as near as it is averaged.
float reach_behind(float rim, float depth, float radius) {
    if (rim == kGap) return kGapGrowth * kGapGrowth;
    return rim > 0.0f && depth - rim > kBehind * radius ? 1.0f : 0.0f;
}

float reach_beside(float rim, float behind, float radius) {
    if (rim == kGap) return kGapGrowth * kGapGrowth;
    return rim > 0.0f && behind > -0.01f * radius ? 1.0f : 0.0f;   // the rim lies farther in front
}

bool is_outside(ivec2 at) {
    return any(lessThan(at, ivec2(0))) ||
           any(greaterThanEqual(at, ivec2(view.width, view.height)));
}
