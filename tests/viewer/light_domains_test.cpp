#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numeric>

#include "analytic_cave.h"
#include "octree/build.h"
#include "octree/coarsen.h"
#include "octree/links.h"
#include "viewer/gpu/context.h"
#include "viewer/light/domains.h"
#include "viewer/light/group_light.h"
#include "viewer/light/light_field.h"
#include "viewer/light/light_meter.h"

namespace glowworm {
namespace {

using testing::lamp_at;

Octree dogleg(std::uint32_t depth) {
    BuildSettings settings;
    settings.depth = depth;
    return build_octree(testing::dogleg(0.03f), settings);
}

double mean_of(const std::vector<gpu::vec4>& values) {
    double sum = 0.0;
    for (const gpu::vec4& value : values)
        sum += static_cast<double>(value.y);
    return sum / static_cast<double>(values.size());
}

/// The light meter on every lobe within `reach` of `eye`.
std::vector<double> measured_near(const Octree& octree, const Vec3f& eye, float reach,
                                  const LightField& field) {
    std::vector<Probe> probes;
    for (const Lobe& lobe : octree.lobes) {
        const Vec3f at{lobe.position[0], lobe.position[1], lobe.position[2]};
        if (length(at - eye) < reach)
            probes.push_back({vec3_cast<double>(at) + octree.grid.origin,
                              normalized(Vec3f{lobe.ndf[0], lobe.ndf[1], lobe.ndf[2]})});
    }
    std::vector<double> measured;
    for (const ProbeResult& result : measure_light(field, probes))
        measured.push_back(static_cast<double>(result.indirect.y));
    return measured;
}

double mean_error(const std::vector<double>& light, const std::vector<double>& truth) {
    double sum = 0.0;
    double of = 0.0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        sum += std::abs(light[i] - truth[i]);
        of += truth[i];
    }
    return sum / of;
}

TEST(LightDomains, WhereAllFitsEveryLobeHasItsOwnLightAndTheSameToTheBit) {
    const Context context = Context::headless();
    const Octree octree = dogleg(6);
    const LightDomains domains(octree.view());
    const auto coarser = domains.choose({}, octree.lobes.size());
    EXPECT_EQ(std::ranges::max(coarser), 0);
    const GroupLinks links = link_groups(octree.view(), domains.group(coarser), {});
    ASSERT_EQ(links.groups.count(), octree.lobes.size());
    EXPECT_EQ(links.links, trace_links(octree.view(), {}));
}

TEST(LightDomains, GroupsHoldEveryLobeOnceAndAreFewerFarAway) {
    const Octree octree = dogleg(7);
    const LightDomains domains(octree.view());
    const Focus eye{{0.5f, 0.5f, 0.5f}};
    const std::uint64_t most = octree.lobes.size() / 4;
    const LightGroups groups = domains.group(domains.choose(std::span(&eye, 1), most));
    EXPECT_LE(groups.count(), most);
    EXPECT_GT(groups.count(), most / 2);
    std::vector<std::uint32_t> members = groups.members;
    std::ranges::sort(members);
    for (std::uint32_t i = 0; i < members.size(); ++i)
        ASSERT_EQ(members[i], i);
    double near = 0.0, far = 0.0, near_groups = 0.0, far_groups = 0.0;
    for (std::uint32_t g = 0; g < groups.count(); ++g) {
        const std::uint32_t size = groups.starts[g + 1] - groups.starts[g];
        const float(&p)[3] = octree.lobes[groups.members[groups.starts[g]]].position;
        const bool is_near = length(Vec3f{p[0], p[1], p[2]} - eye.position) < 1.0f;
        (is_near ? near : far) += size;
        (is_near ? near_groups : far_groups) += 1.0;
        for (std::uint32_t ray = 0; ray < 128; ++ray)
            ASSERT_EQ(groups.group_of[groups.lobe_of(g, ray)], g);
    }
    std::cout << near / near_groups << " lobes a group within a metre, " << far / far_groups
              << " beyond\n";
    EXPECT_LT(2.0 * near / near_groups, far / far_groups);
}

TEST(LightDomains, WithAQuarterOfTheGroupsLightNearTheEyeIsNearerThanOnACoarserLevel) {
    const Context context = Context::headless();
    const Octree octree = dogleg(7);
    const Octree coarse = coarsen(octree.view(), 6);
    const Scene scene = lamp_at({0.5, 0.5, 0.5});
    const Focus eye{{3.0f, 0.5f, 0.5f}};
    const auto settled = [&](LightField& field) {
        EXPECT_TRUE(field.converge().settled);
        return measured_near(octree, eye.position, 1.0f, field);
    };
    LightField all(context, octree.view(), scene);
    const auto truth = settled(all);
    LightField coarser(context, coarse.view(), scene);
    const double error_coarser = mean_error(settled(coarser), truth);

    const LightDomains domains(octree.view());
    const GroupLinks links = link_groups(
        octree.view(), domains.group(domains.choose(std::span(&eye, 1), coarse.lobes.size())), {});
    LightField grouped(context, octree.view(), scene);
    grouped.use_groups(domains, links);
    const double error = mean_error(settled(grouped), truth);
    const double mean = mean_of(grouped.read_indirect()) / mean_of(all.read_indirect()) - 1.0;
    std::cout << links.groups.count() << " groups of " << octree.lobes.size()
              << " lobes: light within a metre off by " << 100.0 * error << " %, on "
              << coarse.lobes.size() << " lobes of the coarser level by " << 100.0 * error_coarser
              << " %; everywhere " << 100.0 * mean << " % in the mean\n";
    EXPECT_LE(links.groups.count(), coarse.lobes.size());
    EXPECT_LT(error, 0.8 * error_coarser);
    EXPECT_LT(std::abs(mean), 0.01);
    EXPECT_THAT(context.errors(), ::testing::IsEmpty());
}

TEST(LightDomains, WhatNoEyeSeesIsCoarseHoweverManyGroupsThereMayBe) {
    const Octree octree = dogleg(8);
    const LightDomains domains(octree.view());
    const Focus eye{{0.5f, 0.5f, 0.5f}};
    const std::span<const Focus> eyes(&eye, 1);
    const auto coarser = domains.choose(eyes, octree.lobes.size() - 1);
    const auto shown = domains.shown_to(eyes);
    const LightGroups groups = domains.group(coarser, shown);
    std::cout << groups.count() << " groups of " << octree.lobes.size() << " lobes\n";
    EXPECT_LT(groups.count(), octree.lobes.size() / 2);
    const auto count = [&](std::uint8_t value) { return std::ranges::count(shown, value); };
    EXPECT_GT(count(0), 0) << "the second bend hides the last leg";
    EXPECT_GT(count(1), 0);
    for (std::size_t d = 0; d < domains.count(); ++d)
        EXPECT_FALSE(shown[d] == 0 && coarser[d] == 0) << "fine light that nobody sees";
}

TEST(LightDomains, LightIsTheSameWhereItIsShownWhateverElseIs) {
    const Context context = Context::headless();
    const Octree octree = dogleg(7);
    const LightDomains domains(octree.view());
    const Focus eye{{0.5f, 0.5f, 0.5f}};
    const std::span<const Focus> eyes(&eye, 1);
    const auto coarser = domains.choose(eyes, octree.lobes.size() / 4);
    const auto shown = domains.shown_to(eyes);
    const auto lit_where = [&](const std::vector<std::uint8_t>& here) {
        const GroupLinks links = link_groups(octree.view(), domains.group(coarser, here), {},
                                             nullptr, {}, make_ray_tracer(octree.view(), {}));
        LightField field(context, octree.view(), lamp_at({0.5, 0.5, 0.5}));
        field.use_groups(domains, links);
        field.converge();
        return field.lobe_lights().read<gpu::LobeLight>(octree.lobes.size());
    };
    const auto everywhere = lit_where({}), some = lit_where(shown);
    double apart = 0.0, of = 0.0;
    for (std::size_t d = 0; d < domains.count(); ++d) {
        for (std::uint32_t i = domains.first_lobe_of(d); i < domains.first_lobe_of(d + 1); ++i) {
            const float a = everywhere[i].irradiance.y, b = some[i].irradiance.y;
            if (shown[d] != 0) {
                ASSERT_EQ(a, b) << i;
            }
            apart += static_cast<double>(std::abs(a - b));
            of += static_cast<double>(a);
        }
    }
    std::cout << "light off by " << 100.0 * apart / of << " % where it is not shown\n";
    EXPECT_GT(apart, 0.0);
    EXPECT_LT(apart, 0.1 * of);
}

TEST(LightDomains, MovingKeepsLightAndTracesOnlyWhatChanges) {
    const Context context = Context::headless();
    const Octree octree = dogleg(7);
    const Scene scene = lamp_at({0.5, 0.5, 0.5});
    const LightDomains domains(octree.view());
    const auto looked_from = [&](const Vec3f& place) {
        const Focus eye{place};
        return domains.group(domains.choose(std::span(&eye, 1), octree.lobes.size() / 4));
    };
    const GroupLinks here = link_groups(octree.view(), looked_from({0.5f, 0.5f, 0.5f}), {});
    LightField field(context, octree.view(), scene);
    field.use_groups(domains, here);
    field.converge();
    const double before = mean_of(field.read_indirect());

    std::uint64_t traced = 0;
    const auto count = [&](std::uint64_t, std::uint64_t total) { traced = total; };
    const GroupLinks there =
        link_groups(octree.view(), looked_from({3.0f, 3.0f, 0.5f}), {}, &here, count);
    EXPECT_EQ(there.links, link_groups(octree.view(), looked_from({3.0f, 3.0f, 0.5f}), {}).links);
    EXPECT_LT(traced, there.groups.count());
    field.use_groups(domains, there, &here.groups);
    EXPECT_NEAR(mean_of(field.read_indirect()), before, 0.02 * before) << "went dark by moving";
    EXPECT_TRUE(field.converge().settled);
    EXPECT_NEAR(mean_of(field.read_indirect()), before, 0.02 * before);
    field.forget_indirect();
    EXPECT_EQ(mean_of(field.read_indirect()), 0.0);
}

TEST(LightDomains, BakedLinksServeTheGroupsAsTracedOnesDo) {
    Octree octree = dogleg(6);
    const LightDomains domains(octree.view());
    const std::vector<std::uint8_t> coarsest(domains.count(), LightDomains::kMostCoarser);
    const GroupLinks traced = link_groups(octree.view(), domains.group(coarsest), {});
    octree.links = trace_links(octree.view(), {});
    octree.links_per_lobe = 128;
    EXPECT_EQ(traced.links, link_groups(octree.view(), domains.group(coarsest), {}).links);
}

}  // namespace
}  // namespace glowworm
