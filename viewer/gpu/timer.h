#pragma once

#include <map>
#include <string>
#include <vector>

#include "viewer/gpu/context.h"
#include "viewer/gpu/objects.h"

namespace glowworm {

/// GPU and CPU time of each pass by name, ms. Where the driver's timer queries measure nothing, as
/// on software renderers, the GPU's time is the wall time from when it was idle to when it is
/// again.
class PassTimer {
  public:
    struct Sample {
        double gpu_ms = 0.0;
        double cpu_ms = 0.0;  ///< wall time until the last command was given
    };

    explicit PassTimer(const GlDevice& device);
    ~PassTimer();
    PassTimer(PassTimer&&) noexcept = default;
    PassTimer& operator=(PassTimer&&) noexcept = default;

    /// Runs `pass` and adds its times under `name`. Not nested. Waits for the GPU, so it is for
    /// benchmark runs.
    template <typename Pass>
    void measure(const std::string& name, Pass&& pass) {
        begin();
        pass();
        end(name);
    }

    const std::map<std::string, std::vector<Sample>>& samples() const { return samples_; }

  private:
    void begin();
    void end(const std::string& name);

    GlName query_;
    bool software_ = false;
    double begun_at_ms_ = 0.0;
    std::map<std::string, std::vector<Sample>> samples_;
};

}  // namespace glowworm
