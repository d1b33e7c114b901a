#include "train/data/scene_store.h"

#include <utility>

#include "lte/base/check.h"
#include "lte/base/log.h"
#include "lte/radiosity/point_radiosity.h"

namespace lte::train {
namespace {

template <typename T>
size_t bytes_of(const std::vector<T>& values) {
  return values.size() * sizeof(T);
}

std::vector<Rgb> both_sides(const std::vector<radiosity::PointLight::Sides>& light) {
  std::vector<Rgb> sums(light.size());
  for (size_t i = 0; i < light.size(); ++i) sums[i] = light[i][0] + light[i][1];
  return sums;
}

/// Puts into `scene` what a model of this `input` reads of the light on its points.
void take_light(data::SceneSample* sample, nn::LightInput input, TrainingScene* scene) {
  switch (input) {
    case nn::LightInput::Emission:
      return;
    case nn::LightInput::Direct:
      scene->direct = std::move(sample->scene_direct);
      return;
    case nn::LightInput::Traced:
      scene->direct = std::move(sample->scene_direct);
      scene->indirect = std::move(sample->scene_indirect);
      return;
    case nn::LightInput::Radiosity: {
      const radiosity::PointLight light =
          radiosity::solve({scene->position, scene->normal, scene->albedo, scene->emission,
                            scene->area, scene->light},
                           sample->light_groups);
      scene->direct = both_sides(light.direct);
      scene->indirect = both_sides(light.indirect);
      return;
    }
  }
}

}  // namespace

size_t TrainingScene::size_bytes() const {
  return bytes_of(position) + bytes_of(normal) + bytes_of(albedo) + bytes_of(emission) +
         bytes_of(area) + bytes_of(light) + bytes_of(direct) + bytes_of(indirect) +
         bytes_of(query_position) + bytes_of(query_normal) + bytes_of(query_albedo) +
         bytes_of(target) + bytes_of(scores.noise) + bytes_of(scores.slope);
}

TrainingScene read_training_scene(const std::filesystem::path& path, const std::string& name,
                                  nn::Target target, nn::LightInput light_input) {
  data::SceneSample sample = data::read_scene_sample(path);
  const bool needs_estimates =
      light_input == nn::LightInput::Direct || light_input == nn::LightInput::Traced;
  LTE_CHECK(!needs_estimates || !sample.scene_direct.empty(), path.string(),
            ": has no scene_direct, which model.light_input ", enum_name(light_input),
            " reads; bake the data again");
  data::drop_idle_queries(&sample);
  TrainingScene scene;
  scene.name = name;
  scene.scores.noise = query_noise(sample);  // while the sample is whole
  scene.position = std::move(sample.scene_position);
  scene.normal = std::move(sample.scene_normal);
  scene.albedo = std::move(sample.scene_albedo);
  scene.emission = std::move(sample.scene_emission);
  scene.area = std::move(sample.scene_area);
  scene.light = std::move(sample.scene_light);
  take_light(&sample, light_input, &scene);
  scene.query_position = std::move(sample.query_position);
  scene.query_normal = std::move(sample.query_normal);
  scene.query_albedo = std::move(sample.query_albedo);
  scene.light_groups = sample.light_groups;
  scene.target = std::move(sample.indirect);
  if (target == nn::Target::Total) {
    for (size_t i = 0; i < scene.target.size(); ++i) scene.target[i] += sample.direct[i];
  }
  scene.scores.slope = query_slope(scene.query_position, scene.query_normal, scene.target);
  for (const Vec3& p : scene.position) scene.bounds.extend(p);
  return scene;
}

SceneStore::SceneStore(std::filesystem::path root, std::vector<data::DatasetEntry> entries,
                       SceneStoreOptions options)
    : root_(std::move(root)), entries_(std::move(entries)), options_(std::move(options)) {}

std::shared_ptr<const TrainingScene> SceneStore::read(size_t index) const {
  const std::string& name = entries_.at(index).name;
  const std::filesystem::path path = data::scene_path(root_, name);
  auto scene = std::make_shared<const TrainingScene>(
      read_training_scene(path, name, options_.target, options_.light_input));
  const float extent = max_component(scene->bounds.extent());
  LTE_CHECK(extent <= static_cast<float>(options_.scale), path.string(), ": scene ", name, ": ",
            extent, " m wide, which exceeds the data set's scale of ", options_.scale, " m");
  return scene;
}

std::shared_ptr<const TrainingScene> SceneStore::get(size_t index) {
  const auto found = slots_.find(index);
  if (found != slots_.end()) {
    uses_.splice(uses_.begin(), uses_, found->second.use);
    return found->second.scene;
  }
  if (bad_.contains(index)) return nullptr;
  std::shared_ptr<const TrainingScene> scene;
  try {
    scene = read(index);
  } catch (const Error& error) {
    if (!options_.skip_bad)
      throw Error(concat(error.what(), "; data.on_bad_scene=skip goes on without such scenes"));
    bad_.insert(index);
    LTE_CHECK(bad_.size() < entries_.size(), root_.string(), ": none of its ", entries_.size(),
              " scenes can be used; of the last: ", error.what());
    log_warning("scene ", name(index), " is skipped: ", error.what());
    return nullptr;
  }
  uses_.push_front(index);
  slots_[index] = {scene, uses_.begin()};
  cached_bytes_ += scene->size_bytes();
  while (cached_bytes_ > options_.cache_bytes && uses_.size() > 1) {
    const auto oldest = slots_.find(uses_.back());
    cached_bytes_ -= oldest->second.scene->size_bytes();
    slots_.erase(oldest);
    uses_.pop_back();
  }
  return scene;
}

}  // namespace lte::train
