#include "surface/pcl_normals.h"

#include <pcl/features/normal_3d_omp.h>
#include <pcl/search/kdtree.h>

namespace glowworm::testing {

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

}  // namespace glowworm::testing
