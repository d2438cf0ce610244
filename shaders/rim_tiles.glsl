// Which squares of the picture hold a rim: most discs are nowhere near one.
#ifndef __cplusplus
layout(std430, binding = BINDING_RIM_TILES) readonly buffer rim_tiles { uint tiles[]; };
#endif

bool any_rim(ivec4 box) {
    int columns = int((view.width + RIM_TILE - 1u) / RIM_TILE);
    ivec4 squares = box / RIM_TILE;
    for (int y = squares.y; y <= squares.w; ++y) {
        for (int x = squares.x; x <= squares.z; ++x) {
            if (tiles[y * columns + x] != 0u) return true;
        }
    }
    return false;
}
