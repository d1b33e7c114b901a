// Probe volumes as files.
#pragma once

#include "lte/bake/probes.h"
#include "lte/base/file_set.h"
#include "lte/image/ktx2.h"

namespace lte::bake {

/// Adds probes.exr (a pixel a probe: x along rows, rows y of slices z below each other; float32)
/// and probes.json, which says what the layers are and has the same numbers.
void write_probes(const ProbeVolume& volume, FileSet* files);

/// Bevy's IrradianceVolume: ambient cubes of E / π in a 3D texture of (Rx, 2 Ry, 3 Rz), RGB9E5.
/// The sides x, y, z follow each other along z. The positive ones are the first half of y, as
/// Bevy's shader reads them; the table in its documentation has the halves the other way round.
image::Ktx2 bevy_volume(const ProbeVolume& volume);

}  // namespace lte::bake
