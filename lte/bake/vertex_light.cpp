#include "lte/bake/vertex_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>
#include <unordered_map>
#include <utility>

#include "lte/bake/least_squares.h"
#include "lte/bake/refined_scene.h"
#include "lte/base/parallel.h"

namespace lte::bake {
namespace {

/// Cosine between normals beyond which triangles share the light of their edge.
constexpr float kSmoothEdge = 0.9f;
/// Of the mean light: what is darker is compared with that.
constexpr double kDarkest = 0.1;
/// Samples along a triangle at most, and along a part of it whose mean is looked at.
constexpr int kMostSamples = 128, kPartSamples = 4;
/// Longest edge in texels below which a triangle is not halved.
constexpr float kLeastEdge = 3;
/// Of a triangle's weight: how much its corners are drawn together, which decides where there are
/// fewer samples than vertices.
constexpr double kTogether = 0.002;
/// Texels that a triangle without any counts for.
constexpr double kLeastArea = 1e-4;
constexpr int64_t kGrain = 256;

/// What a light map shows at a place, as engines look it up.
class Picture {
 public:
  explicit Picture(const Lightmap& map) : width_(map.width), height_(map.height) {
    const std::vector<float> total = map.total();
    for (size_t i = 0; i < map.pixels(); ++i)
      pixels_.push_back({total[3 * i], total[3 * i + 1], total[3 * i + 2]});
    double sum = 0, lit = 0;
    for (size_t i = 0; i < map.pixels(); ++i) {
      if (map.mask[i] != static_cast<uint8_t>(Texel::Lit)) continue;
      sum += double{luminance(pixels_[i])};
      ++lit;
    }
    darkest_ = lit > 0 && sum > 0 ? kDarkest * sum / lit : 1;
  }

  Vec2 in_pixels(const Vec2& uv) const {
    return {uv.x * static_cast<float>(width_), uv.y * static_cast<float>(height_)};
  }
  Rgb at(const Vec2& place) const {
    const float x = place.x - 0.5f, y = place.y - 0.5f;
    const float fx = x - std::floor(x), fy = y - std::floor(y);
    const int px = static_cast<int>(std::floor(x)), py = static_cast<int>(std::floor(y));
    return (pixel(px, py) * (1 - fx) + pixel(px + 1, py) * fx) * (1 - fy) +
           (pixel(px, py + 1) * (1 - fx) + pixel(px + 1, py + 1) * fx) * fy;
  }
  /// W/m², luminance; darker places count as this.
  double darkest() const { return darkest_; }

 private:
  const Rgb& pixel(int x, int y) const {
    return pixels_[static_cast<size_t>(std::clamp(y, 0, height_ - 1)) *
                       static_cast<size_t>(width_) +
                   static_cast<size_t>(std::clamp(x, 0, width_ - 1))];
  }

  int width_, height_;
  std::vector<Rgb> pixels_;
  double darkest_ = 1;
};

/// Even samples of a leaf: the middles of n² equal parts.
struct LeafSamples {
  std::array<Vec2, 3> corner;  ///< in pixels
  int along = 1;
  double area = 0;  ///< texels

  LeafSamples(const Picture& picture, const scene::Mesh& mesh, const Leaf& leaf) {
    for (size_t k = 0; k < 3; ++k) corner[k] = picture.in_pixels(mesh.uvs[1][leaf.vertex[k]]);
    const Vec2 &a = corner[0], &b = corner[1], &c = corner[2];
    area = 0.5 *
           std::abs(double{b.x - a.x} * double{c.y - a.y} - double{b.y - a.y} * double{c.x - a.x});
    along = std::clamp(static_cast<int>(std::ceil(std::sqrt(2 * area))), 1, kMostSamples);
  }
  float longest_edge() const {
    float out = 0;
    for (size_t k = 0; k < 3; ++k) {
      const Vec2 &a = corner[k], &b = corner[(k + 1) % 3];
      out = std::max(out, std::hypot(b.x - a.x, b.y - a.y));
    }
    return out;
  }
  double weight() const { return area / (static_cast<double>(along) * along); }

  /// Calls use(λ, light).
  template <typename Use>
  void for_each(const Picture& picture, const Use& use) const {
    const auto n = static_cast<float>(along);
    const auto sample = [&](float u, float v) {
      const std::array<float, 3> share{1 - (u + v) / n, u / n, v / n};
      Vec2 place;
      for (size_t k = 0; k < 3; ++k) {
        place.x += share[k] * corner[k].x;
        place.y += share[k] * corner[k].y;
      }
      use(share, picture.at(place));
    };
    for (int i = 0; i < along; ++i) {
      for (int j = 0; i + j < along; ++j) {
        const auto u = static_cast<float>(i), v = static_cast<float>(j);
        sample(u + 1.0f / 3, v + 1.0f / 3);
        if (i + j + 1 < along) sample(u + 2.0f / 3, v + 2.0f / 3);
      }
    }
  }
};

/// What the samples of a leaf give to least squares.
struct Moments {
  std::array<std::array<double, 3>, 3> mass{};
  std::array<std::array<double, 3>, 3> right{};  ///< [channel][corner]
  Rgb low{INFINITY, INFINITY, INFINITY}, high{};
  double mean = 0;  ///< luminance
};

Moments moments_of(const Picture& picture, const LeafSamples& samples) {
  Moments out;
  if (!(samples.area > 0)) return out;
  double count = 0;
  samples.for_each(picture, [&](const std::array<float, 3>& share, const Rgb& light) {
    for (size_t i = 0; i < 3; ++i) {
      for (size_t j = 0; j < 3; ++j) out.mass[i][j] += double{share[i]} * double{share[j]};
      for (size_t c = 0; c < 3; ++c)
        out.right[c][i] += double{share[i]} * double{light[static_cast<int>(c)]};
    }
    out.low = min(out.low, light);
    out.high = max(out.high, light);
    out.mean += double{luminance(light)};
    ++count;
  });
  out.mean /= count;
  // Differences count relative to the light there, as they are seen.
  const double weight = samples.weight() / std::pow(out.mean + picture.darkest(), 2);
  for (size_t i = 0; i < 3; ++i) {
    for (size_t j = 0; j < 3; ++j) {
      out.mass[i][j] *= weight;
      out.right[i][j] *= weight;
    }
  }
  return out;
}

/// The unknowns: corners of leaves that share a place and a smooth surface have one.
struct Knots {
  std::vector<std::array<uint32_t, 3>> of_leaf;
  uint32_t count = 0;
};

uint32_t root(std::vector<uint32_t>* parent, uint32_t i) {
  while ((*parent)[i] != i) i = (*parent)[i] = (*parent)[(*parent)[i]];
  return i;
}

Knots find_knots(const std::vector<Leaf>& leaves) {
  struct Side {
    uint64_t key;
    uint32_t low, high;  ///< corners at the end of the smaller and the larger point
  };
  std::vector<Side> sides;
  for (uint32_t i = 0; i < leaves.size(); ++i) {
    for (uint32_t k = 0; k < 3; ++k) {
      uint32_t a = 3 * i + k, b = 3 * i + (k + 1) % 3;
      uint32_t pa = leaves[i].point[k], pb = leaves[i].point[(k + 1) % 3];
      if (pa > pb) {
        std::swap(a, b);
        std::swap(pa, pb);
      }
      sides.push_back({(uint64_t{pa} << 32) | pb, a, b});
    }
  }
  std::stable_sort(sides.begin(), sides.end(),
                   [](const Side& a, const Side& b) { return a.key < b.key; });
  std::vector<uint32_t> parent(3 * leaves.size());
  std::iota(parent.begin(), parent.end(), 0u);
  for (size_t i = 0; i < sides.size(); ++i) {
    for (size_t j = i + 1; j < sides.size() && sides[j].key == sides[i].key; ++j) {
      if (dot(leaves[sides[i].low / 3].normal, leaves[sides[j].low / 3].normal) < kSmoothEdge)
        continue;
      parent[root(&parent, sides[j].low)] = root(&parent, sides[i].low);
      parent[root(&parent, sides[j].high)] = root(&parent, sides[i].high);
    }
  }
  Knots out;
  std::vector<uint32_t> number(parent.size(), ~0u);
  for (uint32_t i = 0; i < leaves.size(); ++i) {
    std::array<uint32_t, 3>& knot = out.of_leaf.emplace_back();
    for (uint32_t k = 0; k < 3; ++k) {
      uint32_t& at = number[root(&parent, 3 * i + k)];
      if (at == ~0u) at = out.count++;
      knot[k] = at;
    }
  }
  return out;
}

struct System {
  const Knots& knots;
  std::vector<Moments> leaf;
  std::vector<double> diagonal;

  std::vector<double> times(const std::vector<double>& x) const {
    std::vector<double> out(x.size());
    for (size_t t = 0; t < leaf.size(); ++t) {
      const std::array<uint32_t, 3>& knot = knots.of_leaf[t];
      for (size_t i = 0; i < 3; ++i)
        for (size_t j = 0; j < 3; ++j) out[knot[i]] += leaf[t].mass[i][j] * x[knot[j]];
    }
    return out;
  }
};

/// Light at knots, and how far it is off between them.
struct Fit {
  Knots knots;
  std::vector<Rgb> light;
  std::vector<double> level;  ///< [leaves] what errors there are relative to
};

Fit fit(const Picture& picture, const RefinedScene& refined) {
  const std::vector<Leaf>& leaves = refined.leaves();
  Fit out{find_knots(leaves), {}, std::vector<double>(leaves.size())};
  System system{out.knots, std::vector<Moments>(leaves.size()), {}};
  parallel_for(static_cast<int64_t>(leaves.size()), kGrain, [&](int64_t begin, int64_t end) {
    for (auto t = static_cast<size_t>(begin); t < static_cast<size_t>(end); ++t) {
      const LeafSamples samples(picture, refined.scene().meshes[leaves[t].instance], leaves[t]);
      system.leaf[t] = moments_of(picture, samples);
      out.level[t] = std::max(system.leaf[t].mean, picture.darkest());
      const double together = kTogether * std::max(samples.area, kLeastArea) /
                              std::pow(system.leaf[t].mean + picture.darkest(), 2);
      for (size_t i = 0; i < 3; ++i)
        for (size_t j = 0; j < 3; ++j)
          system.leaf[t].mass[i][j] += i == j ? 2 * together : -together;
    }
  });
  const size_t count = out.knots.count;
  system.diagonal.assign(count, 0);
  std::array<std::vector<double>, 3> right, x;
  std::vector<Rgb> low(count, Rgb{INFINITY, INFINITY, INFINITY}), high(count);
  for (size_t c = 0; c < 3; ++c) right[c].assign(count, 0);
  for (size_t t = 0; t < leaves.size(); ++t) {
    for (size_t i = 0; i < 3; ++i) {
      const uint32_t knot = out.knots.of_leaf[t][i];
      system.diagonal[knot] += system.leaf[t].mass[i][i];
      for (size_t c = 0; c < 3; ++c) right[c][knot] += system.leaf[t].right[c][i];
      low[knot] = min(low[knot], system.leaf[t].low);
      high[knot] = max(high[knot], system.leaf[t].high);
    }
  }
  const std::vector<uint8_t> none(count);
  for (size_t c = 0; c < 3; ++c) {
    x[c].assign(count, 0);
    for (size_t i = 0; i < count; ++i) x[c][i] = right[c][i] / system.diagonal[i];
    solve(system, right[c], none, &x[c]);
  }
  for (size_t i = 0; i < count; ++i) {
    const Rgb found{static_cast<float>(x[0][i]), static_cast<float>(x[1][i]),
                    static_cast<float>(x[2][i])};
    // Beside the edge of a shadow least squares overshoots.
    const bool sampled = low[i].x <= high[i].x;
    out.light.push_back(sampled ? min(max(found, low[i]), high[i]) : max(found, Rgb{}));
  }
  return out;
}

float interpolated(const Fit& fit, size_t leaf, const std::array<float, 3>& share) {
  Rgb out;
  for (size_t k = 0; k < 3; ++k) out += fit.light[fit.knots.of_leaf[leaf][k]] * share[k];
  return luminance(out);
}

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
