#include "octree/ray_tracer.h"

#include <random>
#include <vector>

#include "clouds.h"
#include "octree/build.h"
#include "octree/close_patches.h"
#include "testing.h"

namespace glowworm {
namespace {

/// Rays that begin in and round the cube, some along its axes, some bounded.
std::vector<Ray> rays_through(const Grid& grid, std::size_t count) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < count; ++i) {
        Ray& ray = rays.emplace_back();
        for (int a = 0; a < 3; ++a)
            ray.origin[a] = grid.cube_min[a] + grid.cube_edge * (1.2f * unit(random) - 0.1f);
        ray.direction = testing::random_direction(random);
        if (i % 16 == 0) ray.direction = {0.0f, i % 32 == 0 ? 1.0f : -1.0f, 0.0f};
        if (i % 2 == 0) ray.normal = testing::random_direction(random);
        ray.t_min = 0.5f * grid.voxel_size();
        if (i % 3 == 0) ray.t_max = grid.cube_edge * unit(random);
    }
    return rays;
}

class TracedTogether : public ::testing::TestWithParam<std::uint32_t> {};

TEST_P(TracedTogether, RaysMeetWhatEachMeetsAlone) {
    SurfelCloud cloud = testing::random_cloud(3000, 0.05f);
    BuildSettings build;
    build.depth = GetParam();
    const Octree octree = build_octree(std::move(cloud), build);
    const std::vector<Lobe> closed = close_patches(octree.view());
    OctreeView view = octree.view();
    view.lobes = closed;
    const TraceSettings settings{.patch_margin = 0.4f};
    const RayTracer tracer(view, settings);
    const std::vector<Ray> rays = rays_through(view.grid, 4000);

    std::vector<std::uint32_t> lobes(rays.size());
    tracer.trace(rays, lobes);
    std::size_t met = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        ASSERT_EQ(lobes[i], trace_ray(view, settings, rays[i]).lobe) << "ray " << i;
        met += lobes[i] < closed.size();
    }
    std::vector<ShadowRay> shadow_rays;
    for (const Ray& ray : rays) {
        ShadowRay& shadow = shadow_rays.emplace_back(ShadowRay{ray, {}});
        if (shadow_rays.size() % 4 == 0) shadow.target = {{0.0f, 0.0f, 1.0f}, 1};
    }
    std::vector<std::uint8_t> seen(rays.size());
    tracer.look(shadow_rays, seen);
    std::size_t unseen = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const ShadowTarget& target = shadow_rays[i].target;
        ASSERT_EQ(seen[i] != 0, is_unoccluded(view, settings, rays[i], target)) << "ray " << i;
        unseen += seen[i] == 0;
    }
    std::cout << met << " of " << rays.size() << " rays meet a front, " << unseen
              << " meet something\n";
    EXPECT_GT(met, rays.size() / 50);  // few where leaves are small and far apart
    EXPECT_GT(unseen, rays.size() / 50);
}

INSTANTIATE_TEST_SUITE_P(Depths, TracedTogether, ::testing::Values(0u, 1u, 2u, 3u, 5u, 8u, 11u));

TEST(RayTracer, WithoutAnOctreeNothingIsMet) {
    const RayTracer tracer({}, {});
    const std::vector<Ray> rays(3, Ray{{}, {1.0f, 0.0f, 0.0f}, {}});
    std::vector<std::uint32_t> lobes(rays.size());
    tracer.trace(rays, lobes);
    for (const std::uint32_t lobe : lobes)
        EXPECT_EQ(lobe, kNoHit);
    tracer.trace({}, {});
}

}  // namespace
}  // namespace glowworm
