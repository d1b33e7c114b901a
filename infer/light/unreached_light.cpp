#include "infer/light/unreached_light.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "lte/base/text.h"
#include "lte/pathtrace/gbuffer.h"
#include "lte/pathtrace/irradiance.h"
#include "lte/pathtrace/lights/lights.h"

namespace lte::infer {
namespace {

constexpr int kWidth = 24, kHeight = 18;  ///< places of one camera
constexpr size_t kMostCameras = 24;       ///< of a turntable say, evenly spread
constexpr int kPaths = 64;                ///< from a place that a camera sees
constexpr int64_t kAllPaths = int64_t{kPaths} * kWidth * kHeight;
constexpr int64_t kLeastPaths = 4;  ///< from a place, however many there are
constexpr int kNoRoulette = 1 << 20;

struct Places {
  std::vector<Vec3> position, normal;
};

Places seen_places(const pathtrace::Bvh& bvh, std::span<const scene::Camera> cameras) {
  const size_t views = std::min(cameras.size(), kMostCameras);
  const double shrink = 1 / std::sqrt(static_cast<double>(std::max<size_t>(views, 1)));
  const auto edge = [&](int of_one) { return std::max(4, static_cast<int>(of_one * shrink)); };
  Places places;
  for (size_t view = 0; view < views; ++view) {
    const pathtrace::GBuffer hits = pathtrace::trace_gbuffer(
        bvh, cameras[view * cameras.size() / views], edge(kWidth), edge(kHeight));
    for (size_t i = 0; i < hits.mask.size(); ++i) {
      if (hits.mask[i] == 0) continue;
      places.position.push_back(hits.position[i]);
      places.normal.push_back(hits.normal[i]);
    }
  }
  return places;
}

/// @param paths  from each place
std::vector<int> unreached_by(const pathtrace::Bvh& bvh, std::span<const Vec3> position,
                              std::span<const Vec3> normal, int64_t paths, uint64_t seed) {
  const pathtrace::Lights lights(bvh.scene(), pathtrace::LightChoice::EachGroup);
  std::vector<int> unreached;
  if (lights.empty() || position.empty()) return unreached;
  pathtrace::IrradianceOptions options;
  options.rays = paths;
  options.seed = seed;
  options.roulette_depth = kNoRoulette;
  options.variance = false;
  const pathtrace::Irradiance found =
      pathtrace::estimate_irradiance(bvh, lights, position, normal, options);
  for (int64_t group = 0; group < found.groups; ++group) {
    const auto arrives = [&](const std::vector<Rgb>& light) {
      const auto first = light.begin() + group * found.points;
      return std::any_of(first, first + found.points,
                         [](const Rgb& value) { return max_component(value) > 0; });
    };
    if (!arrives(found.direct) && !arrives(found.indirect))
      unreached.push_back(static_cast<int>(group));
  }
  return unreached;
}

}  // namespace

std::vector<int> unreached_groups(const pathtrace::Bvh& bvh, std::span<const Vec3> position,
                                  std::span<const Vec3> normal, uint64_t seed) {
  const auto places = static_cast<int64_t>(std::max<size_t>(position.size(), 1));
  return unreached_by(bvh, position, normal, std::max(kLeastPaths, kAllPaths / places), seed);
}

std::vector<int> unreached_groups(const pathtrace::Bvh& bvh, std::span<const scene::Camera> cameras,
                                  uint64_t seed) {
  const Places seen = seen_places(bvh, cameras);
  return unreached_by(bvh, seen.position, seen.normal, kPaths, seed);
}

std::vector<std::string> names_of(const scene::Scene& scene, std::span<const int> groups) {
  std::vector<std::string> names;
  for (const int group : groups) names.push_back(scene.light_groups[static_cast<size_t>(group)]);
  return names;
}

std::string left_out_note(const scene::Scene& scene, std::span<const int> groups,
                          std::string_view what) {
  std::string names;
  for (const std::string& name : names_of(scene, groups))
    names += concat(names.empty() ? "" : ", ", name);
  return concat("the network is not told of light that does not reach ", what, " (", names,
                "); --prune off tells it of all");
}

void keep_points(const std::function<bool(int group)>& keeps, scene::SurfaceSamples* samples) {
  std::vector<size_t> rows;
  for (size_t i = 0; i < samples->light_group.size(); ++i) {
    if (keeps(samples->light_group[i])) rows.push_back(i);
  }
  samples->keep(rows);
}

void leave_out(std::span<const int> groups, int64_t all_groups, pathtrace::LightEstimates* light) {
  const auto darken = [&](auto* values) {
    const auto points = static_cast<int64_t>(values->size()) / all_groups;
    for (const int group : groups)
      std::fill_n(values->begin() + group * points, values->empty() ? 0 : points,
                  typename std::decay_t<decltype(*values)>::value_type{});
  };
  for (std::vector<Rgb>* values :
       {&light->direct, &light->indirect, &light->direct_back, &light->indirect_back})
    darken(values);
  darken(&light->error);
  darken(&light->error_back);
}

}  // namespace lte::infer
