#include "peers.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/pca_estimate_normals.h>
#include <CGAL/property_map.h>
#include <pcl/features/normal_3d_omp.h>
#include <pcl/search/kdtree.h>

#include <utility>

namespace glowworm::bench {

std::vector<Vec3f> pcl_normals(std::span<const Vec3f> positions, int k, int threads) {
    const auto cloud = pcl::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
    cloud->reserve(positions.size());
    for (const Vec3f& p : positions)
        cloud->push_back({p.x, p.y, p.z});
    pcl::NormalEstimationOMP<pcl::PointXYZ, pcl::Normal> estimation(
        static_cast<unsigned int>(threads));
    estimation.setInputCloud(cloud);
    estimation.setSearchMethod(pcl::make_shared<pcl::search::KdTree<pcl::PointXYZ>>());
    estimation.setKSearch(k);
    pcl::PointCloud<pcl::Normal> found;
    estimation.compute(found);
    std::vector<Vec3f> normals;
    normals.reserve(found.size());
    for (const pcl::Normal& n : found)
        normals.push_back({n.normal_x, n.normal_y, n.normal_z});
    return normals;
}

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
