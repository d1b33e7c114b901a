// Light for scenes that have none, or too little.
#pragma once

#include <span>
#include <string>

#include "lte/scene/scene.h"

namespace lte::pathtrace {

/// Adds a luminaire to a scene.
///
/// "x,y,z,power" is a white point light of so many watts: power / 4π W/sr in each channel.
///
/// "auto" gives light to where `cameras` stand. For those in rooms it hangs a white panel, a square
/// that shines downwards, 2 % of the room's height below the ceiling in each room of the scene. A
/// room is what one panel lights: places where somebody could stand (room_places.h) and that see
/// the panel's place. The widest place comes first, and gets its panel in the middle of the ceiling
/// there; what does not see it is another room. A panel's side is 30 % of the narrower side of its
/// room, its power 10 W for each m² of the room's floor as the panel measures it, along the axes.
/// Cameras that see the scene from outside get an environment of radiance 1, as --environment 1,1,1
/// gives it, unless the scene has one; so does a scene where no panel can hang.
/// @param cameras  none: the automatic one, which stands in a room if there is any
/// @return what was added, for people: "a panel of 1.2 x 1.2 m and 170 W at 2 2.45 1.5"
/// @throws lte::Error naming `text` if it is neither
std::string add_light(const std::string& text, std::span<const scene::Camera> cameras,
                      scene::Scene* scene);

inline std::string add_light(const std::string& text, scene::Scene* scene) {
  return add_light(text, {}, scene);
}

}  // namespace lte::pathtrace
