// Environments from a text, as a user gives them.
#pragma once

#include <string>

#include "lte/scene/scene.h"

namespace lte::scene {

/// Gives the scene an environment, in the place of one it has.
/// @param text  "R,G,B", a constant radiance, or the name of an equirectangular picture: OpenEXR,
///              Radiance HDR, PFM (linear radiance), PNG, JPEG, TGA (decoded from the sRGB curve);
///              what is negative counts as 0
/// @param turn_degrees  about +Y, counter-clockwise from above
/// @throws lte::Error naming `text`: neither three numbers nor a file, negative, not finite,
/// broken.
void set_environment(const std::string& text, double turn_degrees, Scene* scene);

/// Adds the light group of an environment that has none yet.
void add_environment_group(Scene* scene);

}  // namespace lte::scene
