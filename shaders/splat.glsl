// A surfel as a disc on the screen: which pixels it covers and at which depth.
#ifndef DISC_REACH
#define DISC_REACH 1.0   // how far beyond its radius a disc may count, over that radius
#endif

const float kNearDepth = 0.02;      // m: what is nearer is not drawn
const float kSmallestRadius = 0.75; // pixels: a disc covers at least the pixel it lies in
const float kFlattestCosine = 0.15; // a disc seen more edge-on is tilted this far toward the eye

struct Splat {
    vec3 centre;     // camera space, m
    vec3 normal;     // camera space, of the drawn disc
    float radius;    // m, of the drawn disc
    bool small;      // about a pixel: covers by distance on the screen
    ivec2 lowest;    // pixels it may cover, both ends included
    ivec2 highest;
};

// Whether a sphere lies outside the pyramid of a pinhole's picture. Without this, one beside the eye,
// barely in front of it, would be taken to reach across the whole picture.
bool beside_picture(vec3 centre, float radius) {
    if (view_is_orthographic()) return false;
    vec2 axis = vec2(view.down.w, view.forward.w);
    vec2 lowest = -axis / view.position.w;
    vec2 highest = (vec2(view.width, view.height) - axis) / view.position.w;
    vec2 before = lowest * centre.z - centre.xy, after = centre.xy - highest * centre.z;
    return any(greaterThan(before, radius * sqrt(1.0 + lowest * lowest))) ||
           any(greaterThan(after, radius * sqrt(1.0 + highest * highest)));
}

// The pixels within which a sphere lies: lowest, highest. A pinhole's are bounded by the tangents
// from the eye, (x z -+ r sqrt(x^2 + z^2 - r^2)) / (z^2 - r^2), where it is wholly in front.
vec4 picture_of_sphere(vec3 centre, float radius) {
    vec2 axis = vec2(view.down.w, view.forward.w);
    if (view_is_orthographic()) {
        vec2 middle = pixel_of(centre);
        return vec4(middle - radius * view.position.w, middle + radius * view.position.w);
    }
    float ahead = centre.z * centre.z - radius * radius;
    if (centre.z <= radius || ahead <= 0.0) return vec4(vec2(0.0), vec2(view.width, view.height));
    vec2 spread = radius * sqrt(centre.xy * centre.xy + ahead);
    vec4 slopes = vec4(centre.xy * centre.z - spread, centre.xy * centre.z + spread) / ahead;
    return axis.xyxy + slopes * view.position.w;
}

// False where nothing of the disc can be seen: behind the eye, outside the picture, turned away.
bool make_splat(vec3 centre, vec3 normal, float radius, out Splat splat) {
    if (centre.z <= kNearDepth) return false;
    vec3 to_eye = view_is_orthographic() ? vec3(0.0, 0.0, -1.0) : -normalize(centre);
    float cosine = dot(normal, to_eye);
    if (cosine < -kFlattestCosine) return false;

    splat.centre = centre;
    float scale = pixels_per_metre(centre.z);
    float pixels = radius * scale;
    splat.small = pixels < kSmallestRadius;
    splat.radius = splat.small ? kSmallestRadius / scale : radius;
    splat.normal = cosine < kFlattestCosine
                       ? normalize(normal + (kFlattestCosine - cosine) * to_eye)
                       : normal;
    float extent = splat.radius * DISC_REACH;
    if (beside_picture(centre, extent)) return false;
    vec4 reach = picture_of_sphere(centre, extent);
    vec2 low = clamp(floor(reach.xy), vec2(0.0), vec2(view.width, view.height));
    vec2 high = clamp(floor(reach.zw), vec2(-1.0), vec2(view.width, view.height) - 1.0);
    splat.lowest = ivec2(low);
    splat.highest = ivec2(high);
    return all(lessThanEqual(splat.lowest, splat.highest));
}

// The disc at a pixel: its depth, and how far from its middle squared, 1 at the radius. False where
// it is too near to the eye.
bool splat_at(Splat splat, ivec2 pixel, out float depth, out float off) {
    vec3 origin, direction;
    camera_ray(vec2(pixel) + 0.5, origin, direction);
    float steepness = dot(splat.normal, direction);
    float plane = dot(splat.normal, splat.centre - origin) / (steepness < 0.0 ? min(steepness, -1e-6) : max(steepness, 1e-6));
    vec3 offset;
    if (splat.small) {
        depth = clamp(plane, splat.centre.z - splat.radius, splat.centre.z + splat.radius);
        offset = origin + direction * splat.centre.z - splat.centre;
    } else {
        depth = plane;
        offset = origin + direction * plane - splat.centre;
    }
    off = dot(offset, offset) / (splat.radius * splat.radius);
    return depth > kNearDepth;
}

// A disc's weight: 1 in the middle, 0 where `off` (splat_at) reaches `most`.
float splat_weight(float off, float most) {
    float rim = 1.0 - off / most;
    return rim * rim * rim * rim;
}
