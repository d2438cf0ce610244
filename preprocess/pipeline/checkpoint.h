#pragma once

#include <filesystem>
#include <string>

#include "preprocess/pipeline.h"
#include "preprocess/pipeline/ingest.h"
#include "preprocess/pipeline/shares.h"
#include "preprocess/pipeline/work_folder.h"

namespace glowworm {

/// What a stage made, kept in the work folder under the stage's key: the hash of the program, of
/// the stage's settings and of the keys of what it was made from. `load_` returns false, and leaves
/// `what` without meaning, where nothing is kept under that key or what is kept is damaged; `save_`
/// throws as AtomicFile does.

bool load_ingested(const WorkFolder& work, const std::string& key,
                   const std::filesystem::path& file, Ingested& what);
void save_ingested(const WorkFolder& work, const std::string& key, const Ingested& what);

/// `so_far` is what the stages before had to say.
bool load_cloud(const WorkFolder& work, const std::string& key, Conversion& so_far,
                PointCloud& what);
void save_cloud(const WorkFolder& work, const std::string& key, const Conversion& so_far,
                const PointCloud& what);

bool load_surfels(const WorkFolder& work, const std::string& key, Conversion& so_far,
                  SurfelCloud& what);
void save_surfels(const WorkFolder& work, const std::string& key, const Conversion& so_far,
                  const SurfelCloud& what);

/// What the stages so far had to say, the registration among it.
bool load_report(const WorkFolder& work, const std::string& stage, const std::string& key,
                 Conversion& what);
void save_report(const WorkFolder& work, const std::string& stage, const std::string& key,
                 const Conversion& what);

/// Which pairs are to be tried.
bool load_pair_plan(const WorkFolder& work, const std::string& key, PairPlan& what);
void save_pair_plan(const WorkFolder& work, const std::string& key, const PairPlan& what);

/// The pairs that one job tried.
bool load_share(const WorkFolder& work, const std::string& key, const Share& share,
                std::vector<PairFit>& what);
void save_share(const WorkFolder& work, const std::string& key, const Share& share,
                const std::vector<PairFit>& what);

/// Tiles that one job built.
struct TileShare {
    std::uint64_t dropped = 0;       ///< surfels left out, of the whole cloud
    std::vector<std::string> names;  ///< of the parts with the tiles; cells with nothing have none
};
bool load_share(const WorkFolder& work, const std::string& key, const Share& share,
                Conversion& so_far, TileShare& what);
void save_share(const WorkFolder& work, const std::string& key, const Share& share,
                const Conversion& so_far, const TileShare& what);

}  // namespace glowworm
