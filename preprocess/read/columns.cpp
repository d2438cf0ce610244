#include "preprocess/read/columns.h"

#include <algorithm>
#include <array>
#include <string>

namespace glowworm {
namespace {

struct Spelling {
    std::string_view name;  // lower case, letters and digits only
    Column column;
};

// The first spelling of a column that is also in kNames is how we write it.
constexpr Spelling kSpellings[] = {
    {"x", Column::kX},
    {"y", Column::kY},
    {"z", Column::kZ},
    {"easting", Column::kX},
    {"northing", Column::kY},
    {"elevation", Column::kZ},
    {"height", Column::kZ},
    {"nx", Column::kNormalX},
    {"ny", Column::kNormalY},
    {"nz", Column::kNormalZ},
    {"normalx", Column::kNormalX},
    {"normaly", Column::kNormalY},
    {"normalz", Column::kNormalZ},
    {"red", Column::kRed},
    {"green", Column::kGreen},
    {"blue", Column::kBlue},
    {"r", Column::kRed},
    {"g", Column::kGreen},
    {"b", Column::kBlue},
    {"diffusered", Column::kRed},
    {"diffusegreen", Column::kGreen},
    {"diffuseblue", Column::kBlue},
    {"rgb", Column::kPackedRgb},
    {"rgba", Column::kPackedRgb},
    {"intensity", Column::kIntensity},
    {"intensities", Column::kIntensity},
    {"i", Column::kIntensity},
    {"reflectance", Column::kIntensity},
    {"reflectivity", Column::kIntensity},
    {"amplitude", Column::kIntensity},
    {"ndf", Column::kNdf},
    {"radius", Column::kRadius},
    {"station", Column::kStation},
    {"emissionr", Column::kEmissionR},
    {"emissiong", Column::kEmissionG},
    {"emissionb", Column::kEmissionB},
    {"time", Column::kTime},
    {"gpstime", Column::kTime},
    {"timestamp", Column::kTime},
};

constexpr std::array<std::string_view, 18> kNames = {
    "",    "x",      "y",       "z",          "nx",         "ny",
    "nz",  "red",    "green",   "blue",       "rgb",        "intensity",
    "ndf", "radius", "station", "emission_r", "emission_g", "emission_b"};

}  // namespace

Column column_named(std::string_view name) {
    std::string plain;
    for (const char c : name) {
        if (c >= 'A' && c <= 'Z') plain += static_cast<char>(c - 'A' + 'a');
        if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) plain += c;
    }
    // CloudCompare writes every scalar field of its own as scalar_NAME.
    constexpr std::string_view kScalar = "scalar";
    if (plain.starts_with(kScalar)) plain.erase(0, kScalar.size());
    const auto found = std::ranges::find(kSpellings, std::string_view(plain), &Spelling::name);
    return found == std::end(kSpellings) ? Column::kNone : found->column;
}

std::string_view column_name(Column column) {
    return column == Column::kTime ? "time" : kNames[static_cast<std::size_t>(column)];
}

}  // namespace glowworm
