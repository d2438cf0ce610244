// A surfel as a disc on the screen: which pixels it covers and at which depth.
#ifndef FLOATS
#define FLOATS float   // or those of some pixels beside each other (viewer/gpu/lanes.h)
#endif
CONSTANT float kNearDepth = 0.02f;         // m: what is nearer is not drawn
CONSTANT float kSmallestRadius = 0.75f;    // pixels: a disc covers at least the pixel it lies in
CONSTANT float kFlattestCosine = 0.15f;    // a disc seen more edge-on is tilted this far toward the eye

CONSTANT float kLeastWeight = 1.0f / 1024.0f;   // so that what is covered has a weight

// With e the pixels from `middle`, a ray meets the disc's plane where `lean`, 1 + slope . e, divides
// the centre's depth. There it lies e' form e / lean^2 off the middle, squared, 1 at the radius: an
// ellipse. Orthographic: lean is 1, and depth grows by slope . e.
struct Splat {
    vec2 middle;     // pixels: where its centre lies
    float depth;     // m: that of its centre
    float radius;    // m, of the drawn disc
    vec2 slope;      // per pixel; orthographic: m per pixel
    vec3 form;       // xx, xy, yy: per pixel squared
};

#ifndef IS_HIDDEN
#define IS_HIDDEN(centre, radius) false   // whether a sphere is known to lie behind what is drawn
#endif

// Whether a sphere lies outside the pyramid of a pinhole's picture: one beside the eye, barely in front
// of it, would be taken to reach across the whole picture.
bool beside_picture(vec3 centre, float radius) {
    if (view_is_orthographic()) return false;
    vec2 axis = vec2(view.down.w, view.forward.w);
    vec2 lowest = -axis / view.position.w;
    vec2 highest = (vec2(view.width, view.height) - axis) / view.position.w;
    vec2 before = lowest * centre.z - vec2(centre), after = vec2(centre) - highest * centre.z;
    return any(greaterThan(before, radius * sqrt(1.0f + lowest * lowest))) ||
           any(greaterThan(after, radius * sqrt(1.0f + highest * highest)));
}

// The pixels within which a sphere lies: lowest, highest. A pinhole's are bounded by the tangents
// from the eye, (x z -+ r sqrt(x^2 + z^2 - r^2)) / (z^2 - r^2), where it is wholly in front.
vec4 picture_of_sphere(vec3 centre, float radius) {
    vec2 axis = vec2(view.down.w, view.forward.w), size = vec2(view.width, view.height);
    if (view_is_orthographic()) {
        vec2 middle = pixel_of(centre);
        return vec4(middle - radius * view.position.w, middle + radius * view.position.w);
    }
    if (beside_picture(centre, radius)) return vec4(size, vec2(-1.0f));
    float ahead = centre.z * centre.z - radius * radius;
    if (centre.z <= radius || ahead <= 0.0f) return vec4(vec2(0.0f), size);
    vec2 across = vec2(centre);
    vec2 spread = radius * sqrt(across * across + ahead);
    return vec4(axis + (across * centre.z - spread) / ahead * view.position.w,
                axis + (across * centre.z + spread) / ahead * view.position.w);
}

// `centre` lies in front of the eye. False where the disc is turned away.
bool make_splat(vec3 centre, vec3 normal, float radius, OUT(Splat) splat) {
    bool orthographic = view_is_orthographic();
    vec3 to_eye = orthographic ? vec3(0.0f, 0.0f, -1.0f) : -normalize(centre);
    float cosine = dot(normal, to_eye);
    if (cosine < -kFlattestCosine) return false;
    if (cosine < kFlattestCosine) normal = normalize(normal + (kFlattestCosine - cosine) * to_eye);

    float pixel = 1.0f / pixels_per_metre(centre.z);   // m
    float smallest = kSmallestRadius * pixel;
    splat.middle = pixel_of(centre);
    splat.depth = centre.z;
    splat.radius = max(radius, smallest);
    splat.slope = vec2(normal) * (orthographic ? -pixel / normal.z : pixel / dot(normal, centre));
    if (radius < smallest) {   // covers by distance on the screen, and is no deeper than that
        float steepest = orthographic ? pixel : pixel / centre.z;
        splat.slope *= min(1.0f, steepest / max(length(splat.slope), 1e-30f));
        splat.form = vec3(1.0f, 0.0f, 1.0f) / (kSmallestRadius * kSmallestRadius);
    } else {   // how far a pixel's step goes on the disc's plane
        vec3 away = orthographic ? vec3(0.0f, 0.0f, 1.0f) : -centre;
        vec3 right = away * splat.slope.x + vec3(pixel, 0.0f, 0.0f);
        vec3 down = away * splat.slope.y + vec3(0.0f, pixel, 0.0f);
        splat.form = vec3(dot(right, right), dot(right, down), dot(down, down)) / (radius * radius);
    }
    return true;
}

// The disc of a surfel that is the `rank`-th of its chunk, and the surfel's normal, camera space; false
// where there is none to draw.
bool splat_of(PackedSurfel surfel, uint rank, DrawnChunk chunk, OUT(Splat) splat,
              OUT(vec3) normal) {
    if (surfel_light(surfel) != 0u) return false;   // panels are drawn as exact rectangles
    vec3 position = surfel_position(surfel, chunk.box);
    if (any(lessThan(position, vec3(view.clip_low))) ||
        any(greaterThan(position, vec3(view.clip_high)))) {
        return false;
    }
    // What lies twice as deep is dense enough with a quarter of the surfels, twice as large.
    vec3 centre = camera_from_octree(position);
    float farther = max(centre.z / chunk.full_depth, 1.0f);
    if (float(rank) * farther * farther >= float(chunk.count)) return false;
    if (centre.z <= kNearDepth) return false;
    float radius = surfel_radius(surfel) * chunk.scale * farther;
    float reach = kGapGrowth * max(radius, kSmallestRadius / pixels_per_metre(centre.z));
    if (beside_picture(centre, reach) || IS_HIDDEN(centre, reach)) return false;
    normal = camera_from_octree_direction(surfel_normal(surfel));
    return make_splat(centre, normal, radius, splat);
}

// The pixels within which a disc counts up to `reach` times its radius: lowest, highest. Those of its
// ellipse; of the sphere around it, where it reaches the plane of the eye and is none.
vec4 picture_of_disc(Splat splat, float reach) {
    vec2 s = view_is_orthographic() ? vec2(0.0f) : splat.slope;
    vec3 form = splat.form / (reach * reach) - vec3(s.x * s.x, s.x * s.y, s.y * s.y);
    float determinant = form.x * form.z - form.y * form.y;
    if (form.x <= 0.0f || determinant <= 1e-4f * form.x * form.z) {
        vec3 origin, direction;
        camera_ray(splat.middle, origin, direction);
        return picture_of_sphere(origin + direction * splat.depth, splat.radius * reach);
    }
    vec2 off = vec2(form.z * s.x - form.y * s.y, form.x * s.y - form.y * s.x) / determinant;
    vec2 extent = sqrt((1.0f + dot(s, off)) * vec2(form.z, form.x) / determinant);
    return vec4(splat.middle + off - extent, splat.middle + off + extent);
}

// The pixels that it may cover: lowest x and y, highest x and y, both included. None where it lies
// outside the picture, the highest below the lowest then.
ivec4 splat_box(Splat splat, float reach) {
    vec4 at = picture_of_disc(splat, reach);
    vec2 size = vec2(view.width, view.height);
    vec2 low = clamp(ceil(vec2(at.x, at.y) - 0.5f), vec2(0.0f), size);
    vec2 high = clamp(floor(vec2(at.z, at.w) - 0.5f), vec2(-1.0f), size - 1.0f);
    return ivec4(low, high);
}

bool is_empty_box(ivec4 box) { return box.x > box.z || box.y > box.w; }

// Where the ray through a pixel's centre (x, y) meets the disc's plane: depth, m, 0 where that is too
// near to the eye; how far off the disc's middle squared, 1 at the radius.
void splat_at(Splat splat, FLOATS x, FLOATS y, OUT(FLOATS) depth, OUT(FLOATS) off) {
    FLOATS right = x - splat.middle.x, down = y - splat.middle.y;
    FLOATS lean = splat.slope.x * right + splat.slope.y * down;
    off = (splat.form.x * right + 2.0f * splat.form.y * down) * right + splat.form.z * down * down;
    if (view_is_orthographic()) {
        depth = splat.depth + lean;
    } else {
        FLOATS inverse = 1.0f / max(1.0f + lean, 1e-9f);
        depth = splat.depth * inverse;
        off *= inverse * inverse;
    }
    depth = depth > kNearDepth ? depth : 0.0f * depth;
}

// A disc's weight: 1 in the middle, least where `off` (splat_at) reaches `most`.
FLOATS splat_weight(FLOATS off, float most) {
    FLOATS rim = 1.0f - off / most;
    FLOATS squared = rim * rim;
    return max(squared * squared, kLeastWeight);
}
