#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "octree/progress.h"
#include "preprocess/clean.h"
#include "preprocess/read/read_scans.h"
#include "preprocess/read/scan_facts.h"
#include "preprocess/scan.h"

namespace glowworm {

class WorkFolder;

struct IngestSettings {
    ReadSettings read;
    CleanSettings clean;
};

/// A file's scans, cleaned, and what was found before they were.
struct Ingested {
    std::vector<Scan> scans;
    std::vector<ScanFacts> facts;  ///< of each scan as it was read
    std::uint64_t points = 0;      ///< read
    std::uint64_t outliers = 0;    ///< removed
};

/// Reads and cleans one file; every scan knows whether its origin is where a scanner stood. Throws
/// as read_scans does.
Ingested ingest(const std::filesystem::path& file, const IngestSettings& settings);

/// All files, several at a time. With a work folder each one's result is kept there under its key,
/// and taken from there where it is: `keys` are theirs, one a file. Throws what reading the first
/// file that fails throws, with the rest of those begun kept.
std::vector<Ingested> ingest_all(std::span<const std::filesystem::path> files,
                                 const IngestSettings& settings, const Progress& progress,
                                 const WorkFolder* work = nullptr,
                                 std::span<const std::string> keys = {});

/// The same into the work folder alone: the scans that are returned have no points, so that no more
/// files are in memory than are read at a time.
std::vector<Ingested> ingest_into(const WorkFolder& work,
                                  std::span<const std::filesystem::path> files,
                                  const IngestSettings& settings, const Progress& progress,
                                  std::span<const std::string> keys);

}  // namespace glowworm
