#include "viewer/frame/exr.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStdIO.h>

#include "octree/error.h"

namespace glowworm {
namespace {

/// World to camera for row vectors (p · M), OpenGL's axes: x right, y up, z backward.
Imath::M44f world_to_camera(const View& view) {
    const Vec3d axes[3] = {view.right, -view.down, -view.forward};
    Imath::M44f matrix;
    for (int column = 0; column < 3; ++column) {
        for (int row = 0; row < 3; ++row)
            matrix[row][column] = static_cast<float>(axes[column][row]);
        matrix[3][column] = static_cast<float>(-dot(axes[column], view.position));
    }
    return matrix;
}

/// Camera space to the picture's plane: x and y in [-1, 1], y up, after division by w. The depth
/// row keeps 1/depth, which needs no far plane.
Imath::M44f camera_to_ndc(const View& view) {
    const double to_x = 2.0 * view.focal / view.width, to_y = 2.0 * view.focal / view.height;
    const double shift_x = 2.0 * view.centre_x / view.width - 1.0;
    const double shift_y = 1.0 - 2.0 * view.centre_y / view.height;
    Imath::M44f m(0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0);
    m[0][0] = static_cast<float>(to_x);
    m[1][1] = static_cast<float>(to_y);
    if (view.orthographic) {
        m[2][2] = -1.0f;
        m[3][0] = static_cast<float>(shift_x);
        m[3][1] = static_cast<float>(shift_y);
        m[3][3] = 1.0f;
    } else {
        m[2][0] = static_cast<float>(-shift_x);
        m[2][1] = static_cast<float>(-shift_y);
        m[3][2] = 1.0f;
        m[2][3] = -1.0f;
    }
    return m;
}

}  // namespace

std::string encode_exr(const FrameLayers& layers, const View& view) {
    const std::size_t pixels = layers.depth.size();
    std::vector<Vec3f> beauty(pixels);
    for (std::size_t i = 0; i < pixels; ++i)
        beauty[i] = layers.beauty(i);

    Imf::Header header(layers.width, layers.height);
    header.compression() = Imf::ZIP_COMPRESSION;
    Imf::addChromaticities(header, Imf::Chromaticities());  // the default is Rec.709
    const Imath::M44f to_camera = world_to_camera(view);
    Imf::addWorldToCamera(header, to_camera);
    Imf::addWorldToNDC(header, to_camera * camera_to_ndc(view));

    Imf::FrameBuffer buffer;
    const std::size_t width = static_cast<std::size_t>(layers.width);
    const auto insert = [&](const std::string& name, const float* first, std::size_t stride) {
        header.channels().insert(name, Imf::Channel(Imf::FLOAT));
        char* base = reinterpret_cast<char*>(const_cast<float*>(first));  // read only
        buffer.insert(name, Imf::Slice(Imf::FLOAT, base, stride, stride * width));
    };
    const auto insert_triple = [&](const std::string& prefix, const std::string& letters,
                                   const std::vector<Vec3f>& layer) {
        for (std::size_t i = 0; i < 3; ++i) {
            insert(prefix + letters[i], &layer[0][static_cast<int>(i)], sizeof(Vec3f));
        }
    };
    insert_triple("", "RGB", beauty);
    insert_triple("direct.", "RGB", layers.direct);
    insert_triple("indirect.", "RGB", layers.indirect);
    insert_triple("specular.", "RGB", layers.specular);
    insert_triple("emission.", "RGB", layers.emission);
    insert_triple("albedo.", "RGB", layers.albedo);
    insert_triple("N.", "XYZ", layers.normal);
    insert("Z", layers.depth.data(), sizeof(float));
    insert("ndf.len", layers.ndf_length.data(), sizeof(float));

    Imf::StdOSStream stream;
    {
        Imf::OutputFile file(stream, header);  // completes its line table when it closes
        file.setFrameBuffer(buffer);
        file.writePixels(layers.height);
    }
    return stream.str();
}

ExrChannels read_exr(const std::filesystem::path& path) try {
    Imf::InputFile file(path.c_str());
    const Imath::Box2i window = file.header().dataWindow();
    ExrChannels exr;
    exr.width = window.max.x - window.min.x + 1;
    exr.height = window.max.y - window.min.y + 1;
    const std::size_t width = static_cast<std::size_t>(exr.width);
    const std::size_t pixels = width * static_cast<std::size_t>(exr.height);

    Imf::FrameBuffer buffer;
    const Imf::ChannelList& channels = file.header().channels();
    for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
        std::vector<float>& plane = exr.channels[channel.name()];
        plane.resize(pixels);
        // OpenEXR counts from the data window's origin: the base lies that much before the pixels.
        const std::ptrdiff_t before = window.min.x + std::ptrdiff_t{exr.width} * window.min.y;
        buffer.insert(channel.name(),
                      Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(plane.data() - before),
                                 sizeof(float), sizeof(float) * width));
    }
    file.setFrameBuffer(buffer);
    file.readPixels(window.min.y, window.max.y);
    return exr;
} catch (const Error&) {
    throw;
} catch (const std::exception& error) {
    throw Error(ExitCode::kUnreadable,
                "cannot read the picture '" + path.string() + "': " + error.what());
}

}  // namespace glowworm
