#include "octree/octree_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <string>
#include <system_error>

#include "octree/atomic_file.h"
#include "octree/error.h"
#include "octree/file_mapping.h"

namespace glowworm {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& why) {
    throw Error(ExitCode::kUnreadable, "'" + path.string() + "' " + why);
}

/// Closes a descriptor at the end of a scope.
struct Descriptor {
    int value;
    ~Descriptor() { ::close(value); }
};

bool finite_header(const FileHeader& header) {
    bool finite = std::isfinite(header.cube_edge) && header.cube_edge > 0.0f;
    for (int axis = 0; axis < 3; ++axis) {
        finite = finite && std::isfinite(header.origin[axis]) &&
                 std::isfinite(header.cube_min[axis]) && std::isfinite(header.bounds_min[axis]) &&
                 std::isfinite(header.bounds_max[axis]);
    }
    return finite;
}

/// Sections as they stand in the file, after their bounds have been checked.
class SectionReader {
  public:
    SectionReader(const std::filesystem::path& path, const char* bytes, const FileHeader& header)
        : path_(path), bytes_(bytes), header_(header) {
        std::uint64_t end = kSectionAlignment;
        for (std::uint32_t i = 0; i < header.section_count; ++i) {
            const SectionEntry& s = header.sections[i];
            if (s.offset % kSectionAlignment != 0 || s.offset < end || s.record_bytes == 0 ||
                s.offset > header.file_bytes ||
                s.count > (header.file_bytes - s.offset) / s.record_bytes) {
                refuse(path, "is damaged: section kind " + std::to_string(s.kind) +
                                 " does not lie inside the file; write it again");
            }
            end = s.offset + s.count * s.record_bytes;
            for (std::uint32_t j = 0; j < i; ++j) {
                if (header.sections[j].kind == s.kind) {
                    refuse(path, "is damaged: it has a section twice; write it again");
                }
            }
        }
    }

    template <typename T>
    std::span<const T> get(SectionKind kind, bool required = true) const {
        for (std::uint32_t i = 0; i < header_.section_count; ++i) {
            const SectionEntry& s = header_.sections[i];
            if (s.kind != static_cast<std::uint32_t>(kind)) continue;
            if (s.record_bytes != sizeof(T)) {
                refuse(path_, "is damaged: section kind " + std::to_string(s.kind) +
                                  " has records of a wrong size; write it again");
            }
            return {reinterpret_cast<const T*>(bytes_ + s.offset),
                    static_cast<std::size_t>(s.count)};
        }
        if (required) {
            refuse(path_, "is damaged: it lacks section kind " +
                              std::to_string(static_cast<std::uint32_t>(kind)) +
                              "; write it again");
        }
        return {};
    }

  private:
    const std::filesystem::path& path_;
    const char* bytes_;
    const FileHeader& header_;
};

/// Copies the header out of the file before any of it is believed.
FileHeader checked_header(const std::filesystem::path& path, const char* bytes,
                          std::uint64_t size) {
    FileHeader header;
    if (size < kSectionAlignment) {
        const bool ours = size >= sizeof kMagic && std::memcmp(bytes, kMagic, sizeof kMagic) == 0;
        refuse(path, ours ? "is truncated: even its header is not whole; write it again"
                          : "is not an octree file (.svo)");
    }
    std::memcpy(&header, bytes, sizeof header);
    if (std::memcmp(header.magic, kMagic, sizeof kMagic) != 0) {
        refuse(path, "is not an octree file (.svo)");
    }
    if (header.version != kFormatVersion) {
        refuse(path, "has format version " + std::to_string(header.version) +
                         ", this program reads version " + std::to_string(kFormatVersion) +
                         "; build it again from its surfels");
    }
    if (header.checksum != XXH3_64bits(&header, offsetof(FileHeader, checksum))) {
        refuse(path, "is damaged: its header does not match its checksum; write it again");
    }
    if (size < header.file_bytes) {
        refuse(path, "is truncated: " + std::to_string(size) + " of " +
                         std::to_string(header.file_bytes) + " bytes are there; write it again");
    }
    if (size > header.file_bytes) {
        refuse(path, "is damaged: it is " + std::to_string(size - header.file_bytes) +
                         " bytes longer than it was written; write it again");
    }
    if (header.depth > kMaxDepth || header.section_count > kMaxSections || !finite_header(header)) {
        refuse(path, "is damaged: its header holds impossible values; write it again");
    }
    return header;
}

std::uint64_t product(std::uint64_t a, std::uint64_t b) {
    return b != 0 && a > UINT64_MAX / b ? UINT64_MAX : a * b;
}

Vec3f vec3_of(const float (&v)[3]) {
    return {v[0], v[1], v[2]};
}

OctreeView view_of(const std::filesystem::path& path, const char* bytes, const FileHeader& header) {
    const SectionReader sections(path, bytes, header);
    OctreeView view;
    view.grid = {{header.origin[0], header.origin[1], header.origin[2]},
                 vec3_of(header.cube_min),
                 header.cube_edge,
                 header.depth};
    view.bounds_min = vec3_of(header.bounds_min);
    view.bounds_max = vec3_of(header.bounds_max);
    view.sample_count = header.sample_count;
    view.dropped_count = header.dropped_count;
    view.levels = sections.get<Level>(SectionKind::kLevels);
    view.nodes = sections.get<Node>(SectionKind::kNodes);
    view.attributes = sections.get<NodeAttributes>(SectionKind::kAttributes);
    view.lobes = sections.get<Lobe>(SectionKind::kLobes);
    view.chunks = sections.get<Chunk>(SectionKind::kChunks);
    view.surfels = sections.get<PackedSurfel>(SectionKind::kSurfels);
    view.stations = sections.get<StationRecord>(SectionKind::kStations);
    view.area_lights = sections.get<AreaLightRecord>(SectionKind::kAreaLights);
    const auto names = sections.get<char>(SectionKind::kNames);
    const auto provenance = sections.get<char>(SectionKind::kProvenance);
    view.names = {names.data(), names.size()};
    view.provenance = {provenance.data(), provenance.size()};
    view.links = sections.get<std::uint32_t>(SectionKind::kLinks, false);
    view.links_per_lobe = header.links_per_lobe;

    // Counts that must agree, so that nobody indexes one section by another's length.
    bool agree = view.levels.size() == header.depth + 1 &&
                 view.attributes.size() == view.nodes.size() && !view.nodes.empty() &&
                 view.links.size() == product(view.lobes.size(), view.links_per_lobe);
    std::uint64_t next = 0;
    for (const Level& level : view.levels) {
        agree = agree && level.first_node == next && level.node_count > 0;
        next += level.node_count;
    }
    if (!agree || next != view.nodes.size()) {
        refuse(path, "is damaged: its sections do not fit each other; write it again");
    }
    return view;
}

}  // namespace

bool is_octree_of_this_version(const std::filesystem::path& path) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored)) return false;
    struct {
        char magic[sizeof kMagic];
        std::uint32_t version;
    } start{};
    std::ifstream(path, std::ios::binary).read(reinterpret_cast<char*>(&start), sizeof start);
    return std::memcmp(start.magic, kMagic, sizeof kMagic) == 0 && start.version == kFormatVersion;
}

OctreeFile OctreeFile::open(const std::filesystem::path& path) {
    const Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
    if (file.value < 0) {
        refuse(path, std::string("cannot be read: ") + std::strerror(errno));
    }
    struct stat status {};
    if (::fstat(file.value, &status) != 0 || !S_ISREG(status.st_mode)) {
        refuse(path, "cannot be read: it is not a regular file");
    }
    const auto size = static_cast<std::uint64_t>(status.st_size);

    // The first page is read, not mapped: should the file shrink right now, nothing is believed.
    char first_page[kSectionAlignment] = {};
    const ssize_t got = ::pread(file.value, first_page, sizeof first_page, 0);
    if (got < 0) refuse(path, std::string("cannot be read: ") + std::strerror(errno));
    const FileHeader header = checked_header(
        path, first_page, size < kSectionAlignment ? static_cast<std::uint64_t>(got) : size);
    if (static_cast<std::size_t>(got) < sizeof first_page)
        refuse(path, "was cut while it was read");

    OctreeFile out;
    out.path_ = path;
    out.header_ = header;
    try {
        out.mapping_ = std::make_shared<const FileMapping>(file.value, size);
    } catch (const std::system_error& error) {
        refuse(path, std::string("cannot be mapped: ") + error.what());
    }
    out.view_ = view_of(path, static_cast<const char*>(out.mapping_->data()), header);
    out.require_intact();
    return out;
}

std::span<const char> OctreeFile::contents() const {
    return {static_cast<const char*>(mapping_->data()), header_.file_bytes};
}

void OctreeFile::require_intact() const {
    if (!mapping_->is_intact()) {
        refuse(path_, "was cut short by another program while it was read; write it again");
    }
}

void OctreeFile::forget_pages() const {
    mapping_->forget_pages();
}

}  // namespace glowworm
