#include "experiments/stability/stress_answers.h"

#include <algorithm>
#include <memory>
#include <span>
#include <utility>

#include "infer/renderer/renderer.h"
#include "lte/base/timer.h"
#include "lte/embed/scene_points.h"
#include "lte/embed/untrained_light.h"
#include "lte/pathtrace/irradiance.h"
#include "lte/runtime/embedding.h"
#include "lte/scene/sampler.h"

namespace lte::experiments {

using namespace infer;

namespace {

constexpr uint64_t kQuestionSeed = 7;
// Estimates keep two colors a point and light group: blocks bound that memory.
constexpr int64_t kGroupBlock = int64_t{1} << 21;

std::vector<Rgb> trace(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                       std::span<const Vec3> position, std::span<const Vec3> normal, int paths,
                       uint64_t seed) {
  pathtrace::IrradianceOptions options;
  options.rays = paths;
  options.seed = seed;
  const auto count = static_cast<int64_t>(position.size());
  const int64_t block = std::max<int64_t>(1, kGroupBlock / std::max(1, lights.groups()));
  std::vector<Rgb> out;
  for (int64_t begin = 0; begin < count; begin += block) {
    const auto b = static_cast<size_t>(begin),
               n = static_cast<size_t>(std::min(block, count - begin));
    const pathtrace::Irradiance part = pathtrace::estimate_irradiance(
        bvh, lights, position.subspan(b, n), normal.subspan(b, n), options, begin);
    for (int64_t i = 0; i < static_cast<int64_t>(n); ++i) out.push_back(part.total(i));
  }
  return out;
}

std::vector<Rgb> ask_network(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                             const runtime::Network& network, const StressQuestions& moved,
                             const StressVariation& variation) {
  const int64_t count =
      moved.scene_points > 0 ? moved.scene_points : network.metadata().scene_points;
  scene::SurfaceSamples samples = embed::sample_scene_points(
      bvh, count, network.metadata().scene_points_pruned, variation.seed, nullptr);
  embed::drop_untrained_suns(bvh.scene(), network.metadata(), &samples);
  embed::LitSamples lit = embed::add_light_estimates(bvh, lights, std::move(samples),
                                                     network.light_request(), variation.seed);
  if (variation.edit) variation.edit(&lit);
  runtime::EncodeOptions encoding;
  encoding.rescale = true;
  const runtime::SceneEmbedding embedding(network, lit.points(), encoding);
  if (!variation.reverse_queries)
    return embedding.decode({moved.position, moved.normal, moved.albedo});
  const auto reversed = [](const std::vector<Vec3>& values) {
    return std::vector<Vec3>(values.rbegin(), values.rend());
  };
  const std::vector<Vec3> position = reversed(moved.position), normal = reversed(moved.normal),
                          albedo = reversed(moved.albedo);
  return reversed(embedding.decode({position, normal, albedo}));
}

}  // namespace

WorkTime time_work(const std::function<void()>& work) {
  const double begin = processor_seconds();
  const Timer timer;
  work();
  return {timer.seconds(), processor_seconds() - begin};
}

StressQuestions ask_stress_room(int64_t points, int paths, int64_t scene_points) {
  StressQuestions out;
  out.paths = paths;
  out.scene_points = scene_points;
  const scene::SurfaceSamples samples =
      scene::sample_surface(make_stress_room({}), points, {.seed = kQuestionSeed});
  for (size_t i = 0; i < samples.position.size(); ++i) {
    if (max_component(samples.emission[i]) > 0) continue;
    out.position.push_back(samples.position[i]);
    out.normal.push_back(samples.normal[i]);
    out.albedo.push_back(samples.albedo[i]);
  }
  return out;
}

StressAnswers answer(const StressRoom& room, const StressQuestions& questions,
                     const runtime::Network& network, const StressVariation& variation) {
  StressAnswers out;
  StressQuestions moved = questions;
  for (Vec3& p : moved.position) p = p * room.scale + room.offset;
  const scene::Scene scene = make_stress_room(room);
  out.triangles = scene.triangle_count();
  std::unique_ptr<pathtrace::Bvh> bvh;
  std::unique_ptr<pathtrace::Lights> lights;
  out.bvh = time_work([&] {
    bvh = std::make_unique<pathtrace::Bvh>(scene);
    lights = std::make_unique<pathtrace::Lights>(scene);
  });
  if (variation.paths) {
    out.paths_time = time_work([&] {
      out.paths = trace(*bvh, *lights, moved.position, moved.normal, moved.paths, variation.seed);
    });
  }
  if (variation.network) {
    out.network_time =
        time_work([&] { out.network = ask_network(*bvh, *lights, network, moved, variation); });
  }
  return out;
}

}  // namespace lte::experiments
