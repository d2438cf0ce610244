#include "preprocess/read/scan_file.h"

namespace glowworm {

void PointBlock::resize(std::size_t count, const ColumnSet& columns) {
    positions.resize(count);
    normals.resize(columns.normals ? count : 0);
    colours.resize(columns.colours ? count : 0);
    intensities.resize(columns.intensities ? count : 0);
    ndf_lengths.resize(columns.ndf_lengths ? count : 0);
    radii.resize(columns.radii ? count : 0);
    stations.resize(columns.stations ? count : 0);
    emissions.resize(columns.emissions ? count : 0);
    times.resize(columns.times ? count : 0);
    grid.resize(columns.grid ? count : 0);
    invalid = no_colour = no_intensity = 0;
}

}  // namespace glowworm
