// Light solved on the points of scenes, kept as files: a run that goes on, and every later run on
// the same data, reads in milliseconds what takes about a second a scene.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "lte/radiosity/point_radiosity.h"

namespace lte::train {

/// radiosity::solve(), or what FOLDER/NAME.safetensors keeps of an earlier call with the same
/// points and solver. Solutions of others, and damaged ones, are replaced. Where none can be
/// written a warning says so, and the solution is returned all the same. Processes may share the
/// folder.
/// @param folder  made if missing; empty: nothing is kept
/// @param name    of the scene in its data set
/// @throws lte::Error as radiosity::solve()
radiosity::PointIrradiance solved_light(const std::filesystem::path& folder,
                                        const std::string& name, const radiosity::Points& points,
                                        int64_t groups);

}  // namespace lte::train
