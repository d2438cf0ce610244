#include "preprocess/points.h"

namespace glowworm {
namespace {

/// Calls `visit` with each column of `a` and the same column of `b`.
template <typename A, typename B, typename Visit>
void for_each_column(A& a, B& b, Visit visit) {
    visit(a.positions, b.positions);
    visit(a.normals, b.normals);
    visit(a.colours, b.colours);
    visit(a.intensities, b.intensities);
    visit(a.ndf_lengths, b.ndf_lengths);
    visit(a.radii, b.radii);
    visit(a.stations, b.stations);
    visit(a.emissions, b.emissions);
    visit(a.times, b.times);
    visit(a.grid, b.grid);
}

}  // namespace

Points Points::select(const std::vector<std::uint32_t>& indices) const {
    Points chosen;
    for_each_column(*this, chosen, [&](const auto& from, auto& to) {
        if (from.empty()) return;
        to.reserve(indices.size());
        for (const std::uint32_t index : indices)
            to.push_back(from[index]);
    });
    return chosen;
}

void Points::append(const Points& other) {
    if (other.empty()) return;
    const bool first = empty();
    for_each_column(*this, other, [&](auto& to, const auto& from) {
        if (!first && to.empty() != from.empty()) {
            to.clear();
            return;
        }
        to.insert(to.end(), from.begin(), from.end());
    });
}

}  // namespace glowworm
