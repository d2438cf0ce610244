#include "preprocess/register/features.h"

#include <pcl/features/fpfh.h>
#include <pcl/point_types.h>

#include <cmath>

#include "preprocess/clean.h"

namespace glowworm {
namespace {

constexpr double kKeypointSpacing = 2.0;   // in sample spacings
constexpr double kFeatureRadius = 6.0;     // in sample spacings
constexpr std::size_t kFewestAround = 20;  // a disc of that radius holds about 110

}  // namespace

Keypoints describe(const SurfaceSamples& samples) {
    Keypoints keypoints;
    const float radius = static_cast<float>(kFeatureRadius * samples.spacing);
    const pcl::IndicesPtr chosen(new pcl::Indices);
    for (const std::uint32_t i :
         thin_indices(samples.positions, kKeypointSpacing * samples.spacing)) {
        Neighbour around[kFewestAround];
        if (samples.tree.nearest(samples.positions[i], around, radius) < kFewestAround) continue;
        chosen->push_back(static_cast<pcl::index_t>(i));
        keypoints.positions.push_back(samples.positions[i]);
        keypoints.normals.push_back(samples.normals[i]);
    }
    if (chosen->empty()) return keypoints;

    const pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
    const pcl::PointCloud<pcl::Normal>::Ptr normals(new pcl::PointCloud<pcl::Normal>);
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const Vec3f p = samples.positions[i], n = samples.normals[i];
        cloud->push_back({p.x, p.y, p.z});
        normals->push_back({n.x, n.y, n.z});
    }
    pcl::FPFHEstimation<pcl::PointXYZ, pcl::Normal, pcl::FPFHSignature33> estimation;
    estimation.setInputCloud(cloud);
    estimation.setInputNormals(normals);
    estimation.setIndices(chosen);
    estimation.setRadiusSearch(static_cast<double>(radius));
    pcl::PointCloud<pcl::FPFHSignature33> histograms;
    estimation.compute(histograms);

    keypoints.descriptors.resize(static_cast<Eigen::Index>(chosen->size()), 33);
    for (std::size_t i = 0; i < chosen->size(); ++i) {
        for (int bin = 0; bin < 33; ++bin) {
            const float share = histograms[i].histogram[bin] / 100.0f;
            keypoints.descriptors(static_cast<Eigen::Index>(i), bin) =
                std::isfinite(share) ? std::sqrt(std::max(share, 0.0f)) : 0.0f;
        }
    }
    return keypoints;
}

}  // namespace glowworm
