// Homes: floor plans of one to six furnished rooms. datagen/boxes makes simpler scenes faster.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "datagen/common/ceiling_light_distances.h"
#include "datagen/common/range.h"
#include "datagen/homes/floor_plan.h"
#include "datagen/homes/piece.h"
#include "lte/scene/scene.h"

namespace lte::datagen::homes {

/// `homes:` in the YAML config. configs/data/homes.yaml explains the keys.
struct HomeConfig {
  CountRange rooms{1, 6};
  Range height_m{2.4, 3.0};
  Range detail{1.8, 3.0};
  Range radiance{4, 30};
  double daylight_share = 0.5;
  double sun_share = 0;
  double sky_picture_share = 0;
  double lit_share = 0.7;
  double clutter = 0.7;
  std::vector<int64_t> texture_sizes{512, 1024};
};

inline constexpr float kDoorClearance = 0.75f;  ///< metres kept free on both sides of a doorway
inline constexpr float kWallGap = 0.03f;        ///< metres between furniture and a wall
inline constexpr float kWindowGap = 0.3f;       ///< metres in front of a window, above its sill

struct PlacedPiece {
  std::string name;
  int room = 0;
  int parent = -1;        ///< the piece that it stands on; -1 for the floor, a wall or the ceiling
  bool by_parts = false;  ///< others may stand between its parts
  Affine to_world;
  OrientedBox box;                  ///< of the whole piece, world
  std::vector<OrientedBox> solids;  ///< of its parts, world
};

/// Where everything is, for cameras and for tests.
struct HomePlan {
  FloorPlan floor;
  std::vector<PlacedPiece> pieces;
  std::vector<Bounds> ceiling_lights;  ///< housings, flush with the ceiling; the bottom face emits
};

struct Home {
  scene::Scene scene;
  HomePlan plan;
};

/// Makes a furnished home of textured Lambertian surfaces, with one light group a luminaire and a
/// camera in each furnished room. Y is up, units are metres, the floor is at y = 0. The same
/// (config, seed) gives the same bytes.
Home generate_home(const HomeConfig& config, uint64_t seed, const std::string& name = "home");

}  // namespace lte::datagen::homes
