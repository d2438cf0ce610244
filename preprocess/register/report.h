#pragma once

#include <span>

#include "preprocess/register/align.h"
#include "preprocess/register/assembly.h"
#include "preprocess/register/frames.h"

namespace glowworm {

/// Fills `result.poses` and its counts: which scans belong to the world (the largest group, or
/// every group held by a given pose that no larger one contradicts), what holds them, and what each
/// pair said.
void write_report(std::span<const Scan> scans, std::span<const ScanModel> models,
                  std::span<const PairFit> pairs, const PairSettings& settings,
                  const LocalFrame& frame, const Assembly& assembly, Registration& result);

}  // namespace glowworm
