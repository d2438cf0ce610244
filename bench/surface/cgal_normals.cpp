#include "cgal_normals.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/pca_estimate_normals.h>
#include <CGAL/property_map.h>

#include <utility>

namespace glowworm::bench {

std::vector<Vec3f> cgal_normals(std::span<const Vec3f> positions, int k) {
    using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
    using Pair = std::pair<Kernel::Point_3, Kernel::Vector_3>;
    std::vector<Pair> points;
    points.reserve(positions.size());
    for (const Vec3f& p : positions)
        points.emplace_back(Kernel::Point_3(p.x, p.y, p.z), CGAL::NULL_VECTOR);
    CGAL::pca_estimate_normals<CGAL::Parallel_tag>(
        points, static_cast<unsigned int>(k),
        CGAL::parameters::point_map(CGAL::First_of_pair_property_map<Pair>())
            .normal_map(CGAL::Second_of_pair_property_map<Pair>()));
    std::vector<Vec3f> normals;
    normals.reserve(points.size());
    for (const auto& [point, normal] : points) {
        normals.push_back({static_cast<float>(normal.x()), static_cast<float>(normal.y()),
                           static_cast<float>(normal.z())});
    }
    return normals;
}

}  // namespace glowworm::bench
