// A thing with hollows that is no house.
#pragma once

#include "tests/support/scenes.h"

namespace lte::test {

/// A machine of 743 x 273 x 268 units, such as an engine drawn in millimetres: a solid block whose
/// front is outside, and in it two closed cells of a room's height and a person's width.
inline scene::Scene machine() {
  scene::Scene scene;
  const int gray = add_material(&scene, {0.5f, 0.5f, 0.5f});
  add_instance(&scene, box_mesh({0, 0, 0}, {743, 273, 268}, gray, false));
  for (const float x : {100.0f, 300.0f})
    add_instance(&scene, box_mesh({x, 40, 60}, {x + 110, 210, 170}, gray, true));
  return scene;
}

}  // namespace lte::test
