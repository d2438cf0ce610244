// What becomes of a rim. Reads the pixels around: rim_at(pixel), and is_empty(pixel) where nothing
// was found, behind rims neither.
CONSTANT int kMostRimPixels = 16;   // that rims are wide

bool borders_on_nothing(ivec2 from) {
    for (int i = 0; i < 9; ++i) {
        ivec2 direction = ivec2(i % 3, i / 3) - 1;
        if (direction == ivec2(0)) continue;
        ivec2 at = from + direction;
        for (int step = 0; step < kMostRimPixels && !is_outside(at); ++step, at += direction) {
            uint pixel = uint(at.y) * view.width + uint(at.x);
            if (rim_at(pixel) > 0.0f) continue;
            if (is_empty(pixel)) return true;
            break;
        }
    }
    return false;
}

// A rim gives way to what lies behind it, or to nothing where it borders on nothing. Else it stays,
// better than a hole: what is blended next finds its discs again.
bool keeps_rim(uint pixel, ivec2 at) {
    return is_empty(pixel) && rim_at(pixel) != kGap && !borders_on_nothing(at);
}
