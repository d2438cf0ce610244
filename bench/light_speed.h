#pragma once

#include <cstdint>
#include <span>

#include "viewer/gpu/context.h"
#include "viewer/light/settings.h"

namespace glowworm {

struct LightMethod {
    const char* name;
    LightSettings settings;
};

/// Prints the processor time of what each method does on a cave whose light is simulated at
/// `depth`, and the bytes that a bounce along links touches against what a copy moves in the same
/// run. Links are traced even where the file has them.
void speed_table(const Context& context, std::span<const LightMethod> methods, const char* file,
                 const char* scene_file, std::uint32_t depth);

}  // namespace glowworm
