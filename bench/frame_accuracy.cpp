// How near a rendered frame comes to a reference: means over blocks of 4x4 pixels, because
// path-traced references carry pixel noise. Blocks at edges of depth or normal are left out, as one
// pixel of silhouette there says nothing about light.
//   frame_accuracy FRAME.exr REFERENCE_PREFIX     (REFERENCE_PREFIX_direct.exr and so on)

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>

#include "viewer/frame/exr.h"

namespace glowworm {
namespace {

constexpr int kBlock = 4;            // pixels
constexpr double kDarkShare = 0.02;  // of the mean: darker blocks are compared with this
constexpr double kEdgeDepth = 0.1;   // relative range of depth inside a block's neighbourhood
constexpr double kEdgeCosine = 0.7;  // least cosine between normals there

double at(const ExrChannels& exr, const std::string& name, int x, int y) {
    return static_cast<double>(exr.channels.at(name)[static_cast<std::size_t>(y * exr.width + x)]);
}

double block_mean(const ExrChannels& exr, const std::string& name, int bx, int by) {
    double sum = 0;
    for (int y = 0; y < kBlock; ++y) {
        for (int x = 0; x < kBlock; ++x)
            sum += at(exr, name, bx * kBlock + x, by * kBlock + y);
    }
    return sum / (kBlock * kBlock);
}

/// Whether the block and its neighbours lie on one smooth surface.
bool is_smooth(const ExrChannels& frame, int bx, int by) {
    const int x0 = std::max((bx - 1) * kBlock, 0), x1 = std::min((bx + 2) * kBlock, frame.width);
    const int y0 = std::max((by - 1) * kBlock, 0), y1 = std::min((by + 2) * kBlock, frame.height);
    double nearest = 1e30, farthest = 0, cosine = 1;
    const int cx = bx * kBlock, cy = by * kBlock;
    for (int y = y0; y < y1; ++y) {
        for (int x = x0; x < x1; ++x) {
            nearest = std::min(nearest, at(frame, "Z", x, y));
            farthest = std::max(farthest, at(frame, "Z", x, y));
            cosine = std::min(cosine, at(frame, "N.X", x, y) * at(frame, "N.X", cx, cy) +
                                          at(frame, "N.Y", x, y) * at(frame, "N.Y", cx, cy) +
                                          at(frame, "N.Z", x, y) * at(frame, "N.Z", cx, cy));
        }
    }
    return nearest > 0 && farthest - nearest < kEdgeDepth * nearest && cosine > kEdgeCosine;
}

struct Accuracy {
    double mean = 0.0;       ///< mean |ours - theirs| / max(theirs, 2 % of their mean)
    double bias = 0.0;       ///< sum(ours) / sum(theirs) - 1
    double within_10 = 0.0;  ///< share of blocks within 10 %
    int blocks = 0;
};

Accuracy compare(const ExrChannels& frame, const std::string& layer, const ExrChannels& reference,
                 bool with_emission) {
    const int columns = frame.width / kBlock, rows = frame.height / kBlock;
    struct Pair {
        double ours, theirs;
    };
    std::vector<Pair> pairs;
    for (int by = 0; by < rows; ++by) {
        for (int bx = 0; bx < columns; ++bx) {
            if (!is_smooth(frame, bx, by)) continue;
            for (const char* channel : {"R", "G", "B"}) {
                double ours = block_mean(frame, layer + channel, bx, by);
                if (with_emission)
                    ours += block_mean(frame, std::string("emission.") + channel, bx, by);
                pairs.push_back({ours, block_mean(reference, channel, bx, by)});
            }
        }
    }
    Accuracy accuracy;
    double sum_ours = 0, sum_theirs = 0;
    for (const Pair& p : pairs) {
        sum_ours += p.ours;
        sum_theirs += p.theirs;
    }
    const double n = static_cast<double>(std::max<std::size_t>(pairs.size(), 1));
    const double dark = kDarkShare * sum_theirs / n;
    for (const Pair& p : pairs) {
        const double relative = std::abs(p.ours - p.theirs) / std::max(p.theirs, dark);
        accuracy.mean += relative / n;
        accuracy.within_10 += relative <= 0.1 ? 1.0 / n : 0.0;
    }
    accuracy.bias = sum_ours / sum_theirs - 1.0;
    accuracy.blocks = static_cast<int>(pairs.size() / 3);
    return accuracy;
}

int run(const std::string& frame_path, const std::string& prefix) {
    const ExrChannels frame = read_exr(frame_path);
    const auto depths = frame.channels.at("Z");
    fmt::print("{:10} {} of {} pixels see nothing\n", "holes",
               std::count(depths.begin(), depths.end(), 0.0f), depths.size());
    const struct {
        const char* name;
        const char* layer;
        const char* file;
        bool with_emission;
    } layers[] = {{"direct", "direct.", "_direct.exr", true},
                  {"indirect", "indirect.", "_indirect.exr", false},
                  {"beauty", "", "_reference.exr", false}};
    for (const auto& layer : layers) {
        const ExrChannels reference = read_exr(prefix + layer.file);
        if (reference.width != frame.width || reference.height != frame.height) {
            fmt::print(stderr, "the frame and {} differ in size\n", layer.file);
            return 2;
        }
        const Accuracy a = compare(frame, layer.layer, reference, layer.with_emission);
        fmt::print(
            "{:10} mean error {:5.2f} %  bias {:+5.2f} %  within 10 %: {:5.1f} %  ({} blocks)\n",
            layer.name, a.mean * 100, a.bias * 100, a.within_10 * 100, a.blocks);
    }
    return 0;
}

}  // namespace
}  // namespace glowworm

int main(int argc, char** argv) {
    if (argc != 3) {
        fmt::print(stderr, "usage: frame_accuracy FRAME.exr REFERENCE_PREFIX\n");
        return 2;
    }
    try {
        return glowworm::run(argv[1], argv[2]);
    } catch (const std::exception& error) {
        fmt::print(stderr, "{}\n", error.what());
        return 1;
    }
}
