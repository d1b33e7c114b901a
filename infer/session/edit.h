// Edits of a live scene: what may change while a session answers pictures and points.
//
// Instances, luminaires and materials go by numbers that stay theirs for the life of a session,
// whatever is added or removed beside them. A removed one's number is given to no other, and comes
// back with it when the removal is undone.
#pragma once

#include <optional>
#include <string>
#include <variant>

#include "lte/base/math.h"
#include "lte/scene/scene.h"

namespace lte::infer {

/// Places an instance anew. An emissive one takes its light along.
struct MoveInstance {
  int instance = scene::kNone;
  Affine to_world;  ///< finite, and not singular
};

/// Dims or recolors a luminaire. What is not given stays.
struct SetLight {
  int light = scene::kNone;
  /// Over the brightness that the luminaire had in the file; 0 switches it off.
  std::optional<double> gain = {};
  /// Linear Rec.709, the largest component 1: other values are divided by theirs. The brightness,
  /// that is the largest component of the emission, stays as `gain` has it.
  std::optional<Rgb> color = {};
};

/// Places a point or spot light, or turns a spot or a sun. Luminaires with a surface are moved by
/// MoveInstance.
struct MoveLight {
  int light = scene::kNone;
  std::optional<Vec3> position = {};   ///< point and spot lights
  std::optional<Vec3> direction = {};  ///< the way light travels; spot lights and suns; any length
};

/// Changes the base color of a material, the factor beside its texture: the albedo of what is no
/// metal.
struct SetMaterial {
  int material = scene::kNone;
  Rgb base_color;  ///< each component in [0, 1]
};

/// Places another copy of an instance's mesh. A copy of a luminaire is a luminaire of its own.
struct AddInstance {
  int like = scene::kNone;
  Affine to_world;
};

struct RemoveInstance {
  int instance = scene::kNone;
};

/// Adds a point or spot light or a sun. Its light_group is not read.
struct AddLight {
  scene::PunctualLight light;
};

/// Removes a luminaire: a punctual light, the environment, or the instances that shine as it.
struct RemoveLight {
  int light = scene::kNone;
};

/// Gives the scene another environment, or takes it away. Its light_group is not read.
struct SetEnvironment {
  std::optional<scene::Environment> environment;
};

using Edit = std::variant<MoveInstance, SetLight, MoveLight, SetMaterial, AddInstance,
                          RemoveInstance, AddLight, RemoveLight, SetEnvironment>;

}  // namespace lte::infer
