#include "lte/bake/vertex_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
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

/// What is fitted: the layers of a light map, and their sum behind them where there are several.
class Pictures {
 public:
  explicit Pictures(const Lightmap& map) {
    for (const Layer& layer : map.layers) pictures_.emplace_back(map, layer.irradiance);
    if (map.layers.size() == 1) return;
    total_ = map.total();
    pictures_.emplace_back(map, total_);
  }
  Pictures(const Pictures&) = delete;
  Pictures& operator=(const Pictures&) = delete;

  size_t count() const { return pictures_.size(); }
  const Picture& operator[](size_t i) const { return pictures_[i]; }
  LeafSamples samples(const RefinedScene& refined, size_t leaf) const {
    const Leaf& one = refined.leaves()[leaf];
    return {pictures_[0], refined.scene().meshes[one.instance], one};
  }

 private:
  std::vector<float> total_;
  std::vector<Picture> pictures_;
};

/// The pictures at the corners of leaves.
struct CornerLight {
  Knots knots;
  std::vector<Fit> of;  ///< [pictures]; of the sum the sum

  /// What errors of a picture are relative to, over a leaf.
  double level(const Pictures& pictures, size_t picture, size_t leaf) const {
    return std::max(of[picture].mean[leaf], pictures[picture].darkest());
  }
  float at(size_t picture, size_t leaf, const std::array<float, 3>& share) const {
    return interpolated(of[picture], knots.of_leaf[leaf], share);
  }
};

Fit sum_of(const std::vector<Fit>& layers) {
  Fit out = layers.front();
  for (const Fit& layer : std::span(layers).subspan(1)) {
    for (size_t i = 0; i < out.light.size(); ++i) out.light[i] += layer.light[i];
    for (size_t t = 0; t < out.mean.size(); ++t) out.mean[t] += layer.mean[t];
  }
  return out;
}

CornerLight fit_all(const Pictures& pictures, const RefinedScene& refined) {
  CornerLight out{find_knots(refined.leaves()), {}};
  const size_t layers = std::max<size_t>(1, pictures.count() - 1);
  for (size_t k = 0; k < layers; ++k) out.of.push_back(fit(pictures[k], refined, out.knots));
  if (pictures.count() > layers) out.of.push_back(sum_of(out.of));
  return out;
}

/// How far a picture is off linear interpolation over a leaf, relative: at the middles of its
/// edges, by what a vertex there would gain, and in the mean over parts of it.
double bend_of(const Pictures& pictures, size_t picture, const LeafSamples& samples,
               const CornerLight& found, size_t leaf) {
  std::array<double, 3> gain{}, square{};
  const int parts = std::max(1, samples.along / kPartSamples);
  std::vector<double> sum(2 * static_cast<size_t>(parts) * static_cast<size_t>(parts));
  std::vector<double> count(sum.size());
  samples.for_each(pictures[picture], [&](const std::array<float, 3>& share, const Rgb& light) {
    const double off = double{luminance(light) - found.at(picture, leaf, share)};
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
  return out / found.level(pictures, picture, leaf);
}

/// Leaves where a picture bends more than it may, the worst first.
std::vector<uint32_t> bent_leaves(const Pictures& pictures, const RefinedScene& refined,
                                  const CornerLight& found, double bend) {
  std::vector<double> off(refined.leaves().size());
  parallel_for(static_cast<int64_t>(off.size()), kGrain, [&](int64_t begin, int64_t end) {
    for (auto t = static_cast<size_t>(begin); t < static_cast<size_t>(end); ++t) {
      const LeafSamples samples = pictures.samples(refined, t);
      if (samples.longest_edge() < kLeastEdge) continue;
      for (size_t k = 0; k < pictures.count(); ++k)
        off[t] = std::max(off[t], bend_of(pictures, k, samples, found, t));
    }
  });
  std::vector<uint32_t> out;
  for (uint32_t t = 0; t < off.size(); ++t)
    if (off[t] > bend) out.push_back(t);
  std::stable_sort(out.begin(), out.end(), [&](uint32_t a, uint32_t b) { return off[a] > off[b]; });
  return out;
}

/// Halves the leaves, or as many of the worst as the limit leaves room for.
/// @return  whether all of them were
bool halve_some(std::vector<uint32_t> bent, size_t most, RefinedScene* refined) {
  const size_t all = bent.size();
  while (!bent.empty() && !refined->halve(bent, most)) bent.resize(bent.size() / 2);
  return bent.size() == all;
}

double off_at(const Pictures& pictures, size_t picture, const RefinedScene& refined,
              const CornerLight& found, double share) {
  std::vector<std::pair<double, double>> off;  // and its area
  double area = 0;
  for (size_t t = 0; t < refined.leaves().size(); ++t) {
    const LeafSamples samples = pictures.samples(refined, t);
    if (!(samples.area > 0)) continue;
    area += samples.area;
    const double level = found.level(pictures, picture, t);
    samples.for_each(pictures[picture], [&](const std::array<float, 3>& at, const Rgb& light) {
      off.emplace_back(std::abs(double{luminance(light) - found.at(picture, t, at)}) / level,
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

/// Adds the leaves as meshes whose vertices are told apart by what they show, and their light.
void add_meshes(const RefinedScene& refined, const CornerLight& found, VertexLight* out) {
  const size_t count = refined.scene().meshes.size();
  out->meshes.resize(count);
  for (VertexLayer& layer : out->layers) layer.irradiance.resize(count);
  std::vector<std::unordered_map<std::string, uint32_t>> number(count);
  for (size_t i = 0; i < count; ++i) {
    out->meshes[i].name = refined.scene().meshes[i].name;
    out->meshes[i].material = refined.scene().meshes[i].material;
  }
  for (size_t t = 0; t < refined.leaves().size(); ++t) {
    const Leaf& leaf = refined.leaves()[t];
    const scene::Mesh& from = refined.scene().meshes[leaf.instance];
    scene::Mesh& to = out->meshes[leaf.instance];
    std::array<uint32_t, 3> triangle{};
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t vertex = leaf.vertex[k], knot = found.knots.of_leaf[t][k];
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
      const auto [at, is_new] = number[leaf.instance].try_emplace(
          std::move(key), static_cast<uint32_t>(to.positions.size()));
      triangle[k] = at->second;
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
      for (size_t l = 0; l < out->layers.size(); ++l)
        out->layers[l].irradiance[leaf.instance].push_back(found.of[l].light[knot]);
    }
    to.triangles.push_back(triangle);
  }
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

std::vector<Rgb> VertexLight::total(size_t mesh) const {
  std::vector<Rgb> out(meshes[mesh].positions.size());
  for (const VertexLayer& layer : layers)
    for (size_t v = 0; v < out.size(); ++v) out[v] += layer.irradiance[mesh][v];
  return out;
}

VertexLight vertex_light(const Lightmap& map, const VertexOptions& options) {
  const Pictures pictures(map);
  RefinedScene refined(without_unused_uvs(map.scene));
  VertexLight out;
  out.triangles_before = static_cast<int64_t>(refined.leaves().size());
  CornerLight found = fit_all(pictures, refined);
  while (!out.limited) {
    std::vector<uint32_t> bent = bent_leaves(pictures, refined, found, options.bend);
    if (bent.empty()) break;
    out.limited =
        !halve_some(std::move(bent), static_cast<size_t>(options.max_triangles), &refined);
    found = fit_all(pictures, refined);
  }
  for (size_t l = 0; l < map.layers.size(); ++l)
    out.layers.push_back({map.layers[l].name, {}, off_at(pictures, l, refined, found, 0.95)});
  add_meshes(refined, found, &out);
  out.triangles = static_cast<int64_t>(refined.leaves().size());
  out.off_p95 = pictures.count() == 1
                    ? out.layers[0].off_p95
                    : off_at(pictures, pictures.count() - 1, refined, found, 0.95);
  return out;
}

}  // namespace lte::bake
