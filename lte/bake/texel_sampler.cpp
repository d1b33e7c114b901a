#include "lte/bake/texel_sampler.h"

#include <algorithm>
#include <cmath>

#include "lte/bake/rates.h"
#include "lte/base/parallel.h"
#include "lte/base/random.h"
#include "lte/pathtrace/blocks/tile_sequence.h"

namespace lte::bake {
namespace {

constexpr uint64_t kPlaces = 81;
/// Of so many blocks a thread, none waits long for the last ones.
constexpr size_t kBlocksAThread = 8;

}  // namespace

TexelSamples::TexelSamples(size_t texels, bool with_direct) {
  for (size_t h = 0; h < 2; ++h) {
    indirect[h].resize(texels);
    if (with_direct) direct[h].resize(texels);
  }
}

Halves TexelSamples::means(const std::array<std::vector<Rgb>, 2>& sums,
                           std::span<const uint8_t> rate) const {
  Halves out = sums;
  for (size_t h = 0; h < 2; ++h) {
    for (size_t i = 0; i < out[h].size(); ++i)
      out[h][i] *= 1.0f / static_cast<float>(std::max(1, passes_of(rate[i], passes[h])));
  }
  return out;
}

Rgb TexelSamples::sum(size_t texel) const {
  Rgb out = indirect[0][texel] + indirect[1][texel];
  if (!direct[0].empty()) out += direct[0][texel] + direct[1][texel];
  return out;
}

render::PointSampling TexelSampler::sampling(uint64_t stream) const {
  render::PointSampling out;
  out.rays = 1;
  out.light_samples = options_.direct ? 1 : 0;
  out.near_hits = options_.max_depth;
  out.together = options_.rays;
  out.seed = stream;
  return out;
}

/// Places of a texel over the passes: the golden ratio's sequence, from a start of its own.
std::array<float, 3> TexelSampler::place_numbers(uint32_t texel, int number) const {
  Rng rng(hash_combine(options_.seed, kPlaces), texels_.pixel[texel]);
  constexpr std::array<double, 3> kSteps = {0.8191725134, 0.6710436067, 0.5497004779};
  std::array<float, 3> out;
  for (size_t k = 0; k < 3; ++k) {
    const double at = double{rng.uniform()} + kSteps[k] * number;
    out[k] = std::min(static_cast<float>(at - std::floor(at)), 1 - 0x1p-24f);
  }
  return out;
}

/// Texels of a tile of the atlas share a point set, which goes on from pass to pass: smoothing
/// takes the mean of many of them, whose noise falls faster than with a set a pass.
pathtrace::SampleNumber TexelSampler::sample_number(uint32_t texel, uint64_t stream,
                                                    uint32_t number) const {
  const auto width = static_cast<uint32_t>(atlas_.width);
  return pathtrace::sample_number(stream, texels_.pixel[texel] % width,
                                  texels_.pixel[texel] / width, number);
}

void TexelSampler::pass(const render::Integrator& integrator, std::span<const uint32_t> which,
                        std::span<const uint8_t> back, const render::PointSampling& sampling,
                        int number, TexelSamples* samples, std::span<const uint8_t> rate,
                        Shard shard) const {
  const auto half = static_cast<size_t>(number) % 2;
  render::PointSampling all = sampling;
  const uint64_t seed = hash_combine(options_.seed, sampling.seed);
  all.seed = hash_combine(seed, static_cast<uint64_t>(number));
  const uint64_t stream = hash_combine(seed, half);
  const auto passes_before = [&](uint32_t texel) {
    return rate.empty() ? number / 2 : passes_of(rate[texel], number / 2);
  };
  const auto sample_block = [&](size_t begin) {
    if (!shard.has(begin)) return;
    render::PointSampling one = all;
    std::vector<uint32_t> block;
    for (const uint32_t i : which.subspan(begin, std::min(kShardBlock, which.size() - begin))) {
      if (rate.empty() || passes_of(rate[i], number / 2 + 1) > passes_before(i)) block.push_back(i);
    }
    if (block.empty()) return;
    // Each ray has a place of its own in its texel.
    const auto rays = static_cast<size_t>(options_.rays);
    std::vector<Vec3> position(block.size() * rays), normal(block.size() * rays);
    std::vector<pathtrace::SampleNumber> numbers(block.size() * rays);
    parallel_for(static_cast<int64_t>(block.size()), 512, [&](int64_t first, int64_t end) {
      for (auto i = static_cast<size_t>(first); i < static_cast<size_t>(end); ++i) {
        const auto chart = static_cast<size_t>(texels_.chart[block[i]]);
        const auto drawn = rays * static_cast<size_t>(passes_before(block[i]));
        for (size_t k = 0; k < rays; ++k) {
          const TexelPlace place =
              place_in(atlas_, texels_, block[i],
                       place_numbers(block[i], number * options_.rays + static_cast<int>(k)));
          position[i * rays + k] = place.position;
          numbers[i * rays + k] = sample_number(block[i], stream, static_cast<uint32_t>(drawn + k));
          normal[i * rays + k] = back[chart] != 0 ? -place.normal : place.normal;
        }
      }
    });
    one.first_index = static_cast<int64_t>(begin * rays);
    one.ray_numbers = one.light_numbers = numbers;
    const render::PointIrradiance found = integrator.irradiance({position, normal}, one);
    const auto add = [&](const std::vector<Rgb>& from, std::vector<Rgb>* to) {
      for (size_t i = 0; i < block.size() && !from.empty(); ++i) {
        Rgb sum;
        for (size_t k = 0; k < rays; ++k) sum += from[i * rays + k];
        (*to)[block[i]] += sum / static_cast<float>(rays);
      }
    };
    add(found.indirect, &samples->indirect[half]);
    add(found.direct, &samples->direct[half]);
  };
  // Threads take whole blocks where there are enough: many have few texels in a late pass.
  const size_t blocks = (which.size() + kShardBlock - 1) / kShardBlock;
  if (blocks >= kBlocksAThread * static_cast<size_t>(num_threads())) {
    parallel_for(static_cast<int64_t>(blocks), 1, [&](int64_t begin, int64_t) {
      sample_block(static_cast<size_t>(begin) * kShardBlock);
    });
  } else {
    for (size_t k = 0; k < blocks; ++k) sample_block(k * kShardBlock);
  }
  ++samples->passes[half];
}

}  // namespace lte::bake
