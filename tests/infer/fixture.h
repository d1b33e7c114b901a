// A small untrained model, a scratch folder and a made-up baked data set for the tests of infer.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "lte/data/dataset.h"
#include "lte/data/scene_sample.h"
#include "lte/nn/config.h"
#include "lte/scene/scene.h"

namespace lte::test {

/// A folder of its own, removed at the end.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }
  /// Names of the entries, sorted.
  std::vector<std::string> names() const;

 private:
  std::filesystem::path path_;
};

struct TinyModel {
  int64_t channels = 32;
  nn::Target target = nn::Target::Indirect;
  double scale = 16;
  int64_t scene_points = 300;
  bool pruned = false;
  nn::LightInput light_input = nn::LightInput::Emission;
  uint64_t seed = 1;
};

/// Random weights; saved as the trainer saves.
void save_tiny_model(const std::filesystem::path& path, const TinyModel& tiny = {});

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

/// Two training scenes "train0", "train1" and, if `with_test`, two test scenes "test0", "test1".
void write_random_dataset(const std::filesystem::path& folder, double scale = 16,
                          bool with_test = true);

}  // namespace lte::test
