#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <fstream>
#include <iterator>

#include "octree/error.h"
#include "octree/links.h"
#include "octree/octree_writer.h"
#include "preprocess/command/command.h"
#include "preprocess/command/convert_flags.h"
#include "preprocess/command/convert_report.h"
#include "preprocess/command/plan.h"
#include "preprocess/pipeline.h"
#include "preprocess/pipeline/up_to_date.h"
#include "preprocess/pipeline/work_folder.h"

namespace glowworm {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// The console, and how long each phase took.
class TimedPhases {
  public:
    explicit TimedPhases(Console& console) : console_(console) {}

    Progress begin(const std::string& name, const std::string& unit) {
        end();
        times_.push_back({name, 0.0});
        started_ = std::chrono::steady_clock::now();
        return console_.phase(name, unit);
    }
    void end() {
        if (times_.empty()) return;
        const auto now = std::chrono::steady_clock::now();
        times_.back().seconds += std::chrono::duration<double>(now - started_).count();
        started_ = now;
    }
    const std::vector<PhaseTime>& times() const { return times_; }

  private:
    Console& console_;
    std::vector<PhaseTime> times_;
    std::chrono::steady_clock::time_point started_;
};

fs::path poses_of(const fs::path& output) {
    return output.string() + ".poses.json";
}

Json octree_json(const fs::path& output) {
    const OctreeFile file = OctreeFile::open(output);
    const OctreeView& octree = file.view();
    return {{"surfels", octree.surfels.size()},
            {"leaves", octree.levels.back().node_count},
            {"nodes", octree.nodes.size()},
            {"lobes", octree.lobes.size()},
            {"depth", octree.grid.depth},
            {"voxel_size", octree.grid.voxel_size()},
            {"bytes", file.bytes()}};
}

Json to_json(const Conversion& done, const fs::path& output) {
    Json result = {
        {"output", output.string()},
        {"poses", poses_of(output).string()},
        {"scans", done.scans},
        {"registered", done.registration.poses.scans.size() - done.registration.unregistered},
        {"points", done.points},
        {"outliers", done.outliers},
        {"moving", done.merge.moving}};
    result.update(octree_json(output));
    result["surface"] = surface_json(done.surface);
    result["warnings"] = warnings_json(done.warnings);
    return result;
}

Json nothing_to_do(Run& run) {
    const fs::path& output = run.flags.output;
    run.last_word = fmt::format("'{}' is up to date", output.string());
    Json result = {
        {"output", output.string()}, {"poses", poses_of(output).string()}, {"up_to_date", true}};
    result.update(octree_json(output));
    return result;
}

/// Throws Error (kExists) for what may not be overwritten; an earlier run's own poses may.
void require_free(const SharedFlags& flags, const WorkFolder& work) {
    const fs::path poses = poses_of(flags.output);
    if (flags.force) return;
    if (fs::exists(flags.output)) {
        throw Error(ExitCode::kExists,
                    flags.resume
                        ? fmt::format("'{}' was made from other scans or settings; --force makes "
                                      "it anew",
                                      flags.output.string())
                        : fmt::format("the output '{}' exists; --force overwrites it, --resume "
                                      "leaves it where it is up to date",
                                      flags.output.string()));
    }
    if (!fs::exists(poses)) return;
    std::ifstream stream(poses, std::ios::binary);
    const std::string text(std::istreambuf_iterator<char>(stream), {});
    if (text.empty() || text != kept_poses(work)) require_writable_output(poses, false);
}

/// Adds the links and writes the octree under its final name, and the poses beside it.
void write_output(const WorkFolder& work, const Poses& poses, std::uint32_t links_per_lobe,
                  Run& run, TimedPhases& phases) {
    const OctreeFile built = OctreeFile::open(octree_part(work));
    OctreeView octree = built.view();
    std::vector<std::uint32_t> links;
    if (links_per_lobe > 0) {
        links = trace_links(octree, {.rays = links_per_lobe}, phases.begin("links", "lobes"));
        octree.links = links;
        octree.links_per_lobe = links_per_lobe;
        spdlog::info("{} links a lobe are in the file, {}; --links 0 leaves them out",
                     links_per_lobe, format_bytes(links.size() * sizeof(std::uint32_t)));
    }
    const Progress writing = phases.begin("write", "bytes");
    built.require_intact();
    write_poses(poses, poses_of(run.flags.output));
    write_octree_file(octree, run.flags.output, {.progress = writing});
    phases.end();
    run.console.end_phase();
}

/// The page of the run. Where the user stops it, the octree is there all the same.
void write_page(Run& run, const ConvertFlags& flags, const Conversion& done,
                std::span<const ScanInput> inputs, const WorkFolder& work,
                const TimedPhases& phases) {
    try {
        write_run_page(flags.report, run.flags.output, done, inputs, flags.settings, work,
                       phases.times(), run.console);
    } catch (const Error& error) {
        if (error.code() != ExitCode::kCancelled) throw;
        throw Error(ExitCode::kCancelled,
                    fmt::format("cancelled: '{}' is written and whole, its page '{}' is not; "
                                "--resume makes it",
                                run.flags.output.string(), flags.report.string()));
    }
    spdlog::info("what there is to see at a glance is in {}", flags.report.string());
}

/// What there is to see of a run that ends here: its warnings, which may say why, and its page.
void say_distrust(const fs::path& output, const ConvertFlags& flags, const Error& error,
                  std::span<const ScanInput> inputs, const WorkFolder& work,
                  const TimedPhases& phases) {
    Conversion kept;
    if (load_registration(work, kept)) say_warnings(kept.warnings);
    if (flags.report.empty()) return;
    write_distrust_page(flags.report, output, error.what(), inputs, flags.settings, work,
                        phases.times());
    spdlog::info("what there is to see at a glance is in {}", flags.report.string());
}

Json work_on(Run& run, const ConvertFlags& flags, std::span<const ScanInput> inputs,
             const WorkFolder& work) {
    const fs::path& output = run.flags.output;
    const fs::path poses = poses_of(output);
    remove_abandoned(poses);
    TimedPhases phases(run.console);
    const auto begin = [&](const std::string& phase, const std::string& unit) {
        return phases.begin(phase, unit);
    };
    const auto registered = [&](const Registration& registration) {
        const bool last = flags.last_stage() == Stage::kRegister;
        if (!registration.trustworthy() || last) {
            write_poses(registration.poses, poses);
            spdlog::info("the poses and how far to trust them are in {}", poses.string());
        }
        if (registration.poses.scans.size() > 1) say_trust(registration);
    };
    Conversion done;
    try {
        done = convert_scans(inputs, flags.settings, begin, registered, work, flags.last_stage());
    } catch (const Error& error) {
        if (error.code() != ExitCode::kNotTrustworthy) throw;
        phases.end();
        say_distrust(output, flags, error, inputs, work, phases);
        throw;
    }
    say_warnings(done.warnings);
    if (flags.until != "links") {
        run.console.end_phase();
        run.last_word =
            fmt::format("done until {}, kept in '{}'", flags.until, work.path().string());
        return {{"work", work.path().string()},
                {"until", flags.until},
                {"scans", done.scans},
                {"points", done.points},
                {"warnings", warnings_json(done.warnings)}};
    }
    say_surface(done.surface);
    say_octree(OctreeFile::open(octree_part(work)).view());
    write_output(work, done.registration.poses, flags.settings.links, run, phases);
    if (!flags.report.empty()) {
        write_page(run, flags, done, inputs, work, phases);
    }
    spdlog::info("the poses and how far to trust them are in {}", poses.string());
    return to_json(done, output);
}

/// What a run that did not end well says: the same sentence, and where its work is kept.
[[noreturn]] void say_what_is_kept(const Error& error, const WorkFolder& work) {
    std::string sentence = error.what();
    const bool again_the_same = error.code() == ExitCode::kDegenerate;
    if (again_the_same) work.remove();
    if (work.keeps_anything()) {
        sentence += fmt::format("; what is done is kept in '{}', the same command goes on from it",
                                work.path().string());
    }
    throw Error(error.code(), sentence);
}

Json run_convert(Run& run, ConvertFlags flags) {
    const fs::path& output = run.flags.output;
    const auto files = find_scan_files(flags.inputs);
    require_distinct(output, files);
    require_distinct(poses_of(output), files);
    require_distinct(output, {flags.build.lights});
    flags.apply();
    if (!flags.report.empty()) {
        require_distinct(flags.report, files);
        require_writable_output(flags.report, run.flags.force || run.flags.resume);
    }

    // 1. Whether there is anything to do: first by the files' times, then by their content.
    std::vector<fs::path> read = files;
    if (!flags.build.lights.empty()) read.push_back(flags.build.lights);
    const std::string settings = settings_hash(flags.settings);
    const std::string state = state_of(read, settings + GLOWWORM_VERSION);
    const auto may_be_done = [&] {
        return run.flags.resume && flags.until == "links" && fs::exists(output) &&
               fs::exists(poses_of(output));
    };
    const bool lacks_page = !flags.report.empty() && !fs::exists(flags.report);
    if (may_be_done() && !lacks_page && remembers(output, Record::kState, state))
        return nothing_to_do(run);
    require_budget(run, files, flags.settings, Reach::kAll);
    const std::vector<ScanInput> inputs = describe_scans(files, run.console.phase("look", "bytes"));
    run.console.end_phase();
    flags.apply_provenance(inputs);

    // 2. Alone from here on; another run may have done it meanwhile.
    const WorkFolder work(output, run.flags.temp_dir);
    const bool made = may_be_done() && provenance_of(output) == flags.settings.build.provenance;
    if (made && !lacks_page) {
        work.remove();
        remember_as(output, Record::kState, state);
        return nothing_to_do(run);
    }
    if (!made) require_free(run.flags, work);
    try {
        const Json result = work_on(run, flags, inputs, work);
        if (flags.until != "links") return result;
        work.remove();
        if (state_of(read, settings + GLOWWORM_VERSION) == state)
            remember_as(output, Record::kState, state);
        return result;
    } catch (const Error& error) {
        say_what_is_kept(error, work);
    } catch (const std::bad_alloc&) {
        say_what_is_kept({ExitCode::kBudget,
                          "out of memory; give more with --memory-limit, or "
                          "use fewer scans"},
                         work);
    }
}

}  // namespace

void add_convert_command(Program& program) {
    auto flags = std::make_shared<ConvertFlags>();
    const Work work = [flags](Run& run) { return run_convert(run, *flags); };
    const Work plan = [flags](Run& run) {
        flags->apply();
        return plan_work(run, find_scan_files(flags->inputs), flags->settings, Reach::kAll);
    };
    CLI::App* command =
        program.add("convert", "raw scans to an octree file, the whole pipeline in one command",
                    true, work, plan, true);
    flags->add_to(*command);
    command->add_option("--report", flags->report,
                        "write what is to be seen of the run at a glance into this HTML page");
    command
        ->add_option("--until", flags->until,
                     "end after this stage, with what is done kept for a later run: ingest, "
                     "register, merge, surface, build; links is all")
        ->check(CLI::IsMember({"ingest", "register", "merge", "surface", "build", "links"}));
}

}  // namespace glowworm
