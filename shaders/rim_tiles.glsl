// Which squares of the picture hold a rim: most discs are nowhere near one.
layout(std430, binding = BINDING_RIM_TILES) readonly buffer rim_tiles { uint tiles[]; };

bool any_rim(Splat splat) {
    int columns = int((view.width + RIM_TILE - 1u) / RIM_TILE);
    ivec2 low = splat.lowest / RIM_TILE, high = splat.highest / RIM_TILE;
    for (int y = low.y; y <= high.y; ++y) {
        for (int x = low.x; x <= high.x; ++x) {
            if (tiles[y * columns + x] != 0u) return true;
        }
    }
    return false;
}
