// Which way is up in a file whose format does not say.
#pragma once

#include <string>

#include "lte/scene/scene.h"

namespace lte::scene {

/// The help of a flag that set_up_axis() reads.
inline constexpr const char* kUpHelp =
    "Axis that points up in an .obj, .ply or .pbrt file: z turns the whole scene about X, so that "
    "(x, y, z) becomes (x, z, -y); glTF is y by its specification";

/// Turns all of a scene, its lights, cameras and environment included, about X so that what was +Z
/// becomes +Y: (x, y, z) becomes (x, z, −y), as Blender's exporters do it. A picture by one of its
/// cameras stays the same.
void turn_z_up(Scene* scene);

/// Does what `--up AXIS` asks for.
/// @param axis  "y" or "z"
/// @param file  the scene's, whose extension tells the format
/// @throws lte::Error for z and a glTF file, and for any other word.
void set_up_axis(const std::string& axis, const std::string& file, Scene* scene);

}  // namespace lte::scene
