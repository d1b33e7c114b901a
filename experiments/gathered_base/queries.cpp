#include "experiments/gathered_base/queries.h"

#include <algorithm>
#include <utility>

#include "lte/base/check.h"
#include "lte/base/random.h"
#include "lte/base/safetensors.h"
#include "lte/pathtrace/irradiance.h"
#include "lte/pathtrace/reach/reach.h"
#include "lte/scene/sampler.h"

namespace lte::experiments {
namespace {

constexpr uint64_t kPoints = 11, kFirst = 12, kSecond = 13, kFew = 14;

const float* floats(const std::vector<Vec3>& values) {
  static_assert(sizeof(Vec3) == 3 * sizeof(float));
  return reinterpret_cast<const float*>(values.data());
}

/// What the file has by name.
template <typename Use>
void for_each_array(Queries* queries, const Use& use) {
  use("position", &queries->position);
  use("a", &queries->references.a);
  use("b", &queries->references.b);
  use("few", &queries->references.few);
}

void write(const std::filesystem::path& path, Queries* queries) {
  SafetensorsWriter writer;
  const auto points = static_cast<int64_t>(queries->position.size());
  for_each_array(queries, [&](const char* name, const std::vector<Vec3>* values) {
    writer.add(name, {points, 3}, floats(*values));
  });
  writer.write(path);
}

void read(const std::filesystem::path& path, Queries* queries) {
  const SafetensorsFile file(path);
  const auto points = static_cast<int64_t>(queries->position.size());
  const std::vector<Vec3> drawn = queries->position;
  for_each_array(queries, [&](const char* name, std::vector<Vec3>* values) {
    const auto* kept = reinterpret_cast<const Vec3*>(file.values<float>(name, {points, 3}).data());
    values->assign(kept, kept + points);
  });
  LTE_CHECK(queries->position == drawn, path.string(), ": has references of other points");
}

}  // namespace

Queries make_queries(const render::TracedScene& scene, const QueryOptions& options,
                     const std::filesystem::path& file) {
  scene::SamplerOptions sampler;
  sampler.seed = hash_combine(options.seed, kPoints);
  sampler.filter_footprint = false;
  sampler.punctual_lights = false;
  sampler.environment_share = 0;
  pathtrace::PruneCounts pruned;
  scene::SurfaceSamples points = pathtrace::sample_reached_surface(
      scene.bvh, options.points, sampler, pathtrace::Purpose::Queries,
      {.max_depth = options.max_depth, .seed = sampler.seed}, &pruned);
  LTE_CHECK(points.size() > 0, "no light reaches the surfaces");
  Queries out{std::move(points.position), std::move(points.normal), std::move(points.albedo), {}};
  if (!file.empty() && std::filesystem::exists(file)) {
    read(file, &out);
    return out;
  }
  const auto trace = [&](int paths, uint64_t stream) {
    pathtrace::IrradianceOptions rays;
    rays.rays = paths;
    rays.max_depth = options.max_depth;
    rays.seed = hash_combine(options.seed, stream);
    rays.variance = false;
    const pathtrace::Irradiance light =
        pathtrace::estimate_irradiance(scene.bvh, scene.lights, out.position, out.normal, rays);
    std::vector<Rgb> indirect;
    for (int64_t i = 0; i < light.points; ++i) indirect.push_back(light.indirect_sum(i));
    return indirect;
  };
  out.references = {trace(options.paths, kFirst), trace(options.paths, kSecond),
                    trace(kFewPaths, kFew)};
  if (!file.empty()) write(file, &out);
  return out;
}

}  // namespace lte::experiments
