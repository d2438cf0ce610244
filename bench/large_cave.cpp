// A cave of any number of points: 200 rooms one after the other, bent passages between them, two
// storeys of ten rows. About 35 000 m² of wall within a cube of 120 m.
// usage: make_large_cave MILLIONS CAVE.ply
// Writes the surfels, and beside them CAVE.scene.json, lamps in eight of the rooms, and
// CAVE.path.json, a flight through five rooms.
#include <tbb/parallel_for.h>

#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "bench/ply_points.h"
#include "octree/vec3.h"

using namespace glowworm;

namespace {

constexpr int kRooms = 200, kRoomsInRow = 10, kRowsInStorey = 10;
constexpr double kStep = 12.0;    // m from room to room
constexpr double kFlat = 0.7;     // height of a room by its width
constexpr double kNoise = 0.002;  // m
constexpr int kSurveyed = 4000;   // samples that tell a piece's area
constexpr int kLampEvery = 25;    // rooms
constexpr int kFirstFlown = 45, kFlown = 5;
constexpr double kSpeed = 1.5;  // m/s

struct Frame {
    Vec3d u, v;
};

/// A piece of wall: a room, or the passage from it to the next.
struct Piece {
    bool is_room = true;
    Vec3d from, to;  // a room's middle; a passage's ends
    double radius = 0.0, bend = 0.0, phase = 0.0;
    Frame across;

    double bumpy(double a, double b, double c) const {
        return radius * (1.0 + 0.10 * std::sin(2.0 * a + phase) * std::cos(2.0 * b) +
                         0.05 * std::sin(5.0 * b + 3.0 * c + 2.0 * phase) +
                         0.02 * std::sin(17.0 * a) * std::cos(13.0 * b + 11.0 * c));
    }
    Vec3d axis(double t) const {
        return from + (to - from) * t + across.u * (bend * std::sin(std::numbers::pi * t));
    }
    double along(double t) const { return t * length(to - from) / radius; }

    /// The wall at parameters s and t, 0..1.
    Vec3d at(double s, double t) const {
        const double turn = 2.0 * std::numbers::pi * s;
        if (!is_room) {
            const double r = bumpy(std::cos(turn), std::sin(turn), along(t));
            return axis(t) + (across.u * std::cos(turn) + across.v * std::sin(turn)) * r;
        }
        const double z = 2.0 * t - 1.0, flat = std::sqrt(std::max(0.0, 1.0 - z * z));
        const Vec3d d{flat * std::cos(turn), flat * std::sin(turn), z};
        const double r = bumpy(d.x, d.y, d.z);
        return from + Vec3d{r * d.x, r * d.y, kFlat * r * d.z};
    }

    bool contains(const Vec3d& point) const {
        if (is_room) {
            Vec3d d = point - from;
            d.z /= kFlat;
            const double far = length(d);
            if (far > 1.3 * radius) return false;
            d = d / std::max(far, 1e-9);
            return far < bumpy(d.x, d.y, d.z);
        }
        const Vec3d chord = to - from;
        const double t = dot(point - from, chord) / dot(chord, chord);
        if (t < 0.0 || t > 1.0) return false;
        const Vec3d off = point - axis(t);
        const double x = dot(off, across.u), y = dot(off, across.v), far = std::hypot(x, y);
        return far < bumpy(x / std::max(far, 1e-9), y / std::max(far, 1e-9), along(t));
    }
};

/// Rooms at even places, the passage from each to the next at the odd ones.
std::vector<Piece> pieces_of_cave() {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    std::vector<Piece> pieces;
    std::vector<Vec3d> middles;
    for (int k = 0; k < kRooms; ++k) {
        const int row = k / kRoomsInRow, storey = row / kRowsInStorey;
        const int x = row % 2 == 0 ? k % kRoomsInRow : kRoomsInRow - 1 - k % kRoomsInRow;
        const int y = storey == 0 ? row : 2 * kRowsInStorey - 1 - row;
        middles.push_back({kStep * x + 1.5 * any(random), kStep * y + 1.5 * any(random),
                           kStep * storey + 1.5 * any(random)});
    }
    for (std::size_t k = 0; k < middles.size(); ++k) {
        pieces.push_back({.from = middles[k],
                          .to = middles[k],
                          .radius = 3.2 + 0.8 * any(random),
                          .phase = 3.0 * any(random)});
        if (k + 1 == middles.size()) break;
        const Vec3d chord = normalized(middles[k + 1] - middles[k]);
        const Vec3d aside = std::abs(chord.z) < 0.7 ? Vec3d{0, 0, 1} : Vec3d{1, 0, 0};
        const Vec3d u = normalized(cross(aside, chord));
        pieces.push_back({.is_room = false,
                          .from = middles[k],
                          .to = middles[k + 1],
                          .radius = 1.15 + 0.2 * any(random),
                          .bend = 1.5 * any(random),
                          .phase = 3.0 * any(random),
                          .across = {u, cross(chord, u)}});
    }
    return pieces;
}

/// Draws points of one piece's wall, evenly by area, where no neighbour's air is.
class Wall {
  public:
    Wall(const std::vector<Piece>& pieces, std::size_t k) : pieces_(pieces), k_(k), random_(k) {
        int seen = 0;
        double sum = 0.0;
        for (int i = 0; i < kSurveyed; ++i) {
            const Patch patch = any_patch();
            most_ = std::max(most_, patch.stretch);
            if (!patch.is_open) continue;
            sum += patch.stretch;
            ++seen;
        }
        area_ = seen > 0 ? sum / kSurveyed : 0.0;
        most_ *= 1.05;
    }

    double area() const { return area_; }  // m²

    PlyPoint draw(float radius) {
        std::uniform_real_distribution<double> share(0.0, most_);
        std::normal_distribution<double> noise(0.0, kNoise);
        Patch patch;
        do {
            patch = any_patch();
        } while (!patch.is_open || share(random_) > patch.stretch);
        const Vec3d p = patch.place + patch.normal * noise(random_);
        const double layers = std::sin(4.0 * p.z + 0.7 * std::sin(p.x) + 0.5 * std::sin(p.y));
        const double grey = 150.0 + 35.0 * layers;
        const Vec3f at = vec3_cast<float>(p), n = vec3_cast<float>(patch.normal);
        return {{at.x, at.y, at.z},
                {n.x, n.y, n.z},
                {static_cast<std::uint8_t>(grey), static_cast<std::uint8_t>(0.92 * grey),
                 static_cast<std::uint8_t>(0.80 * grey)},
                radius};
    }

  private:
    struct Patch {
        Vec3d place, normal;
        double stretch = 0.0;  // m² by unit of parameters
        bool is_open = false;
    };

    Patch any_patch() {
        constexpr double kSmall = 1e-4;
        std::uniform_real_distribution<double> any(kSmall, 1.0 - kSmall);
        const Piece& piece = pieces_[k_];
        const double s = any(random_), t = any(random_);
        Patch patch{.place = piece.at(s, t)};
        const Vec3d across = cross(piece.at(s + kSmall, t) - piece.at(s - kSmall, t),
                                   piece.at(s, t + kSmall) - piece.at(s, t - kSmall));
        patch.stretch = length(across) / (4.0 * kSmall * kSmall);
        const Vec3d middle = piece.is_room
                                 ? piece.from
                                 : piece.axis(dot(patch.place - piece.from, piece.to - piece.from) /
                                              dot(piece.to - piece.from, piece.to - piece.from));
        patch.normal = normalized(across);
        if (dot(patch.normal, middle - patch.place) < 0.0) patch.normal = patch.normal * -1.0;
        patch.is_open = true;
        for (std::size_t other = k_ < 2 ? 0 : k_ - 2; other < pieces_.size() && other <= k_ + 2;
             ++other)
            patch.is_open &= other == k_ || !pieces_[other].contains(patch.place);
        return patch;
    }

    const std::vector<Piece>& pieces_;
    std::size_t k_;
    std::mt19937_64 random_;
    double area_ = 0.0, most_ = 0.0;
};

void write_points(const std::filesystem::path& path, std::size_t count,
                  const std::vector<Piece>& pieces) {
    std::vector<Wall> walls;
    double area = 0.0;
    for (std::size_t k = 0; k < pieces.size(); ++k) {
        walls.emplace_back(pieces, k);
        area += walls.back().area();
    }
    const double points_per_area = static_cast<double>(count) / area;
    const auto radius = static_cast<float>(std::sqrt(1.0 / (std::numbers::pi * points_per_area)));
    std::vector<std::size_t> counts;
    std::size_t sum = 0;
    double until = 0.0;
    for (const Wall& wall : walls) {
        until += wall.area() * points_per_area;
        counts.push_back(static_cast<std::size_t>(until) - sum);
        sum += counts.back();
    }
    std::ofstream stream(path, std::ios::binary);
    write_ply_header(stream, sum);
    constexpr std::size_t kAtOnce = 16;
    for (std::size_t first = 0; first < walls.size(); first += kAtOnce) {
        const std::size_t last = std::min(first + kAtOnce, walls.size());
        std::array<std::vector<PlyPoint>, kAtOnce> drawn;
        tbb::parallel_for(first, last, [&](std::size_t k) {
            for (std::size_t i = 0; i < counts[k]; ++i)
                drawn[k - first].push_back(walls[k].draw(radius));
        });
        for (const auto& points : drawn)
            write_ply_points(stream, points);
    }
    std::cout << sum << " points on " << area << " m2\n";
}

using Json = nlohmann::ordered_json;

Json json_of(const Vec3d& v) {
    return {v.x, v.y, v.z};
}

void write_scene(const std::filesystem::path& path, const std::vector<Piece>& pieces) {
    Json lights = Json::array();
    for (int room = kLampEvery / 2 - 2; room < kRooms; room += kLampEvery) {
        const Piece& piece = pieces[2 * static_cast<std::size_t>(room)];
        lights.push_back({{"type", "point"},
                          {"name", "room " + std::to_string(room)},
                          {"position", json_of(piece.from + Vec3d{0.4, 0.3, 0.5})},
                          {"radiant_intensity", {20.0, 17.0, 13.0}}});
    }
    const Piece& room = pieces[2 * kFirstFlown];
    const Piece& passage = pieces[2 * kFirstFlown + 1];
    lights.push_back({{"type", "point"},
                      {"name", "where the flight begins"},
                      {"position", json_of(room.from + Vec3d{0.5, -0.4, 0.6})},
                      {"radiant_intensity", {20.0, 17.0, 13.0}}});
    Json cameras = Json::array();
    cameras.push_back({{"name", "begin"},
                       {"position", json_of(room.from)},
                       {"look_at", json_of(passage.axis(0.4))},
                       {"up", {0.0, 0.0, 1.0}},
                       {"vfov_deg", 70.0},
                       {"width", 640},
                       {"height", 400}});
    std::ofstream(path) << Json{{"lights", lights}, {"cameras", cameras}}.dump(1) << "\n";
}

void write_path(const std::filesystem::path& path, const std::vector<Piece>& pieces) {
    std::vector<Vec3d> way;
    for (std::size_t k = 2 * kFirstFlown; k < 2 * (kFirstFlown + kFlown); ++k) {
        for (const double t : {0.0, 0.25, 0.5, 0.75})
            if (!pieces[k].is_room) way.push_back(pieces[k].axis(t));
    }
    Json keyframes = Json::array();
    double time = 0.0;
    for (std::size_t i = 0; i + 2 < way.size(); ++i) {
        if (i > 0) time += length(way[i] - way[i - 1]) / kSpeed;
        keyframes.push_back({{"time", time},
                             {"position", json_of(way[i])},
                             {"look_at", json_of(way[i + 2])},
                             {"vfov_deg", 70.0}});
    }
    std::ofstream(path) << Json{{"fps", 2}, {"keyframes", keyframes}}.dump(1) << "\n";
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3) {
        std::cerr << "usage: make_large_cave MILLIONS CAVE.ply\n";
        return 2;
    }
    std::filesystem::path path = argv[2];
    const std::vector<Piece> pieces = pieces_of_cave();
    write_points(path, static_cast<std::size_t>(std::atof(argv[1]) * 1e6), pieces);
    write_scene(path.replace_extension(".scene.json"), pieces);
    write_path(path.replace_extension().replace_extension(".path.json"), pieces);
}
