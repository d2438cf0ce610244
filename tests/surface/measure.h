#pragma once

#include <gtest/gtest.h>

#include <cstdio>

#include "preprocess/surface/surface.h"
#include "surface/accuracy.h"
#include "surface/shapes.h"

namespace glowworm::testing {

/// Makes surfels of a shape, prints and returns how true they are. Next to none of the points may
/// be left out.
inline Accuracy measure(const char* what, const Shape& shape, SurfaceReport* report_out = nullptr) {
    SurfaceReport report;
    const SurfelCloud cloud = make_surfels(shape.cloud, {}, &report);
    EXPECT_GT(cloud.surfels.size(), shape.normals.size() * 999 / 1000);
    const Accuracy accuracy = compare(cloud.surfels, truth_of(cloud.surfels, shape));
    print(what, accuracy, report);
    if (shape.area > 0.0) std::printf("    area of the discs: %.4f\n", accuracy.area / shape.area);
    if (report_out) *report_out = report;
    return accuracy;
}

/// Of unknown stations, and in a frame whose origin is nowhere near.
inline Shape without_viewpoints(Shape shape) {
    shape.cloud.origin = {300.0, 200.0, 100.0};
    for (Station& station : shape.cloud.stations)
        station.has_viewpoint = false;
    return shape;
}

}  // namespace glowworm::testing
