#include "lte/bake/sides.h"

#include <algorithm>
#include <utility>

#include "lte/base/random.h"
#include "lte/pathtrace/reach/reach.h"

namespace lte::bake {
namespace {

/// A chart faces the side that more than this share of its texels find light on.
constexpr double kLitShare = 0.02;
/// Texels of a chart that decide its side, and of a patch whether light reaches it.
constexpr int64_t kDeciding = 64;
/// Of the mean light: what is darker is looked at again, by paths that end where light is.
constexpr float kDim = 0.01f;
/// Rays of a patch that have found nothing, after which it is dark: as many as the search for light
/// has for a pocket (lte/pathtrace/reach/reach.h).
constexpr size_t kRaysOfDark = 256;
constexpr uint64_t kBackRays = 83, kReachPaths = 85, kTurnedRays = 86;

/// What a side of each chart has shown of light.
struct ChartLight {
  std::vector<double> light;
  std::vector<int64_t> texels, lit;

  ChartLight(const Texels& t, const TexelSamples& samples, std::span<const uint32_t> which,
             int32_t count)
      : light(static_cast<size_t>(count)),
        texels(static_cast<size_t>(count)),
        lit(static_cast<size_t>(count)) {
    for (const uint32_t i : which) {
      const auto chart = static_cast<size_t>(t.chart[i]);
      const float value = luminance(samples.sum(i));
      ++texels[chart];
      lit[chart] += value > 0 ? 1 : 0;
      light[chart] += double{value};
    }
  }
  bool reached(size_t chart) const {
    return static_cast<double>(lit[chart]) > kLitShare * static_cast<double>(texels[chart]);
  }
};

bool double_sided(const Atlas& atlas, const Texels& texels, size_t i) {
  const Fragment& f = texels.fragments[texels.first[i]];
  const scene::Mesh& mesh = atlas.scene.meshes[static_cast<size_t>(f.instance)];
  return atlas.scene.materials[static_cast<size_t>(mesh.material)].double_sided;
}

/// Texels that have found no light or hardly any, in patches: those of a kind that touch in one
/// chart.
struct DimPatch {
  bool unlit = false;  ///< none of its texels has found any
  std::vector<size_t> texels;
};

std::vector<DimPatch> dim_patches(const Atlas& atlas, const Texels& texels,
                                  const TexelSamples& samples) {
  std::vector<float> light(texels.size());
  double sum = 0;
  for (size_t i = 0; i < texels.size(); ++i) {
    light[i] = luminance(samples.sum(i));
    sum += double{light[i]};
  }
  const float dim = kDim * static_cast<float>(sum / static_cast<double>(texels.size()));
  const auto width = static_cast<uint32_t>(atlas.width);
  std::vector<int64_t> open(size_t{width} * static_cast<size_t>(atlas.height), -1);
  for (size_t i = 0; i < texels.size(); ++i)
    if (light[i] <= dim) open[texels.pixel[i]] = static_cast<int64_t>(i);
  std::vector<DimPatch> out;
  for (const uint32_t start : texels.pixel) {
    if (open[start] < 0) continue;
    const auto first = static_cast<size_t>(open[start]);
    DimPatch& patch = out.emplace_back();
    patch.unlit = !(light[first] > 0);
    std::vector<uint32_t> next{start};
    while (!next.empty()) {
      const uint32_t pixel = next.back();
      next.pop_back();
      if (pixel >= open.size() || open[pixel] < 0) continue;
      const auto i = static_cast<size_t>(open[pixel]);
      if (texels.chart[i] != texels.chart[first] || patch.unlit == (light[i] > 0)) continue;
      patch.texels.push_back(i);
      open[pixel] = -1;
      for (const uint32_t other : {pixel - 1, pixel + 1, pixel - width, pixel + width})
        next.push_back(other);
    }
  }
  return out;
}

}  // namespace

std::vector<uint32_t> deciding_texels(const Texels& texels, int32_t charts) {
  std::vector<int64_t> count(static_cast<size_t>(charts));
  for (const int32_t chart : texels.chart) ++count[static_cast<size_t>(chart)];
  std::vector<uint32_t> out;
  for (uint32_t i = 0; i < texels.size(); ++i)
    if (i % (1 + count[static_cast<size_t>(texels.chart[i])] / kDeciding) == 0) out.push_back(i);
  return out;
}

Sides choose_sides(const TexelSampler& sampler, const render::Integrator& integrator,
                   const Atlas& atlas, const Texels& texels, std::span<const uint32_t> which,
                   const TexelSamples& samples) {
  const ChartLight front(texels, samples, which, atlas.charts);
  std::vector<uint8_t> two_sided(static_cast<size_t>(atlas.charts));
  std::vector<int64_t> size(two_sided.size());
  for (size_t i = 0; i < texels.size(); ++i) {
    const auto chart = static_cast<size_t>(texels.chart[i]);
    two_sided[chart] |= double_sided(atlas, texels, i) ? 1 : 0;
    ++size[chart];
  }
  std::vector<uint32_t> asked = deciding_texels(texels, atlas.charts);
  std::erase_if(asked, [&](uint32_t i) {
    const auto chart = static_cast<size_t>(texels.chart[i]);
    return front.texels[chart] == 0 || (two_sided[chart] == 0 && front.reached(chart));
  });
  TexelSamples behind(texels.size(), !samples.direct[0].empty());
  Sides out{std::vector<uint8_t>(static_cast<size_t>(atlas.charts), 1), 0};
  for (int k = 0; k < 2; ++k)
    sampler.pass(integrator, asked, out.back, sampler.sampling(kBackRays), k, &behind);
  const ChartLight ahead(texels, samples, asked, atlas.charts);
  const ChartLight rear(texels, behind, asked, atlas.charts);
  for (size_t chart = 0; chart < out.back.size(); ++chart) {
    const bool both = front.reached(chart) && rear.reached(chart);
    if (both) out.two_sided += size[chart];
    out.back[chart] =
        rear.reached(chart) && (!both || rear.light[chart] > ahead.light[chart]) ? 1 : 0;
  }
  return out;
}

void sample_turned(const TexelSampler& sampler, const render::Integrator& integrator,
                   const Texels& texels, const std::vector<uint8_t>& back, TexelSamples* samples) {
  std::vector<uint32_t> turned;
  for (uint32_t i = 0; i < texels.size(); ++i) {
    if (back[static_cast<size_t>(texels.chart[i])] == 0) continue;
    turned.push_back(i);
    for (size_t h = 0; h < 2; ++h) {
      samples->indirect[h][i] = {};
      if (!samples->direct[h].empty()) samples->direct[h][i] = {};
    }
  }
  samples->passes = {};
  for (int k = 0; k < 2; ++k)
    sampler.pass(integrator, turned, back, sampler.sampling(kTurnedRays), k, samples);
}

void find_darkness(const pathtrace::Bvh& bvh, const Atlas& atlas, const Texels& texels,
                   const LightOptions& options, LightState* state) {
  const std::vector<Vec3> normals = turned_normals(texels, state->back);
  pathtrace::ReachOptions reach;
  reach.max_depth = options.max_depth;
  reach.seed = hash_combine(options.seed, kReachPaths);
  // Not the middle, which often lies in the very plane of a wall, where both sides see it.
  const auto reached = [&](const std::vector<size_t>& which) {
    std::vector<Vec3> position, normal;
    for (const size_t i : which) {
      Rng rng(hash_combine(reach.seed, 0), texels.pixel[i]);
      position.push_back(
          place_in(atlas, texels, i, {rng.uniform(), rng.uniform(), rng.uniform()}).position);
      normal.push_back(normals[i]);
    }
    return pathtrace::reached(bvh, position, normal, pathtrace::Sides::Front, reach);
  };
  std::vector<DimPatch> dim = dim_patches(atlas, texels, state->samples);
  for (const DimPatch& patch : dim)
    for (const size_t i : patch.texels) state->dark[i] = 1;
  const size_t rays = 2 * static_cast<size_t>(options.rays);  // of a texel in two passes
  std::erase_if(dim, [&](const DimPatch& patch) {
    return patch.unlit && patch.texels.size() * rays >= kRaysOfDark;
  });
  std::vector<size_t> first, rest;
  for (const DimPatch& patch : dim)
    for (size_t k = 0; k < patch.texels.size(); k += 1 + patch.texels.size() / size_t{kDeciding})
      first.push_back(patch.texels[k]);
  const std::vector<uint8_t> kept = reached(first);
  size_t at = 0;
  for (const DimPatch& patch : dim) {
    const size_t step = 1 + patch.texels.size() / size_t{kDeciding};
    bool any = false;
    for (size_t k = 0; k < patch.texels.size(); k += step) {
      any = any || kept[at] != 0;
      state->dark[patch.texels[k]] = kept[at++] == 0 ? 1 : 0;
    }
    for (size_t k = 0; any && k < patch.texels.size(); ++k)
      if (k % step != 0) rest.push_back(patch.texels[k]);
  }
  const std::vector<uint8_t> also = reached(rest);
  for (size_t k = 0; k < rest.size(); ++k) state->dark[rest[k]] = also[k] == 0 ? 1 : 0;
}

}  // namespace lte::bake
