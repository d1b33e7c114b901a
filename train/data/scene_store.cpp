#include "train/data/scene_store.h"

#include <utility>

#include "lte/base/check.h"
#include "lte/base/log.h"
#include "lte/base/parallel.h"
#include "lte/data/sample_rows.h"
#include "lte/data/scale_rounding.h"
#include "train/data/solved_light.h"

namespace lte::train {
namespace {

template <typename T>
size_t bytes_of(const std::vector<T>& values) {
  return values.size() * sizeof(T);
}

void check_light(const std::filesystem::path& path, const data::SceneSample& sample,
                 const LightKeys& light) {
  if (light.input != nn::LightInput::Traced) return;
  const auto check = [&](bool empty, const char* tensor) {
    LTE_CHECK(!empty, path.string(), ": has no ", tensor,
              ", which model.light_input traced reads; bake the data again");
  };
  check(sample.scene_direct.empty(), "scene_direct");
  check(sample.scene_direct_back.empty(), "scene_direct_back");
}

/// Keeps the incident radiance of light that bounced at least once.
void take_incident(const std::filesystem::path& path, data::SceneSample* sample,
                   TrainingScene* scene) {
  LTE_CHECK(!sample->incident.empty(), path.string(),
            ": has no incident radiance, which a model with model.radiance_lobes learns; bake the "
            "data with incident.points");
  scene->incident = std::move(sample->incident);
  scene->incident.direct = {};
}

/// Puts light that is solved on the points into the place of the sample's estimates.
void solve_light(const TrainingScene& scene, const std::filesystem::path& solved,
                 data::SceneSample* sample) {
  radiosity::PointIrradiance light = solved_light(
      solved, scene.name,
      {scene.position, scene.normal, scene.albedo, scene.emission, scene.area, scene.light},
      sample->light_groups);
  sample->scene_direct = std::move(light.direct);
  sample->scene_indirect = std::move(light.indirect);
  sample->scene_direct_back = std::move(light.direct_back);
  sample->scene_indirect_back = std::move(light.indirect_back);
}

void take_light(data::SceneSample* sample, const LightKeys& light,
                const std::filesystem::path& solved, TrainingScene* scene) {
  if (light.input == nn::LightInput::Emission) return;
  if (light.input == nn::LightInput::Radiosity) solve_light(*scene, solved, sample);
  scene->direct = std::move(sample->scene_direct);
  scene->direct_back = std::move(sample->scene_direct_back);
  scene->indirect = std::move(sample->scene_indirect);
  scene->indirect_back = std::move(sample->scene_indirect_back);
  if (light.input != nn::LightInput::Traced) return;
  scene->error = std::move(sample->scene_error);
  scene->error_back = std::move(sample->scene_error_back);
}

}  // namespace

size_t TrainingScene::size_bytes() const {
  return bytes_of(position) + bytes_of(normal) + bytes_of(albedo) + bytes_of(emission) +
         bytes_of(area) + bytes_of(light) + bytes_of(direct) + bytes_of(indirect) +
         bytes_of(direct_back) + bytes_of(indirect_back) + bytes_of(error) + bytes_of(error_back) +
         bytes_of(query_position) + bytes_of(query_normal) + bytes_of(query_albedo) +
         bytes_of(target) + bytes_of(metallic) + bytes_of(roughness) + incident.size_bytes();
}

TrainingScene read_training_scene(const std::filesystem::path& path, const std::string& name,
                                  const LightKeys& light, const std::filesystem::path& solved) {
  data::SceneSample sample = data::read_scene_sample(path);
  check_light(path, sample, light);
  data::drop_idle_queries(&sample);
  TrainingScene scene;
  scene.name = name;
  scene.position = std::move(sample.scene_position);
  scene.normal = std::move(sample.scene_normal);
  scene.albedo = std::move(sample.scene_albedo);
  scene.emission = std::move(sample.scene_emission);
  scene.area = std::move(sample.scene_area);
  scene.light = std::move(sample.scene_light);
  scene.metallic = std::move(sample.scene_metallic);
  scene.roughness = std::move(sample.scene_roughness);
  take_light(&sample, light, solved, &scene);
  if (light.radiance) take_incident(path, &sample, &scene);
  scene.query_position = std::move(sample.query_position);
  scene.query_normal = std::move(sample.query_normal);
  scene.query_albedo = std::move(sample.query_albedo);
  scene.light_groups = sample.light_groups;
  scene.target = std::move(sample.indirect);
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
      read_training_scene(path, name, options_.light, options_.solved));
  const float extent = max_component(scene->bounds.extent());
  LTE_CHECK(extent <= options_.scale * (1 + data::kScaleRounding), path.string(), ": scene ", name,
            ": ", extent, " m wide, which exceeds the data set's scale of ", options_.scale, " m");
  return scene;
}

std::shared_ptr<const TrainingScene> SceneStore::get(size_t index) {
  return get({&index, 1}).front();
}

std::vector<std::shared_ptr<const TrainingScene>> SceneStore::get(std::span<const size_t> indices) {
  std::vector<std::shared_ptr<const TrainingScene>> scenes(indices.size());
  std::vector<std::exception_ptr> errors(indices.size());
  std::vector<size_t> missing;  // places in `indices`
  for (size_t i = 0; i < indices.size(); ++i) {
    const auto found = slots_.find(indices[i]);
    if (found != slots_.end()) {
      uses_.splice(uses_.begin(), uses_, found->second.use);
      scenes[i] = found->second.scene;
    } else if (!bad_.contains(indices[i])) {
      missing.push_back(i);
    }
  }
  parallel_for(static_cast<int64_t>(missing.size()), 1, [&](int64_t begin, int64_t end) {
    for (int64_t k = begin; k < end; ++k) {
      const size_t i = missing[static_cast<size_t>(k)];
      try {
        scenes[i] = read(indices[i]);
      } catch (const Error&) {
        errors[i] = std::current_exception();
      }
    }
  });
  for (const size_t i : missing) scenes[i] = keep(indices[i], std::move(scenes[i]), errors[i]);
  return scenes;
}

std::shared_ptr<const TrainingScene> SceneStore::keep(size_t index,
                                                      std::shared_ptr<const TrainingScene> scene,
                                                      const std::exception_ptr& error) {
  try {
    if (error) std::rethrow_exception(error);
  } catch (const Error& why) {
    if (!options_.skip_bad)
      throw Error(concat(why.what(), "; data.on_bad_scene=skip goes on without such scenes"));
    if (!bad_.insert(index).second) return nullptr;
    LTE_CHECK(bad_.size() < entries_.size(), root_.string(), ": none of its ", entries_.size(),
              " scenes can be used; of the last: ", why.what());
    log_warning("scene ", name(index), " is skipped: ", why.what());
    return nullptr;
  }
  const auto [slot, fresh] = slots_.try_emplace(index);
  if (!fresh) return slot->second.scene;  // asked for twice at once
  uses_.push_front(index);
  slot->second = {scene, uses_.begin()};
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
