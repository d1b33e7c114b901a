#include "lte/bake/vertex_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <unordered_map>
#include <utility>

#include "lte/bake/refined_scene.h"
#include "lte/bake/vertex_fit.h"
#include "lte/base/parallel.h"

namespace lte::bake {
namespace {

/// Longest edge in texels below which a triangle is not halved.
constexpr float kLeastEdge = 3;
/// Samples along a part of a triangle whose mean is looked at.
constexpr int kPartSamples = 4;
constexpr int64_t kGrain = 256;

/// How far light is off linear interpolation over a leaf, relative: at the middles of its edges,
/// by what a vertex there would gain, and in the mean over parts of it. 0 where it is small.
double bend_of(const Picture& picture, const LeafSamples& samples, const Fit& fit, size_t leaf) {
  if (samples.longest_edge() < kLeastEdge) return 0;
  std::array<double, 3> gain{}, square{};
  const int parts = std::max(1, samples.along / kPartSamples);
  std::vector<double> sum(2 * static_cast<size_t>(parts) * static_cast<size_t>(parts));
  std::vector<double> count(sum.size());
  samples.for_each(picture, [&](const std::array<float, 3>& share, const Rgb& light) {
    const double off = double{luminance(light) - interpolated(fit, leaf, share)};
    for (size_t k = 0; k < 3; ++k) {
      const double hat = 2 * double{std::min(share[k], share[(k + 1) % 3])};
      gain[k] += hat * off;
      square[k] += hat * hat;
    }
    const float u = share[1] * static_cast<float>(parts), v = share[2] * static_cast<float>(parts);
    const auto i = static_cast<size_t>(u), j = static_cast<size_t>(v);
    const bool far = u - std::floor(u) + v - std::floor(v) > 1;
    const size_t part = 2 * (i * static_cast<size_t>(parts) + j) + (far ? 1 : 0);
    sum[part] += off;
    ++count[part];
  });
  double out = 0;
  for (size_t k = 0; k < 3; ++k) out = std::max(out, std::abs(gain[k] / square[k]));
  for (size_t k = 0; parts > 1 && k < sum.size(); ++k)
    if (count[k] > 0) out = std::max(out, std::abs(sum[k] / count[k]));
  return out / fit.level[leaf];
}

/// Leaves that bend more than they may, the worst first.
std::vector<uint32_t> bent_leaves(const Picture& picture, const RefinedScene& refined,
                                  const Fit& fit, double bend) {
  const std::vector<Leaf>& leaves = refined.leaves();
  std::vector<double> off(leaves.size());
  parallel_for(static_cast<int64_t>(leaves.size()), kGrain, [&](int64_t begin, int64_t end) {
    for (auto t = static_cast<size_t>(begin); t < static_cast<size_t>(end); ++t)
      off[t] = bend_of(picture, {picture, refined.scene().meshes[leaves[t].instance], leaves[t]},
                       fit, t);
  });
  std::vector<uint32_t> out;
  for (uint32_t t = 0; t < off.size(); ++t)
    if (off[t] > bend) out.push_back(t);
  std::stable_sort(out.begin(), out.end(), [&](uint32_t a, uint32_t b) { return off[a] > off[b]; });
  return out;
}

/// Halves the leaves, or as many of the worst as the limit leaves room for.
/// @return  whether all of them were
bool halve_some(std::vector<uint32_t> bent, int64_t most, RefinedScene* refined) {
  const auto count = [&] { return static_cast<int64_t>(refined->leaves().size()); };
  const size_t all = bent.size();
  while (!bent.empty()) {
    if (count() + static_cast<int64_t>(bent.size()) <= most) {
      RefinedScene before = *refined;
      refined->halve(bent);
      if (count() <= most) break;
      *refined = std::move(before);
    }
    bent.resize(bent.size() / 2);
  }
  return bent.size() == all;
}

double off_at(const Picture& picture, const RefinedScene& refined, const Fit& fit, double share) {
  std::vector<std::pair<double, double>> off;  // and its area
  double area = 0;
  for (size_t t = 0; t < refined.leaves().size(); ++t) {
    const Leaf& leaf = refined.leaves()[t];
    const LeafSamples samples(picture, refined.scene().meshes[leaf.instance], leaf);
    if (!(samples.area > 0)) continue;
    area += samples.area;
    samples.for_each(picture, [&](const std::array<float, 3>& at, const Rgb& light) {
      off.emplace_back(std::abs(double{luminance(light) - interpolated(fit, t, at)}) / fit.level[t],
                       samples.weight());
    });
  }
  std::sort(off.begin(), off.end());
  double below = 0;
  for (const auto& [value, weight] : off) {
    below += weight;
    if (below >= share * area) return value;
  }
  return 0;
}

/// The leaves as meshes whose vertices are told apart by what they show.
VertexLight as_meshes(const RefinedScene& refined, const Fit& fit) {
  VertexLight out;
  out.scene = refined.scene();
  const size_t count = out.scene.meshes.size();
  out.irradiance.resize(count);
  std::vector<std::unordered_map<std::string, uint32_t>> number(count);
  for (scene::Mesh& mesh : out.scene.meshes) {
    const std::string name = mesh.name;
    const int material = mesh.material;
    mesh = {};
    mesh.name = name;
    mesh.material = material;
  }
  for (size_t t = 0; t < refined.leaves().size(); ++t) {
    const Leaf& leaf = refined.leaves()[t];
    const scene::Mesh& from = refined.scene().meshes[leaf.instance];
    scene::Mesh& to = out.scene.meshes[leaf.instance];
    std::array<uint32_t, 3> triangle{};
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t vertex = leaf.vertex[k], knot = fit.knots.of_leaf[t][k];
      std::string key(reinterpret_cast<const char*>(&knot), sizeof knot);
      const auto note = [&](const auto& values) {
        if (!values.empty())
          key.append(reinterpret_cast<const char*>(&values[vertex]), sizeof values[vertex]);
      };
      note(from.positions);
      note(from.colors);
      note(from.normals);
      note(from.tangents);
      for (size_t set = 0; set < from.uvs.size(); ++set)
        if (set != 1) note(from.uvs[set]);
      const auto [found, is_new] = number[leaf.instance].try_emplace(
          std::move(key), static_cast<uint32_t>(to.positions.size()));
      triangle[k] = found->second;
      if (!is_new) continue;
      const auto take = [&](const auto& values, auto* into) {
        if (!values.empty()) into->push_back(values[vertex]);
      };
      take(from.positions, &to.positions);
      take(from.colors, &to.colors);
      take(from.normals, &to.normals);
      take(from.tangents, &to.tangents);
      for (size_t set = 0; set < from.uvs.size(); ++set)
        if (set != 1) take(from.uvs[set], &to.uvs[set]);
      out.irradiance[leaf.instance].push_back(fit.light[knot]);
    }
    to.triangles.push_back(triangle);
  }
  return out;
}

/// Vertices are told apart by what materials show alone.
scene::Scene without_unused_uvs(scene::Scene scene) {
  for (scene::Mesh& mesh : scene.meshes) {
    const scene::Material& material = scene.materials[static_cast<size_t>(mesh.material)];
    const auto used = [&](size_t set) {
      for (const scene::TextureRef* ref :
           {&material.base_color_texture, &material.emission_texture})
        if (ref->texture != scene::kNone && ref->uv_set == static_cast<int>(set)) return true;
      return false;
    };
    for (size_t set = 0; set < mesh.uvs.size(); ++set)
      if (set != 1 && !used(set)) mesh.uvs[set].clear();
    mesh.normals.clear();
    mesh.tangents.clear();
  }
  return scene;
}

}  // namespace

VertexLight vertex_light(const Lightmap& map, const VertexOptions& options) {
  const Picture picture(map);
  RefinedScene refined(without_unused_uvs(map.scene));
  const auto before = static_cast<int64_t>(refined.leaves().size());
  bool limited = false;
  Fit found = fit(picture, refined);
  while (!limited) {
    std::vector<uint32_t> bent = bent_leaves(picture, refined, found, options.bend);
    if (bent.empty()) break;
    limited = !halve_some(std::move(bent), options.max_triangles, &refined);
    found = fit(picture, refined);
  }
  VertexLight out = as_meshes(refined, found);
  out.triangles_before = before;
  out.triangles = static_cast<int64_t>(refined.leaves().size());
  out.off_p95 = off_at(picture, refined, found, 0.95);
  out.limited = limited;
  return out;
}

}  // namespace lte::bake
