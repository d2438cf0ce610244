#pragma once

#include "viewer/frame/view.h"

namespace glowworm {

/// A parallel projection as cavers read it: plan from above, elevation from the side, or between.
/// The bearing is where the viewer faces, and what is at the top of a plan.
struct SurveyView {
    Vec3d centre;              ///< m, world: the middle of the picture
    double bearing_deg = 0.0;  ///< clockwise from north (+Y)
    double tilt_deg = -90.0;   ///< -90: plan, straight down; 0: elevation
    double metres_per_pixel = 0.01;
    double section = 1e6;  ///< m before the centre from where on things are drawn
};

/// The whole of a box in a picture of that size, from the given side.
SurveyView fitted_survey(const WorldBox& box, double bearing_deg, double tilt_deg, int width,
                         int height);

/// What is drawn. Depth counts from the section, at most `extent` m before the centre.
View view_of(const SurveyView& survey, int width, int height, double extent);

/// Moves by pixels, so that what was under the cursor stays there.
void pan(SurveyView& survey, double right, double down);
/// Makes a pixel `factor` times as large; what is at (x, y) pixels off the middle stays there.
void zoom(SurveyView& survey, double factor, double x, double y);
/// Turns the bearing, and tilts between plan and a view straight up; degrees.
void turn(SurveyView& survey, double bearing_deg, double tilt_deg);

/// The longest of 1, 2, 5 times a power of ten that takes at most `most_pixels`, m.
double scale_bar_length(double metres_per_pixel, double most_pixels);

/// Where north points on the screen, right and down; length 1 in plan, 0 where it is along the line
/// of sight.
struct ScreenDirection {
    double right = 0.0, down = 0.0;
};
ScreenDirection north_on_screen(const View& view);

}  // namespace glowworm
