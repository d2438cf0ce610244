#include "octree/diff.h"

#include <fmt/format.h>

#include "octree/octree_file.h"
#include "preprocess/command/command.h"
#include "preprocess/command/plan.h"

namespace glowworm {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const OctreeDifference& difference) {
    Json sections = Json::array(), levels = Json::array();
    for (const SectionDifference& section : difference.sections) {
        sections.push_back({{"section", section.section},
                            {"count_a", section.count_a},
                            {"count_b", section.count_b},
                            {"differing", section.differing},
                            {"first", section.first}});
    }
    for (const LevelDifference& level : difference.levels) {
        levels.push_back({{"level", level.level},
                          {"only_a", level.only_a},
                          {"only_b", level.only_b},
                          {"both", level.both},
                          {"largest_opacity", level.largest_opacity},
                          {"largest_albedo", level.largest_albedo},
                          {"largest_ndf", level.largest_ndf},
                          {"area_a", level.area_a},
                          {"area_b", level.area_b}});
    }
    return {{"identical", difference.identical()},
            {"header", difference.header},
            {"sections", sections},
            {"levels", levels}};
}

void print(const OctreeDifference& difference) {
    if (difference.identical()) {
        fmt::print("identical\n");
        return;
    }
    for (const std::string& sentence : difference.header)
        fmt::print("{}\n", sentence);
    for (const SectionDifference& section : difference.sections) {
        fmt::print("{:<12} {} and {} records, {} differ, the first is {}\n", section.section,
                   format_count(section.count_a), format_count(section.count_b),
                   format_count(section.differing), format_count(section.first));
    }
    if (difference.levels.empty()) return;
    fmt::print("\n{:>5} {:>10} {:>10} {:>10} {:>9} {:>9} {:>9} {:>11} {:>11}\n", "level", "only A",
               "only B", "both", "opacity", "albedo", "ndf", "area A m2", "area B m2");
    for (const LevelDifference& level : difference.levels) {
        fmt::print("{:>5} {:>10} {:>10} {:>10} {:>9.3g} {:>9.3g} {:>9.3g} {:>11.2f} {:>11.2f}\n",
                   level.level, format_count(level.only_a), format_count(level.only_b),
                   format_count(level.both), level.largest_opacity, level.largest_albedo,
                   level.largest_ndf, level.area_a, level.area_b);
    }
}

}  // namespace

void add_diff_command(Program& program) {
    struct Flags {
        std::filesystem::path a, b;
    };
    auto flags = std::make_shared<Flags>();
    CLI::App* command = program.add(
        "diff", "what differs between two octree files, by section and level", false,
        [flags](Run& run) {
            page_memory(run);
            const OctreeFile a = OctreeFile::open(flags->a), b = OctreeFile::open(flags->b);
            require_sound(a, flags->a);
            require_sound(b, flags->b);
            const OctreeDifference difference = compare_octrees(a.view(), b.view());
            a.require_intact();
            b.require_intact();
            if (!run.flags.json) print(difference);
            return to_json(difference);
        });
    command->add_option("a", flags->a, "an .svo file")->required();
    command->add_option("b", flags->b, "another one")->required();
}

}  // namespace glowworm
