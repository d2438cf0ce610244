#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "preprocess/read/input_file.h"
#include "preprocess/read/scan_file.h"

namespace glowworm {

/// PTS (Leica): a line with the number of points, then per line x y z, optionally intensity, red
/// green blue and a normal. Several clouds may follow one another. Where the number of lines is
/// another than announced the lines count.
bool is_pts(std::span<const std::byte> head);
std::unique_ptr<ScanFile> open_pts(InputFile file, const ReadSettings& settings);

/// XYZ, TXT, CSV, ASC: a point per line. What parts the columns, whether there is a header and what
/// the columns mean is worked out from the first lines and said in ScanHeader::notes; ReadSettings
/// overrides it. Lines that hold no three numbers count as invalid points.
bool is_text_table(std::span<const std::byte> head);
std::unique_ptr<ScanFile> open_text_table(InputFile file, const ReadSettings& settings);

/// For text that is no table of points: why not, as a clause. Empty for what is no text.
std::string why_no_text_table(std::span<const std::byte> head);

}  // namespace glowworm
