#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "octree/octree_file.h"
#include "octree/output_path.h"
#include "preprocess/command/console.h"
#include "preprocess/command/paged_memory.h"

namespace glowworm {

/// Flags that every subcommand shares; defaults and units as interface.md has them.
struct SharedFlags {
    std::filesystem::path output;    ///< -o; commands without an output leave it empty
    bool force = false;              ///< overwrite an output that is there
    bool json = false;               ///< the result as one JSON object on stdout
    std::string progress = "auto";   ///< auto | bar | json | none
    bool quiet = false;              ///< errors only
    bool verbose = false;            ///< every detail
    std::filesystem::path log_file;  ///< logs go here as well
    int threads = 0;                 ///< 0: as many as the machine has
    std::uint64_t memory_limit = 0;  ///< bytes the program may use at its peak; 0: no limit
    std::filesystem::path temp_dir;  ///< for what is kept while it works; empty: beside the output
    bool dry_run = false;            ///< predict and warn, write nothing
    bool resume = false;             ///< go on from what an earlier run left, also where it is done
};

/// What a subcommand's work is given: the shared flags and the console to talk through.
struct Run {
    const SharedFlags& flags;
    Console& console;
    std::vector<std::string> command_line;  ///< for the file's provenance
    std::string last_word;                  ///< said at the end; empty: "wrote" and the output
    std::unique_ptr<PagedMemory> paged;     ///< where the work may not fit into --memory-limit
};

/// Does a subcommand's work. Returns its result object, printed where --json was given.
using Work = std::function<nlohmann::ordered_json(Run&)>;

/// Adds `name` with the shared flags to `app`; `selected` receives the work when the user asks for
/// it, or `plan` where the user asks with --dry-run: it predicts and warns, and writes nothing. A
/// command that writes no file needs no plan: its work is done. Where `needs_output` is set, -o is
/// required, and with --resume an output that the same command made of the same files is left as it
/// is; a `resumable` command decides that itself.
struct Program {
    CLI::App& app;
    SharedFlags& flags;
    Work& selected;

    CLI::App* add(const std::string& name, const std::string& summary, bool needs_output, Work work,
                  Work plan = {}, bool resumable = false);
};

/// One file per subcommand defines each of these.
void add_convert_command(Program& program);
void add_ingest_command(Program& program);
void add_job_commands(Program& program);
void add_register_command(Program& program);
void add_merge_command(Program& program);
void add_surface_command(Program& program);
void add_build_command(Program& program);
void add_info_command(Program& program);
void add_check_command(Program& program);
void add_diff_command(Program& program);
void add_extract_command(Program& program);
void add_join_command(Program& program);

/// Throws Error (kCheckFailed) where an index inside the mapped file leads out of it or a section
/// of `kinds` (empty: any) does not match its checksum: asked before a command follows them.
void require_sound(const OctreeFile& file, const std::filesystem::path& path,
                   std::initializer_list<SectionKind> kinds = {});

/// "12.3 MB" for people.
std::string format_bytes(std::uint64_t bytes);

/// "12.3 cm" for people, whatever the size in metres.
std::string format_length(double metres);

/// "1 scan", "2 scans": `one` with its number, an s after it where there are more or none.
std::string format_number_of(std::uint64_t count, const std::string& one);

/// "1 234 567" for people.
std::string format_count(std::uint64_t count);

}  // namespace glowworm
