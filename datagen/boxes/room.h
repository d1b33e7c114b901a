// A room or two furnished with boxes and cylinders: scenes that are made fast and have few
// triangles. datagen/homes makes the detailed ones.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "datagen/common/ceiling_light_distances.h"
#include "datagen/common/range.h"
#include "lte/base/math.h"
#include "lte/scene/scene.h"

namespace lte::datagen::boxes {

/// `boxes:` in the YAML config.
struct RoomConfig {
  Range width_m{2.5, 7}, depth_m{2.5, 7}, height_m{2.3, 3.2};
  CountRange furniture{4, 12};   ///< pieces a room that are tried; some find no free place
  CountRange lights{1, 3};       ///< ceiling lights a scene
  Range radiance{2, 40};         ///< of a light, W sr^-1 m^-2 (luminance), log-uniform
  double two_room_share = 0.25;  ///< of scenes: two rooms and a doorway between them
  /// Of scenes: one side of each room has no wall, so that light leaves it, and every wall that is
  /// left has a color of its own.
  double open_share = 0;
  /// Of scenes with a side open: a sky shines in, in half of them a sun with it, and in half of
  /// them in place of the ceiling lights. Its radiance is 1/40 to 1/4 of `radiance`.
  double sky_share = 0;
  /// Of scenes with every wall: such a sky outside, none of whose light comes in.
  double shut_sky_share = 0;
  double sky_picture_share = 0;  ///< of skies: one of CIE's in place of one radiance
  Range size_factor{1, 1};       ///< the furnished scene is made larger by it, log-uniform
  std::vector<int64_t> texture_sizes{128, 256};  ///< texels an edge; one is drawn a texture
};

inline constexpr double kMaxPartitionThickness = 0.2;  ///< metres

/// A piece of furniture as it stands in the world.
struct PlacedPiece {
  std::string name;
  int room = 0;
  Bounds bounds;  ///< world
};

/// Where everything is, for tests and for people to look at.
struct RoomPlan {
  std::vector<Bounds> rooms;            ///< inner boxes, one or two, side by side along x
  Bounds doorway;                       ///< the opening in the partition; empty for one room
  std::vector<unsigned> missing_walls;  ///< of each room: 0, or the face (kNegX, ...) left open
  std::vector<PlacedPiece> furniture;
  std::vector<Bounds> lights;  ///< housings, flush with the ceiling; the bottom face emits
};

struct Room {
  scene::Scene scene;
  RoomPlan plan;
};

/// Makes a room of Lambertian, textured surfaces, closed but for `missing_walls`, with one light
/// group a ceiling light, one for a sun and one for a sky. Y is up, units are metres, the floor is
/// at y = 0. The same (config, seed) gives the same room.
/// @throws lte::Error if no ceiling light fits a room of the configured size.
Room generate_room(const RoomConfig& config, uint64_t seed, const std::string& name = "room");

}  // namespace lte::datagen::boxes
