#ifndef GLOSSY_GLSL
#define GLOSSY_GLSL
// The film of water on a wet wall: a GGX lobe over the wall's own Lambertian one.

CONSTANT float kWaterReflectance = 0.02f;   // of a film of water met head-on
CONSTANT float kFilmExponent = 800.0f;      // Blinn-Phong: how sharply a flat film mirrors

// Width of the lobe, GGX's alpha, 0..1: Toksvig 2005 spreads a film over normals whose mean has
// length `ndf_length`; alpha^2 = 2 / (exponent + 2) (Walter et al. 2007).
float glossy_alpha(float ndf_length) {
    float even = clamp(ndf_length, 0.0f, 1.0f);   // what is summed up may round beyond
    float exponent = even * kFilmExponent / (even + kFilmExponent * (1.0f - even));
    return sqrt(2.0f / (exponent + 2.0f));
}

// A blended normal may turn away from an eye that sees its surface: bent back, so that silhouettes
// mirror what lies beyond them instead of the rock.
vec3 film_normal(vec3 normal, vec3 to_eye) {
    CONSTANT float least = 0.1f;
    float cosine = dot(normal, to_eye);
    return cosine < least ? normalize(normal + (least - cosine) * to_eye) : normal;
}

// Schlick 1994.
float film_reflectance(float cosine) {
    float grazing = 1.0f - clamp(cosine, 0.0f, 1.0f);
    float squared = grazing * grazing;
    return kWaterReflectance + (1.0f - kWaterReflectance) * squared * squared * grazing;
}

// Radiance toward `to_eye` per irradiance from `to_light`, 1/sr; all unit (Walter et al. 2007, with
// Smith's masking of light and eye together).
float glossy_reflection(vec3 normal, vec3 to_eye, vec3 to_light, float alpha) {
    vec3 half_way = normalize(to_eye + to_light);
    float n_l = max(dot(normal, to_light), 1e-4f), n_v = max(dot(normal, to_eye), 1e-4f);
    float n_h = clamp(dot(normal, half_way), 0.0f, 1.0f);
    float a2 = alpha * alpha;
    float facing = n_h * n_h * (a2 - 1.0f) + 1.0f;
    float spread = a2 / (3.14159265359f * facing * facing);
    float masked = 0.5f / (n_l * sqrt(n_v * n_v * (1.0f - a2) + a2) +
                          n_v * sqrt(n_l * n_l * (1.0f - a2) + a2));
    return spread * masked * film_reflectance(dot(to_eye, half_way));
}
#endif
