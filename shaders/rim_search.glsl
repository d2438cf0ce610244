// Which pixels are rims. Reads the pixels around: is_solid(pixel), more than a rim, and
// depth_at(pixel), m.
CONSTANT int kSearchSteps = 10;
CONSTANT float kSameDepth = 0.05f;   // relative: how far off the line between its sides a surface runs

// 1, 2, 3, 4, 6, 8, 12, 16, 24, 32
int search_pixels(int step) {
    return step < 4 ? step + 1 : (3 + (step & 1)) << (step / 2 - 1);
}

// The nearest solid pixel that way: how far it is, 0 where there is none, -1 where the picture ends.
int solid_side(ivec2 from, ivec2 direction, OUT(float) inverse_depth) {
    inverse_depth = 0.0f;
    for (int i = 0; i < kSearchSteps; ++i) {
        ivec2 at = from + direction * search_pixels(i);
        if (is_outside(at)) return -1;
        uint pixel = uint(at.y) * view.width + uint(at.x);
        if (!is_solid(pixel)) continue;
        inverse_depth = 1.0f / depth_at(pixel);
        return search_pixels(i);
    }
    return 0;
}

// Whether a surface goes on over this pixel along three of four lines. `depth` is what is known of it
// there, 0 for nothing.
bool is_inside(ivec2 at, float depth) {
    int inside = 0;
    for (int i = 0; i < 4 && inside + 4 - i >= 3; ++i) {
        ivec2 line = ivec2(i == 1 ? 0 : 1, i == 0 ? 0 : i == 3 ? -1 : 1);
        float before, after;
        int steps_before = solid_side(at, -line, before);
        if (steps_before == 0) continue;
        int steps_after = solid_side(at, line, after);
        if (max(steps_before, steps_after) <= 0 || steps_after == 0) continue;
        // Planes are straight in the inverse of depth.
        float between = steps_before < 0  ? after
                        : steps_after < 0 ? before
                                          : mix(before, after, float(steps_before) /
                                                                   float(steps_before + steps_after));
        if (depth > 0.0f && abs(depth * between - 1.0f) > kSameDepth) continue;
        ++inside;
    }
    return inside >= 3;
}

// The rim at a pixel that is not solid; `depth` of what reaches it, 0 where nothing does.
float find_rim(ivec2 at, float depth) {
    bool inside = is_inside(at, depth);
    if (depth > 0.0f) return inside ? 0.0f : depth;
    return inside ? kGap : 0.0f;
}
