// From exposed linear Rec.709 to what a display shows, still linear, 0..1.
#define TONE_LINEAR 0u
#define TONE_REINHARD 1u
#define TONE_ACES 2u
#define TONE_AGX 3u

const float kReinhardWhite = 4.0;   // the luminance that becomes 1

float luminance(vec3 color) { return dot(color, vec3(0.2126, 0.7152, 0.0722)); }

// Reinhard et al. 2002, equation 4, on luminance.
vec3 reinhard(vec3 color) {
    float l = luminance(color);
    return color * ((1.0 + l / (kReinhardWhite * kReinhardWhite)) / (1.0 + l));
}

// Stephen Hill's fit of the ACES reference and sRGB output transforms.
vec3 aces(vec3 color) {
    const mat3 to_aces = mat3(0.59719, 0.07600, 0.02840, 0.35458, 0.90834, 0.13383, 0.04823, 0.01566,
                              0.83777);
    const mat3 to_srgb = mat3(1.60475, -0.10208, -0.00327, -0.53108, 1.10813, -0.07276, -0.07367,
                              -0.00605, 1.07602);
    vec3 v = to_aces * color;
    return to_srgb * ((v * (v + 0.0245786) - 0.000090537) /
                      (v * (0.983729 * v + 0.4329510) + 0.238081));
}

// Troy Sobotka's AgX, base look, with Benjamin Wrensch's polynomial for its curve.
vec3 agx(vec3 color) {
    const mat3 inset = mat3(0.842479062253094, 0.0423282422610123, 0.0423756549057051,
                            0.0784335999999992, 0.878468636469772, 0.0784336, 0.0792237451477643,
                            0.0791661274605434, 0.879142973793104);
    const mat3 outset = mat3(1.19687900512017, -0.0528968517574562, -0.0529716355144438,
                             -0.0980208811401368, 1.15190312990417, -0.0980434501171241,
                             -0.0990297440797205, -0.0989611768448433, 1.15107367264116);
    const float least = -12.47393, most = 4.026069;   // stops
    vec3 x = (clamp(log2(max(inset * color, 1e-10)), least, most) - least) / (most - least);
    vec3 x2 = x * x, x4 = x2 * x2;
    vec3 curve = 15.5 * x4 * x2 - 40.14 * x4 * x + 31.96 * x4 - 6.868 * x2 * x + 0.4298 * x2 +
                 0.1191 * x - 0.00232;
    return pow(max(outset * curve, 0.0), vec3(2.2));
}

vec3 tone_curve(uint name, vec3 color) {
    color = max(color, 0.0);
    if (name == TONE_REINHARD) color = reinhard(color);
    if (name == TONE_ACES) color = aces(color);
    if (name == TONE_AGX) color = agx(color);
    return clamp(color, 0.0, 1.0);
}

vec3 srgb_encoded(vec3 linear) {
    return mix(1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055, linear * 12.92,
               lessThanEqual(linear, vec3(0.0031308)));
}
