#include "tests/infer/fixture.h"

#include "lte/base/half.h"
#include "lte/base/random.h"
#include "lte/pathtrace/incident/hemisphere_bins.h"
#include "tests/support/scenes.h"

namespace lte::test {
namespace {

namespace fs = std::filesystem;

constexpr int64_t kScenePoints = 256, kQueries = 200;
constexpr int kViewWidth = 16, kViewHeight = 12;

Vec3 random_vec(Rng* rng, float low, float high) {
  const float x = rng->uniform(low, high), y = rng->uniform(low, high), z = rng->uniform(low, high);
  return {x, y, z};
}

std::vector<Vec3> random_vecs(Rng* rng, size_t count, float low, float high) {
  std::vector<Vec3> out(count);
  for (Vec3& value : out) value = random_vec(rng, low, high);
  return out;
}

/// Points on the faces of the unit box, with the faces' normals.
void random_surface(Rng* rng, size_t count, std::vector<Vec3>* position,
                    std::vector<Vec3>* normal) {
  *position = random_vecs(rng, count, 0, 1);
  normal->assign(count, Vec3{});
  for (size_t i = 0; i < count; ++i) {
    const int axis = static_cast<int>(rng->below(3)), side = static_cast<int>(rng->below(2));
    (*position)[i][axis] = static_cast<float>(side);
    (*normal)[i][axis] = side ? -1.0f : 1.0f;
  }
}

data::View random_view(Rng* rng, int64_t groups) {
  data::View view;
  view.width = kViewWidth;
  view.height = kViewHeight;
  const size_t pixels = size_t{kViewWidth} * kViewHeight;
  random_surface(rng, pixels, &view.position, &view.normal);
  view.albedo = random_vecs(rng, pixels, 0.1f, 0.9f);
  view.direct = random_vecs(rng, pixels * static_cast<size_t>(groups), 0, 2);
  view.indirect = random_vecs(rng, pixels * static_cast<size_t>(groups), 0.1f, 1);
  view.variance.assign(pixels, 1e-4f);
  view.path_traced_64 = random_vecs(rng, pixels, 0.1f, 2);
  view.mask.assign(pixels, 1);
  for (size_t i = 0; i < pixels; i += 29) {  // a few pixels of background
    view.mask[i] = 0;
    view.position[i] = view.normal[i] = view.albedo[i] = view.path_traced_64[i] = {};
    view.variance[i] = 0;
    for (size_t g = 0; g < static_cast<size_t>(groups); ++g)
      view.direct[g * pixels + i] = view.indirect[g * pixels + i] = {};
  }
  return view;
}

}  // namespace

std::vector<Vec3> lit_floor_light() {
  return {{-0.5f, 2, -0.5f}, {0.5f, 2, -0.5f}, {0.5f, 2, 0.5f}, {-0.5f, 2, 0.5f}};
}

scene::Scene lit_floor() {
  scene::Scene scene;
  scene.name = "lit_floor";
  const int gray = add_material(&scene, {0.5f, 0.5f, 0.5f});
  const int light = add_material(&scene, {0, 0, 0}, kLitFloorRadiance);
  add_quad(&scene, {-2, 0, -2}, {0, 0, 4}, {4, 0, 0}, gray);         // front: z × x = +y
  add_quad(&scene, {-0.5f, 2, -0.5f}, {1, 0, 0}, {0, 0, 1}, light);  // front: x × z = −y
  return scene;
}

scene::Camera downward_camera() { return {"down", {0, 1.5f, 0}, {0, 0, 0}, {0, 0, -1}, 60}; }
scene::Camera outside_camera() { return {"outside", {0, 0.3f, 3.5f}, {0, 1.2f, 0}, {0, 1, 0}, 70}; }

data::SceneSample random_sample(const std::string& name, uint64_t seed) {
  Rng rng(seed);
  data::SceneSample sample;
  sample.name = name;
  sample.seed = seed;
  sample.light_groups = 2;
  sample.bounds_low = {0, 0, 0};
  sample.bounds_high = {1, 1, 1};
  random_surface(&rng, kScenePoints, &sample.scene_position, &sample.scene_normal);
  sample.scene_albedo = random_vecs(&rng, kScenePoints, 0.1f, 0.9f);
  sample.scene_emission.assign(kScenePoints, {});
  sample.scene_area.assign(kScenePoints, 6.0f / kScenePoints);
  sample.scene_light.assign(kScenePoints, -1);
  for (int i = 0; i < 16; ++i) {
    sample.scene_emission[static_cast<size_t>(i)] = random_vec(&rng, 1, 8);
    sample.scene_light[static_cast<size_t>(i)] = i % 2;
  }
  random_surface(&rng, kQueries, &sample.query_position, &sample.query_normal);
  sample.query_albedo = random_vecs(&rng, kQueries, 0.1f, 0.9f);
  sample.direct = random_vecs(&rng, 2 * kQueries, 0, 2);
  sample.indirect = random_vecs(&rng, 2 * kQueries, 0.1f, 1);
  sample.variance.assign(kQueries, 1e-4f);
  sample.path_traced_64 = random_vecs(&rng, kQueries, 0.1f, 2);
  sample.rays = 256;
  for (int i = 0; i < 2; ++i) sample.views.push_back(random_view(&rng, sample.light_groups));
  return sample;
}

void add_random_incident(data::SceneSample* sample, size_t points, uint64_t seed) {
  constexpr int kBins = 4;
  Rng rng(seed);
  data::IncidentField& field = sample->incident;
  field.bins = kBins;
  field.samples = 3;
  for (int row = 0; row < kBins; ++row) {
    for (int column = 0; column < kBins; ++column) {
      const auto centre = [](int cell) { return (static_cast<float>(cell) + 0.5f) / kBins; };
      field.direction.push_back(pathtrace::bin_direction({centre(column), centre(row)}));
      field.pdf.push_back(
          static_cast<float>(1 / (kBins * kBins * pathtrace::bin_solid_angle(kBins, row, column))));
    }
  }
  for (size_t i = 0; i < points; ++i) {
    field.position.push_back(sample->query_position[i]);
    field.normal.push_back(sample->query_normal[i]);
    field.tangent.push_back(pathtrace::bin_tangent(sample->query_normal[i]));
    field.albedo.push_back(sample->query_albedo[i]);
    field.metallic.push_back(0);
    field.roughness.push_back(1);
    field.scale.push_back(i % 2 == 0 ? 0.5f : 0.125f);
  }
  const size_t values = static_cast<size_t>(sample->light_groups) * points * kBins * kBins * 3;
  for (size_t i = 0; i < values; ++i) {
    field.direct.push_back(to_half(rng.uniform(0, 4)));
    field.indirect.push_back(to_half(rng.uniform(0, 2)));
  }
}

void write_random_dataset(const fs::path& folder, double scale, bool with_test) {
  fs::create_directories(folder / "scenes");
  data::DatasetInfo info;
  info.tool_version = "test";
  info.scale = scale;
  uint64_t seed = 10;
  const auto add = [&](const std::string& name, data::Split split) {
    const data::SceneSample sample = random_sample(name, seed);
    data::write_scene_sample(data::scene_path(folder, name), sample);
    info.scenes.push_back({name, split, seed++, sample.scene_points(), sample.query_points()});
  };
  add("train0", data::Split::Train);
  add("train1", data::Split::Train);
  if (with_test) {
    add("test0", data::Split::Test);
    add("test1", data::Split::Test);
  }
  data::write_dataset_info(folder, info);
}

}  // namespace lte::test
