// A surfel as a disc on the screen: which pixels it covers and at which depth.

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
    vec2 middle = pixel_of(centre);
    // The sphere around the disc, as its nearer side projects it, longer the farther off the axis:
    // its tangents from the eye meet the picture within r / cos(theta) / (z - r) of its middle.
    vec2 slope = view_is_orthographic() ? vec2(0.0) : centre.xy / centre.z;
    vec2 reach = splat.radius * pixels_per_metre(max(centre.z - splat.radius, kNearDepth)) *
                 sqrt(1.0 + slope * slope);
    vec2 low = clamp(floor(middle - reach), vec2(0.0), vec2(view.width, view.height));
    vec2 high = clamp(floor(middle + reach), vec2(-1.0), vec2(view.width, view.height) - 1.0);
    splat.lowest = ivec2(low);
    splat.highest = ivec2(high);
    return all(lessThanEqual(splat.lowest, splat.highest));
}

// Depth of the disc at a pixel and its weight there, 1 in the middle and 0 at the rim.
bool splat_at(Splat splat, ivec2 pixel, out float depth, out float weight) {
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
    float rim = 1.0 - dot(offset, offset) / (splat.radius * splat.radius);
    weight = rim * rim * rim * rim;
    return rim > 0.0 && depth > kNearDepth;
}
