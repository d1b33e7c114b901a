#include "lte/bake/vertex_fit.h"

#include <numeric>
#include <utility>

#include "lte/bake/least_squares.h"
#include "lte/base/parallel.h"

namespace lte::bake {
namespace {

/// Cosine between normals beyond which triangles share the light of their edge.
constexpr float kSmoothEdge = 0.9f;
/// Of a triangle's weight: how much its corners are drawn together, which decides where there are
/// fewer samples than vertices.
constexpr double kTogether = 0.002;
/// Texels that a triangle without any counts for.
constexpr double kLeastArea = 1e-4;
constexpr int64_t kGrain = 256;

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

uint32_t root(std::vector<uint32_t>* parent, uint32_t i) {
  while ((*parent)[i] != i) i = (*parent)[i] = (*parent)[(*parent)[i]];
  return i;
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

}  // namespace

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

Fit fit(const Picture& picture, const RefinedScene& refined, const Knots& knots) {
  const std::vector<Leaf>& leaves = refined.leaves();
  Fit out{{}, std::vector<double>(leaves.size())};
  System system{knots, std::vector<Moments>(leaves.size()), {}};
  parallel_for(static_cast<int64_t>(leaves.size()), kGrain, [&](int64_t begin, int64_t end) {
    for (auto t = static_cast<size_t>(begin); t < static_cast<size_t>(end); ++t) {
      const LeafSamples samples(picture, refined.scene().meshes[leaves[t].instance], leaves[t]);
      system.leaf[t] = moments_of(picture, samples);
      out.mean[t] = system.leaf[t].mean;
      const double together = kTogether * std::max(samples.area, kLeastArea) /
                              std::pow(system.leaf[t].mean + picture.darkest(), 2);
      for (size_t i = 0; i < 3; ++i)
        for (size_t j = 0; j < 3; ++j)
          system.leaf[t].mass[i][j] += i == j ? 2 * together : -together;
    }
  });
  const size_t count = knots.count;
  system.diagonal.assign(count, 0);
  std::array<std::vector<double>, 3> right, x;
  std::vector<Rgb> low(count, Rgb{INFINITY, INFINITY, INFINITY}), high(count);
  for (size_t c = 0; c < 3; ++c) right[c].assign(count, 0);
  for (size_t t = 0; t < leaves.size(); ++t) {
    for (size_t i = 0; i < 3; ++i) {
      const uint32_t knot = knots.of_leaf[t][i];
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

float interpolated(const Fit& fit, const std::array<uint32_t, 3>& knot,
                   const std::array<float, 3>& share) {
  Rgb out;
  for (size_t k = 0; k < 3; ++k) out += fit.light[knot[k]] * share[k];
  return luminance(out);
}

}  // namespace lte::bake
