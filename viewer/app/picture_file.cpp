#include "viewer/app/picture_file.h"

#include "octree/atomic_file.h"
#include "viewer/frame/exposure.h"
#include "viewer/frame/exr.h"
#include "viewer/frame/png.h"

namespace glowworm {

void write_whole(const std::filesystem::path& path, const std::string& bytes) {
    AtomicFile file(path);
    file.write(bytes);
    file.commit();
}

double write_frame(const FrameLayers& layers, const View& view, const DisplaySettings& settings,
                   const std::filesystem::path& path) {
    if (path.extension() == ".exr") {
        write_whole(path, encode_exr(layers, view));
        return 0.0;
    }
    const double stops = settings.exposure ? *settings.exposure : measured_exposure(layers);
    write_whole(path, encode_png(Display().picture_of(layers, stops, settings.curve)));
    return stops;
}

}  // namespace glowworm
