#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "octree/octree.h"
#include "octree/octree_file.h"
#include "octree/vec3.h"

namespace glowworm {

/// What reflected light is simulated on: lobes that share it. Rays go through all of the octree's
/// leaves however large the groups are, so that what hides what stays exact.
struct LightGroups {
    std::vector<std::uint8_t>
        coarser;                      ///< [domains] levels that its groups' cells lie above leaves
    std::vector<std::uint8_t> shown;  ///< [domains] LightDomains::shown_to(), or all 1
    std::vector<std::uint32_t> first_of_domain;  ///< [domains + 1] groups
    std::vector<std::uint32_t> starts;           ///< [groups + 1] places among the members
    std::vector<std::uint32_t> members;          ///< [lobes] group after group
    std::vector<std::uint32_t> group_of;         ///< [lobes]
    std::vector<std::uint32_t> walls;  ///< [groups] walls.h, in the tree_of() of such domains
    std::vector<float> share;  ///< parallel to members: part of its group's area up to this, 0..1

    std::uint32_t count() const { return first_of_domain.empty() ? 0 : first_of_domain.back(); }
    /// The lobe that a group's ray leaves from: members in turn, as often as they are large.
    std::uint32_t lobe_of(std::uint32_t group, std::uint32_t ray) const;
};

/// A place that matters to what is seen: light near it is simulated finely.
struct Focus {
    Vec3f position;       ///< m, relative to the octree's origin
    float remote = 1.0f;  ///< distances from it count so many times; of an eye once

    bool is_eye() const { return remote <= 1.0f; }
};

/// The octree's subtrees (the paper's "multiple SVOs") of up to 16 leaves along an edge, each of
/// which has light as fine as its distance from what is looked at asks for: on lobes, or on cells
/// of 2, 4, 8 or 16 leaves, in each of which the lobes that face one way share it.
class LightDomains {
  public:
    static constexpr std::uint32_t kMostCoarser = 4;

    /// The octree must outlive it.
    explicit LightDomains(const OctreeView& octree);

    std::size_t count() const { return edges_.size() > 0 ? lobes_.size() - 1 : 0; }
    float edge() const { return edge(octree_); }  ///< m
    static float edge(const OctreeView& octree);  ///< what it will be
    std::uint64_t least_groups() const;           ///< where every domain is as coarse as can be
    /// [domains] how coarse each is, so that there are at most `most_groups`: lobes for themselves
    /// within a radius round each focus, 64 leaves where there is room for it, a level coarser with
    /// each doubling of the distance, what no focus sees counting as twice as far. All as coarse as
    /// can be where that is still too many.
    std::vector<std::uint8_t> choose(std::span<const Focus> foci, std::uint64_t most_groups) const;
    /// [domains] 1 where an eye sees any of it or of a domain beside it, or it lies within three
    /// domains of one: where pictures look light up.
    std::vector<std::uint8_t> shown_to(std::span<const Focus> foci) const;
    LightGroups group(std::vector<std::uint8_t> coarser,
                      std::vector<std::uint8_t> shown = {}) const;

    /// An octree without surfels whose leaves are the cells of domains that are so coarse, and
    /// whose lobes are those domains' groups, one after the other.
    Octree tree_of(const LightGroups& groups, std::uint32_t coarser) const;
    /// The lobes of a domain lie between these two.
    std::uint32_t first_lobe_of(std::size_t domain) const { return lobes_[domain]; }

  private:
    std::uint32_t first_lobe(std::uint32_t level, std::uint32_t node) const;
    std::vector<std::uint32_t> walls_of(const LightGroups& groups) const;
    std::vector<std::uint8_t> seen_from(std::span<const Focus> foci, std::uint32_t rays) const;
    float distance(std::size_t domain, const Vec3f& place) const;  // m, 0 inside
    std::size_t domain_at(const Vec3f& place) const;

    OctreeView octree_;
    std::uint32_t most_coarser_ = 0, level_ = 0;
    std::vector<std::vector<std::uint32_t>> edges_;  // [coarser][domains + 1] first node
    std::vector<std::uint32_t> lobes_;               // [domains + 1] first lobe
    std::vector<std::uint64_t> codes_;               // [domains] Morton, ascending
    std::vector<Vec3f> low_;                         // [domains] m, lower corners
    std::vector<std::vector<std::uint32_t>> sizes_;  // [coarser][domains] groups
};

}  // namespace glowworm
