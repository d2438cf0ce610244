#pragma once

#include "preprocess/read/read_scans.h"
#include "preprocess/read/scan_file.h"

namespace glowworm {

/// The blocks of a scan without the points that are not finite or absurdly far and without those
/// exactly at the frame's origin, which is how scanners write "no return". A single point there is
/// a point: it comes last.
class KeptBlocks {
  public:
    /// What is dropped and kept is counted in `counts`. Both must outlive this.
    KeptBlocks(ScanFile& file, ScanCounts& counts) : file_(file), counts_(counts) {}

    /// Replaces `block` by the next points; false after the last.
    bool next(PointBlock& block);

  private:
    ScanFile& file_;
    ScanCounts& counts_;
    PointBlock lone_;  // the first point at the origin
};

}  // namespace glowworm
