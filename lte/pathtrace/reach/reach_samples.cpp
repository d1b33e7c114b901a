#include "lte/pathtrace/reach/reach_samples.h"

#include <algorithm>
#include <map>
#include <utility>

#include "lte/scene/area_table.h"

namespace lte::pathtrace {
namespace {

/// The samples of each luminaire, by light group.
using ByGroup = std::map<int, std::vector<size_t>>;

/// Keeps `count` of the indices, evenly, so that they are as stratified as they were.
void thin(int64_t count, std::vector<size_t>* indices) {
  const auto left = static_cast<int64_t>(indices->size());
  for (int64_t k = 0; k < count; ++k)
    (*indices)[static_cast<size_t>(k)] = (*indices)[static_cast<size_t>(k * left / count)];
  indices->resize(static_cast<size_t>(count));
}

void scale_areas(const std::vector<size_t>& indices, double factor,
                 scene::SurfaceSamples* samples) {
  const auto by = static_cast<float>(factor);
  for (const size_t i : indices) samples->area[i] *= by;
}

/// Σ area, and Σ emission · area over all channels.
std::pair<double, double> area_and_power(const std::vector<size_t>& indices,
                                         const scene::SurfaceSamples& samples) {
  double area = 0, power = 0;
  for (const size_t i : indices) {
    const Rgb& e = samples.emission[i];
    area += samples.area[i];
    power += (double{e.x} + double{e.y} + double{e.z}) * samples.area[i];
  }
  return {area, power};
}

/// Brings the areas of each luminaire's samples to the area of its surfaces, which the number of
/// strata that met it gives to within one only. Where there are too many luminaires for each to be
/// met, those that are stand for the others as well, and keep the areas of their strata.
void set_luminaire_areas(const scene::Scene& scene, const ByGroup& luminaires,
                         const std::vector<size_t>& lost, scene::SurfaceSamples* samples) {
  ByGroup lost_of;
  for (const size_t i : lost) lost_of[samples->light_group[i]].push_back(i);
  std::map<int, std::vector<int>> instances;
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    const scene::Instance& instance = scene.instances[i];
    const bool emits = scene.materials[scene.meshes[instance.mesh].material].emissive();
    if (emits) instances[instance.light_group].push_back(static_cast<int>(i));
  }
  std::map<int, double> factors;
  for (const auto& [group, parts] : instances) {
    const double whole = scene::AreaTable(scene, scene::emitting_faces(scene, parts)).total();
    if (!(whole > 0)) continue;
    const auto met = luminaires.find(group);
    if (met == luminaires.end() && !lost_of.contains(group)) return;
    if (met == luminaires.end()) continue;
    const double drawn = area_and_power(met->second, *samples).first +
                         area_and_power(lost_of[group], *samples).first;
    if (drawn > 0) factors[group] = whole / drawn;
  }
  for (const auto& [group, factor] : factors) scale_areas(luminaires.at(group), factor, samples);
}

/// Keeps `count` samples of a set, scaling areas so that they emit what all did.
void thin_emitters(int64_t count, std::vector<size_t>* indices, scene::SurfaceSamples* samples) {
  const auto before = area_and_power(*indices, *samples);
  thin(count, indices);
  const auto after = area_and_power(*indices, *samples);
  const bool shines = after.second > 0;
  const double factor = shines ? before.second / after.second : before.first / after.first;
  scale_areas(*indices, factor, samples);
}

/// Keeps at most `count` samples of all luminaires. Each keeps one, and of the others its share;
/// where there are more luminaires than that, chance decides and their power is kept as a whole.
std::vector<size_t> thin_luminaires(ByGroup luminaires, int64_t count,
                                    scene::SurfaceSamples* samples) {
  const auto groups = static_cast<int64_t>(luminaires.size());
  std::vector<size_t> kept;
  int64_t all = 0;
  for (const auto& [group, indices] : luminaires) all += static_cast<int64_t>(indices.size());
  int64_t seen = 0, given = 0;  // beside each luminaire's first
  for (auto& [group, indices] : luminaires) {
    if (count >= groups && all > count) {
      seen += static_cast<int64_t>(indices.size()) - 1;
      const int64_t due = seen * (count - groups) / (all - groups);
      thin_emitters(1 + due - given, &indices, samples);
      given = due;
    }
    kept.insert(kept.end(), indices.begin(), indices.end());
  }
  std::sort(kept.begin(), kept.end());
  if (count < groups) thin_emitters(count, &kept, samples);
  return kept;
}

}  // namespace

void reduce_samples(const scene::Scene& scene, KeptSamples kept, int64_t count,
                    scene::SurfaceSamples* samples) {
  ByGroup luminaires;
  for (const size_t i : kept.luminaires) luminaires[samples->light_group[i]].push_back(i);
  set_luminaire_areas(scene, luminaires, kept.lost, samples);
  const auto others = static_cast<int64_t>(kept.others.size());
  const int64_t most = std::max({int64_t{1}, count / 2, count - others});
  if (static_cast<int64_t>(kept.luminaires.size()) > most)
    kept.luminaires = thin_luminaires(std::move(luminaires), most, samples);
  const int64_t room = count - static_cast<int64_t>(kept.luminaires.size());
  if (others > room) {
    thin(room, &kept.others);
    scale_areas(kept.others, static_cast<double>(others) / static_cast<double>(room), samples);
  }
  std::vector<size_t> all(static_cast<size_t>(kept.size()));
  std::merge(kept.luminaires.begin(), kept.luminaires.end(), kept.others.begin(), kept.others.end(),
             all.begin());
  samples->keep(all);
}

}  // namespace lte::pathtrace
