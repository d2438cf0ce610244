#pragma once

#include <cstdint>
#include <vector>

#include "octree/ray_tracer.h"
#include "viewer/gpu/glsl.h"

namespace glowworm {

/// Has formulas' shadow rays traced many at once: they are worked out twice, the first time their
/// rays are only asked for and taken to be blocked, the second time they are answered in the same
/// order. That costs little beside tracing.
class ShadowQueue {
  public:
    static constexpr std::size_t kRaysAtOnce = 1 << 11;  // they and what they hit fit a cache

    explicit ShadowQueue(const RayTracer* tracer) : tracer_(tracer) {}

    /// Begins to ask.
    void ask() {
        asking_ = true;
        rays_.clear();
    }
    bool is_full() const { return rays_.size() >= kRaysAtOnce; }
    bool is_empty() const { return rays_.empty(); }
    /// How many were asked for so far: the number of the next.
    std::size_t asked() const { return rays_.size(); }
    /// Traces what was asked for and begins to answer.
    void trace() {
        seen_.resize(rays_.size());
        tracer_->look(rays_, seen_);
        asking_ = false;
        next_ = 0;
    }
    /// Goes on with the answer to ray number `ray`: for formulas that stop once they know enough.
    void answer_from(std::size_t ray) { next_ = ray; }

    /// In place of trace.glsl's unoccluded().
    bool unoccluded(const gpu::vec3& origin, const gpu::vec3& direction,
                    const gpu::vec3& from_normal, float t_min, float t_max, std::uint32_t tag,
                    const gpu::vec3& lamp_normal) {
        if (!asking_) return seen_[next_++] != 0;
        const auto of = [](const gpu::vec3& v) { return Vec3f{v.x, v.y, v.z}; };
        rays_.push_back(
            {{of(origin), of(direction), of(from_normal), t_min, t_max}, {of(lamp_normal), tag}});
        return false;
    }

  private:
    const RayTracer* tracer_;
    std::vector<ShadowRay> rays_;
    std::vector<std::uint8_t> seen_;
    std::size_t next_ = 0;
    bool asking_ = true;
};

}  // namespace glowworm
