// A small untrained model and a made-up baked data set for the tests of infer.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "lte/data/dataset.h"
#include "lte/data/scene_sample.h"
#include "lte/scene/scene.h"
#include "tests/nn/tiny_model.h"
#include "tests/support/temp_dir.h"

namespace lte::test {

/// A floor [−2, 2]² at y = 0 with albedo 0.5, under a black 1 m² light at y = 2 of radiance (5, 4,
/// 3) that looks down.
scene::Scene lit_floor();
std::vector<Vec3> lit_floor_light();
inline constexpr Rgb kLitFloorRadiance{5, 4, 3};

/// Looks straight down at the floor from under the light.
scene::Camera downward_camera();
/// Looks at floor and light from outside, with background around them.
scene::Camera outside_camera();

/// Random surface points of a unit box with random positive values; valid, not physical.
data::SceneSample random_sample(const std::string& name, uint64_t seed);

/// Adds incident radiance from 4 x 4 random cells at `points` of the queries.
void add_random_incident(data::SceneSample* sample, size_t points, uint64_t seed);

/// Two training scenes "train0", "train1" and, if `with_test`, two test scenes "test0", "test1".
void write_random_dataset(const std::filesystem::path& folder, double scale = 16,
                          bool with_test = true);

/// Flags by which lte_render gathers a model's light, unless `rest` names another integrator.
inline std::string network_flags(const std::string& model, const std::string& rest) {
  const auto has = [&](const char* words) { return rest.find(words) != std::string::npos; };
  if (has("--integrator gather") || has("--integrator path")) return " ";
  return (has("--integrator") ? " --checkpoint " : " --integrator network --checkpoint ") + model +
         " ";
}

}  // namespace lte::test
