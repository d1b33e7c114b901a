#include "lte/bake/seams.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "lte/bake/least_squares.h"
#include "lte/base/parallel_each.h"

namespace lte::bake {
namespace {

/// Cosine between normals beyond which light has no reason to be the same on both sides.
constexpr float kSmoothEdge = 0.9f;
/// Weights of least squares: of a seam, of a lit texel's own value, of a filled one's.
constexpr double kSeam = 20000, kOwn = 1, kFilledOwn = 0.01;
constexpr int kRounds = 3;
/// Solutions, each with the strengths that the light of the one before says.
constexpr int kReweighings = 6;
/// Of the mean light along seams: differences of darker places count relative to that.
constexpr double kUnseen = 0.01;

using Corner = std::tuple<float, float, float>;
Corner key(const Vec3& p) { return {p.x, p.y, p.z}; }

struct Side {
  Vec2 a, b;  ///< uv at the ends
  Vec3 normal;
};

/// A triangle's edge, by its ends in the world.
struct Edge {
  std::pair<Corner, Corner> ends;
  Side side;
};

/// Edges of all triangles that are in the atlas, equal ones side by side.
std::vector<Edge> edges_of(const scene::Mesh& mesh, const std::vector<int32_t>& chart) {
  std::vector<Edge> out;
  out.reserve(3 * mesh.triangles.size());
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (chart[t] == scene::kNone) continue;
    const auto& corner = mesh.triangles[t];
    const Vec3 normal = normalize(cross(mesh.positions[corner[1]] - mesh.positions[corner[0]],
                                        mesh.positions[corner[2]] - mesh.positions[corner[0]]));
    for (size_t k = 0; k < 3; ++k) {
      uint32_t a = corner[k], b = corner[(k + 1) % 3];
      if (key(mesh.positions[b]) < key(mesh.positions[a])) std::swap(a, b);
      out.push_back({{key(mesh.positions[a]), key(mesh.positions[b])},
                     {mesh.uvs[1][a], mesh.uvs[1][b], normal}});
    }
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const Edge& a, const Edge& b) { return a.ends < b.ends; });
  return out;
}

struct Pixels {
  int width, height;
  const std::vector<uint8_t>& mask;

  /// Adds a bilinear look-up. @return whether all of its pixels have light
  bool add(const Vec2& uv, float sign, size_t at, SeamPlace* out) const {
    const float x = uv.x * static_cast<float>(width) - 0.5f;
    const float y = uv.y * static_cast<float>(height) - 0.5f;
    const float fx = x - std::floor(x), fy = y - std::floor(y);
    for (int k = 0; k < 4; ++k) {
      const int px = std::clamp(static_cast<int>(std::floor(x)) + (k & 1), 0, width - 1);
      const int py = std::clamp(static_cast<int>(std::floor(y)) + (k >> 1), 0, height - 1);
      const uint32_t pixel =
          static_cast<uint32_t>(py) * static_cast<uint32_t>(width) + static_cast<uint32_t>(px);
      const auto texel = static_cast<Texel>(mask[pixel]);
      if (texel != Texel::Lit && texel != Texel::Filled) return false;
      out->pixel[at + static_cast<size_t>(k)] = pixel;
      out->weight[at + static_cast<size_t>(k)] =
          sign * ((k & 1) != 0 ? fx : 1 - fx) * ((k >> 1) != 0 ? fy : 1 - fy);
    }
    return true;
  }
};

void add_seam(const Pixels& pixels, const Side& one, const Side& other,
              std::vector<SeamPlace>* out) {
  if (dot(one.normal, other.normal) < kSmoothEdge) return;
  const bool same =
      one.a.x == other.a.x && one.a.y == other.a.y && one.b.x == other.b.x && one.b.y == other.b.y;
  if (same) return;
  const auto long_in = [&](const Side& s) {
    return std::hypot((s.b.x - s.a.x) * static_cast<float>(pixels.width),
                      (s.b.y - s.a.y) * static_cast<float>(pixels.height));
  };
  const int count =
      std::max(2, static_cast<int>(std::ceil(2 * std::max(long_in(one), long_in(other)))));
  for (int k = 0; k <= count; ++k) {
    const float t = static_cast<float>(k) / static_cast<float>(count);
    const auto at = [&](const Side& s) {
      return Vec2{s.a.x + t * (s.b.x - s.a.x), s.a.y + t * (s.b.y - s.a.y)};
    };
    SeamPlace place;
    if (pixels.add(at(one), 1, 0, &place) && pixels.add(at(other), -1, 4, &place))
      out->push_back(place);
  }
}

/// The normal equations of least squares over the pixels that seams read.
struct System {
  const std::vector<SeamPlace>& seams;
  std::vector<uint32_t> pixel = {};                  ///< unknowns
  std::vector<std::array<uint32_t, 8>> column = {};  ///< of a seam's weights
  std::vector<double> strength = {};                 ///< of a seam
  std::vector<double> own = {}, diagonal = {};       ///< of an unknown

  std::vector<double> times(const std::vector<double>& x) const {
    std::vector<double> out(x.size());
    for (size_t i = 0; i < x.size(); ++i) out[i] = own[i] * x[i];
    for (size_t s = 0; s < seams.size(); ++s) {
      double difference = 0;
      for (size_t k = 0; k < 8; ++k) difference += double{seams[s].weight[k]} * x[column[s][k]];
      for (size_t k = 0; k < 8; ++k)
        out[column[s][k]] += strength[s] * double{seams[s].weight[k]} * difference;
    }
    return out;
  }
};

/// Solves without values below 0: those become 0, and the others are solved for again.
void solve_nonnegative(const System& system, const std::vector<double>& right,
                       std::vector<double>* x) {
  std::vector<uint8_t> fixed(x->size());
  for (int round = 0; round < kRounds; ++round) {
    solve(system, right, fixed, x);
    bool changed = false;
    for (size_t i = 0; i < x->size(); ++i) {
      if (!((*x)[i] < 0)) continue;
      (*x)[i] = 0;
      fixed[i] = 1;
      changed = true;
    }
    if (!changed) return;
  }
}

float level_of(const std::vector<float>& irradiance, uint32_t pixel) {
  const float* at = &irradiance[3 * size_t{pixel}];
  return luminance({at[0], at[1], at[2]});
}

/// The light at each seam place, and the mean of all.
std::vector<double> levels_of(const std::vector<SeamPlace>& seams,
                              const std::vector<float>& irradiance, double* mean) {
  std::vector<double> out;
  *mean = 0;
  for (const SeamPlace& place : seams) {
    double light = 0;
    for (size_t k = 0; k < 8; ++k)
      light += double{std::abs(place.weight[k])} * level_of(irradiance, place.pixel[k]) / 2;
    out.push_back(light);
    *mean += light / static_cast<double>(seams.size());
  }
  return out;
}

}  // namespace

std::vector<SeamPlace> find_seams(const Atlas& atlas, const std::vector<uint8_t>& mask) {
  const Pixels pixels{atlas.width, atlas.height, mask};
  std::vector<std::vector<SeamPlace>> of_mesh(atlas.scene.meshes.size());
  parallel_each(of_mesh.size(), 1, [&](size_t i) {
    const std::vector<Edge> edges = edges_of(atlas.scene.meshes[i], atlas.chart[i]);
    for (size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
      while (end < edges.size() && edges[end].ends == edges[begin].ends) ++end;
      if (end - begin == 2) add_seam(pixels, edges[begin].side, edges[begin + 1].side, &of_mesh[i]);
    }
  });
  std::vector<SeamPlace> out;
  for (const std::vector<SeamPlace>& one : of_mesh) out.insert(out.end(), one.begin(), one.end());
  return out;
}

void join_seams(const std::vector<SeamPlace>& seams, const std::vector<uint8_t>& mask,
                std::vector<float>* irradiance) {
  if (seams.empty()) return;
  System system{seams};
  std::vector<uint32_t> number(mask.size(), ~0u);
  double mean = 0;
  std::vector<double> level = levels_of(seams, *irradiance, &mean);
  // Differences count relative to the light there, as they are seen.
  const auto share = [&](double light, double weight) {
    return weight / std::pow(std::max(light, kUnseen * mean) + 1e-30, 2);
  };
  for (const SeamPlace& place : seams) {
    std::array<uint32_t, 8>& column = system.column.emplace_back();
    for (size_t k = 0; k < 8; ++k) {
      uint32_t& at = number[place.pixel[k]];
      if (at == ~0u) {
        at = static_cast<uint32_t>(system.pixel.size());
        system.pixel.push_back(place.pixel[k]);
        const bool lit = static_cast<Texel>(mask[place.pixel[k]]) == Texel::Lit;
        system.own.push_back(
            share(double{level_of(*irradiance, place.pixel[k])}, lit ? kOwn : kFilledOwn));
      }
      column[k] = at;
    }
  }
  std::array<std::vector<double>, 3> x, right;
  for (size_t c = 0; c < 3; ++c) {
    for (size_t i = 0; i < system.pixel.size(); ++i) {
      x[c].push_back(double{(*irradiance)[3 * system.pixel[i] + c]});
      right[c].push_back(system.own[i] * x[c][i]);
    }
  }
  for (int round = 0; round < kReweighings; ++round) {
    system.diagonal = system.own;
    system.strength.clear();
    for (size_t s = 0; s < seams.size(); ++s) {
      system.strength.push_back(share(level[s], kSeam));
      for (size_t k = 0; k < 8; ++k)
        system.diagonal[system.column[s][k]] +=
            system.strength[s] * std::pow(double{seams[s].weight[k]}, 2);
    }
    parallel_each(3, 1, [&](size_t c) {
      solve_nonnegative(system, right[c], &x[c]);
      for (size_t i = 0; i < x[c].size(); ++i)
        (*irradiance)[3 * system.pixel[i] + c] = static_cast<float>(x[c][i]);
    });
    if (round + 1 == kReweighings) return;
    // A bright side that has come down to a dark one is as dark there.
    double unused = 0;
    const std::vector<double> now = levels_of(seams, *irradiance, &unused);
    for (size_t s = 0; s < seams.size(); ++s) level[s] = std::min(level[s], now[s]);
  }
}

double seam_difference(const std::vector<SeamPlace>& seams, const std::vector<float>& irradiance,
                       double share) {
  double mean = 0;
  const std::vector<double> level = levels_of(seams, irradiance, &mean);
  std::vector<double> out;
  for (const SeamPlace& place : seams) {
    double difference = 0;
    for (size_t k = 0; k < 8; ++k)
      difference += double{place.weight[k]} * level_of(irradiance, place.pixel[k]);
    out.push_back(std::abs(difference));
  }
  if (!(mean > 0)) return 0;
  for (size_t i = 0; i < out.size(); ++i) out[i] /= std::max(level[i], kUnseen * mean);
  const auto at = static_cast<size_t>(share * static_cast<double>(out.size() - 1));
  std::nth_element(out.begin(), out.begin() + static_cast<int64_t>(at), out.end());
  return out[at];
}

}  // namespace lte::bake
