#include "lte/embed/culled_lights.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "lte/base/random.h"
#include "lte/base/text.h"
#include "lte/pathtrace/gbuffer.h"
#include "lte/pathtrace/irradiance.h"
#include "lte/pathtrace/lights/lights.h"

namespace lte::embed {
namespace {

constexpr int kWidth = 24, kHeight = 18;  ///< places of one camera
constexpr size_t kMaxCameras = 24;        ///< of a turntable say, evenly spread
constexpr int kPaths = 64;                ///< from a place that a camera sees
constexpr int kAllPaths = kPaths * kWidth * kHeight;
constexpr size_t kBlock = 4096;  ///< places of one search
constexpr int kMinPaths = 4;     ///< from a place, however many there are
// Most lights are found at once: these are traced before all others.
constexpr int kFirstPaths = 2;
constexpr uint64_t kFirst = 1;
constexpr int kNoRoulette = 1 << 20;

struct Places {
  std::vector<Vec3> position, normal;
};

Places seen_places(const pathtrace::Bvh& bvh, std::span<const scene::Camera> cameras) {
  const size_t views = std::min(cameras.size(), kMaxCameras);
  const double shrink = 1 / std::sqrt(static_cast<double>(std::max<size_t>(views, 1)));
  const auto edge = [&](int of_one) { return std::max(4, static_cast<int>(of_one * shrink)); };
  Places places;
  for (size_t view = 0; view < views; ++view) {
    const pathtrace::GBuffer hits = pathtrace::trace_gbuffer(
        bvh, cameras[view * cameras.size() / views], edge(kWidth), edge(kHeight));
    for (size_t i = 0; i < hits.mask.size(); ++i) {
      if (hits.mask[i] == 0) continue;
      places.position.push_back(hits.position[i]);
      places.normal.push_back(hits.geometric(i));
    }
  }
  return places;
}

/// Which groups some light of has been found, one flag each.
void note_arrivals(const pathtrace::Irradiance& found, std::vector<uint8_t>* arrived) {
  for (int64_t group = 0; group < found.groups; ++group) {
    const auto lights = [&](const std::vector<Rgb>& light) {
      const auto first = light.begin() + group * found.points;
      return std::any_of(first, first + found.points,
                         [](const Rgb& value) { return max_component(value) > 0; });
    };
    if (lights(found.direct) || lights(found.indirect)) (*arrived)[static_cast<size_t>(group)] = 1;
  }
}

/// Notes which groups' light arrives, a block of places at a time, as what is found has a value for
/// each group and place. @return whether all have been found; then no more is traced
bool find_arrivals(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                   std::span<const Vec3> position, std::span<const Vec3> normal, int paths,
                   uint64_t seed, std::vector<uint8_t>* arrived) {
  pathtrace::IrradianceOptions options;
  options.rays = paths;
  options.seed = seed;
  options.roulette_depth = kNoRoulette;
  options.variance = false;
  for (size_t first = 0; first < position.size(); first += kBlock) {
    const size_t count = std::min(kBlock, position.size() - first);
    note_arrivals(pathtrace::estimate_irradiance(bvh, lights, position.subspan(first, count),
                                                 normal.subspan(first, count), options,
                                                 static_cast<int64_t>(first)),
                  arrived);
    if (std::ranges::count(*arrived, 0) == 0) return true;
  }
  return false;
}

/// @param paths  from each place
std::vector<int> without_arrivals(const pathtrace::Bvh& bvh, std::span<const Vec3> position,
                                  std::span<const Vec3> normal, int paths, uint64_t seed) {
  const pathtrace::Lights lights(bvh.scene(), pathtrace::LightChoice::EachGroup);
  std::vector<int> culled;
  if (lights.empty() || position.empty()) return culled;
  std::vector<uint8_t> arrived(static_cast<size_t>(lights.groups()));
  if (find_arrivals(bvh, lights, position, normal, kFirstPaths, hash_combine(seed, kFirst),
                    &arrived) ||
      find_arrivals(bvh, lights, position, normal, paths, seed, &arrived))
    return culled;
  for (size_t group = 0; group < arrived.size(); ++group) {
    if (!arrived[group]) culled.push_back(static_cast<int>(group));
  }
  return culled;
}

}  // namespace

std::vector<int> culled_lights(const pathtrace::Bvh& bvh, const Receivers& receivers,
                               uint64_t seed) {
  if (const auto* cameras = std::get_if<std::vector<scene::Camera>>(&receivers)) {
    const Places seen = seen_places(bvh, *cameras);
    return without_arrivals(bvh, seen.position, seen.normal, kPaths, seed);
  }
  const auto& [position, normal] = std::get<SurfacePlaces>(receivers);
  const auto share = static_cast<int>(kAllPaths / std::max<size_t>(position.size(), 1));
  return without_arrivals(bvh, position, normal, std::max(kMinPaths, share), seed);
}

std::vector<std::string> names_of(const scene::Scene& scene, std::span<const int> groups) {
  std::vector<std::string> names;
  for (const int group : groups) names.push_back(scene.light_groups[static_cast<size_t>(group)]);
  return names;
}

std::string culled_lights_note(const scene::Scene& scene, std::span<const int> groups,
                               const Receivers& receivers) {
  std::string names;
  for (const std::string& name : names_of(scene, groups))
    names += concat(names.empty() ? "" : ", ", name);
  const bool places = std::holds_alternative<SurfacePlaces>(receivers);
  return concat("the network does not read light that does not reach ",
                places ? "the points" : "what is seen", " (", names,
                "); with --set prune=off it reads all");
}

void keep_points(const std::function<bool(int group)>& keeps, scene::SurfaceSamples* samples) {
  std::vector<size_t> rows;
  for (size_t i = 0; i < samples->light_group.size(); ++i) {
    if (keeps(samples->light_group[i])) rows.push_back(i);
  }
  samples->keep(rows);
}

void darken(std::span<const int> groups, int64_t all_groups, pathtrace::LightEstimates* light) {
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

}  // namespace lte::embed
