#include "visit.h"

#include <fstream>
#include <numeric>
#include <sstream>

#include "analytic_cave.h"
#include "octree/build.h"
#include "octree/octree_file.h"
#include "viewer/frame/exr.h"
#include "x_client.h"

namespace glowworm::testing {

std::string text_of(const std::filesystem::path& path) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
}

nlohmann::json json_of(const std::filesystem::path& path) {
    return nlohmann::json::parse(text_of(path));
}

Visit::Visit(const Arrival& arrival)
    : desktop_(arrival.screen_width, arrival.screen_height, folder_.path()) {
    if (arrival.dots_per_inch != 96) set_screen_density(desktop_.display(), arrival.dots_per_inch);
    write_octree_file(build_octree(closed_room({0, 0, 0}, {4, 4, 3}, 0.05f), {.depth = 5}).view(),
                      file("room.svo"));
    std::ofstream(file("scene.json"))
        << R"({"lights":[{"type":"point","name":"lamp","position":[1,1,2.5],
        "radiant_intensity":[0.1,0.1,0.1]}],"cameras":[{"name":"c","position":[2,0.5,1.5],
        "look_at":[2,4,1.5],"up":[0,0,1],"vfov_deg":60,"width":320,"height":240}]})";
    std::vector<std::string> words{GLOWWORM_VIEW_PROGRAM, file("room.svo"), "-v", "--size",
                                   arrival.size};
    if (!arrival.own_scene) words.insert(words.end(), {"--scene", "scene.json"});
    words.insert(words.end(), arrival.flags.begin(), arrival.flags.end());
    std::vector<std::string> environment{"DISPLAY=" + desktop_.display()};
    environment.insert(environment.end(), arrival.environment.begin(), arrival.environment.end());
    viewer_ = std::make_unique<RunningProgram>(words, environment, folder_.path(), file("log"));
}

bool Visit::says(const std::string& sentence, int times) const {
    return wait_for([&] {
        const std::string said = log();
        int found = 0;
        for (auto at = said.find(sentence); at != std::string::npos;
             at = said.find(sentence, at + 1)) {
            ++found;
        }
        return found >= times;
    });
}

bool Visit::begin() {
    if (!says("light after") || !desktop_.focus("Glowworm")) return false;
    desktop_.key("Tab");
    return true;
}

bool Visit::save_picture(int number) {
    desktop_.key("F12");
    return wait_for_file("glowworm-" + std::to_string(number) + ".png");
}

bool Visit::wait_for_file(const std::string& name) const {
    return wait_for([&] { return std::filesystem::exists(folder_ / name); });
}

std::vector<float> Visit::red(int number) const {
    return read_exr(folder_ / ("glowworm-" + std::to_string(number) + ".exr")).channels.at("R");
}

double Visit::mean_red(int number) const {
    const std::vector<float> values = red(number);
    return std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
}

int Visit::end() {
    desktop_.key("Escape");
    return viewer_->wait(30.0);
}

}  // namespace glowworm::testing
