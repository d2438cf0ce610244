#include "preprocess/surface/flann_neighbours.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <flann/flann.hpp>

#include "preprocess/surface/neighbours.h"

namespace glowworm {

std::vector<std::uint32_t> flann_neighbours(const PointTree& tree, int count, float radius) {
    const std::size_t n = tree.size();
    const auto stride = static_cast<std::size_t>(count);
    std::vector<std::uint32_t> rows(n * stride, kNoNeighbour);
    if (n == 0) return rows;
    std::vector<float> coordinates(3 * n);
    for (std::size_t i = 0; i < n; ++i) {
        coordinates[3 * i] = tree.x[i];
        coordinates[3 * i + 1] = tree.y[i];
        coordinates[3 * i + 2] = tree.z[i];
    }
    flann::Index<flann::L2_Simple<float>> index(flann::Matrix<float>(coordinates.data(), n, 3),
                                                flann::KDTreeSingleIndexParams(15));
    index.buildIndex();

    flann::SearchParams parameters(flann::FLANN_CHECKS_UNLIMITED, 0.0f, true);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, 1024), [&](const auto& range) {
        // One more than wanted, because the point itself is among its neighbours.
        std::vector<std::size_t> indices(stride + 1);
        std::vector<float> distances(stride + 1);
        flann::Matrix<std::size_t> index_row(indices.data(), 1, stride + 1);
        flann::Matrix<float> distance_row(distances.data(), 1, stride + 1);
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
            flann::Matrix<float> query(coordinates.data() + 3 * i, 1, 3);
            const int found =
                index.knnSearch(query, index_row, distance_row, stride + 1, parameters);
            std::size_t column = 0;
            for (std::size_t j = 0; j < static_cast<std::size_t>(found); ++j) {
                if (indices[j] == i || column == stride || distances[j] > radius * radius) continue;
                rows[i * stride + column++] = static_cast<std::uint32_t>(indices[j]);
            }
        }
    });
    return rows;
}

}  // namespace glowworm
