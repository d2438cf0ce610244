#include "preprocess/pipeline/ingest.h"

#include <algorithm>

#include "preprocess/pipeline/checkpoint.h"
#include "preprocess/pipeline/for_all_files.h"
#include "preprocess/station.h"

namespace glowworm {

Ingested ingest(const std::filesystem::path& file, const IngestSettings& settings) {
    Ingested done;
    ReadReport report;
    done.scans = read_scans(file, settings.read, &report);
    for (Scan& scan : done.scans) {
        ScanCounts counts{.name = scan.name, .kept = scan.points.size()};
        const auto found = std::ranges::find(report.scans, scan.name, &ScanCounts::name);
        if (found != report.scans.end()) counts = *found;
        done.facts.push_back(facts_of(scan, counts));

        CleanReport cleaned;
        scan.has_viewpoint = scan.has_viewpoint || origin_is_viewpoint(scan.points);
        scan.points = clean(scan.points, scan.has_viewpoint, settings.clean, &cleaned);
        done.points += cleaned.points_in;
        done.outliers += cleaned.outliers;
    }
    return done;
}

namespace {

Ingested kept_or_made(const WorkFolder* work, const std::filesystem::path& file,
                      const std::string& key, const IngestSettings& settings) {
    Ingested result;
    if (work != nullptr && load_ingested(*work, key, file, result)) return result;
    result = ingest(file, settings);
    if (work != nullptr) save_ingested(*work, key, result);
    return result;
}

}  // namespace

std::vector<Ingested> ingest_all(std::span<const std::filesystem::path> files,
                                 const IngestSettings& settings, const Progress& progress,
                                 const WorkFolder* work, std::span<const std::string> keys) {
    return for_all_files(files.size(), progress, [&](std::size_t i) {
        return kept_or_made(work, files[i], keys.empty() ? std::string() : keys[i], settings);
    });
}

std::vector<Ingested> ingest_into(const WorkFolder& work,
                                  std::span<const std::filesystem::path> files,
                                  const IngestSettings& settings, const Progress& progress,
                                  std::span<const std::string> keys) {
    return for_all_files(files.size(), progress, [&](std::size_t i) {
        Ingested result = kept_or_made(&work, files[i], keys[i], settings);
        for (Scan& scan : result.scans)
            scan.points = {};
        return result;
    });
}

}  // namespace glowworm
