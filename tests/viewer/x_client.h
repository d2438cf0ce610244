#pragma once

#include <filesystem>
#include <string>

namespace glowworm::testing {

// What xdotool cannot do on a screen such as ":99".

/// Says how dense the screen is to programs that start from now on: 96 is ordinary.
void set_screen_density(const std::string& display, int dots_per_inch);

/// Drops a file on the window that has the keyboard as file managers do (the XDND protocol,
/// version 5). False where it did not take it within some seconds.
bool drop_file(const std::string& display, const std::filesystem::path& file);

/// The mean of a rectangle of the screen, 0 black .. 255 white.
double brightness(const std::string& display, int x, int y, int width, int height);

}  // namespace glowworm::testing
