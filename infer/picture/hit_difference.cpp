#include "infer/picture/hit_difference.h"

#include <array>
#include <span>
#include <utility>

#include "lte/base/vector_clones.h"

namespace lte::infer {
namespace {

using pathtrace::GBuffer;

bool colors_differ(const Rgb& a, const Rgb& b) {
  for (int c = 0; c < 3; ++c) {
    // Roots of numbers that are nearer than the step's square are nearer than the step.
    if (std::abs(a[c] - b[c]) < 0.99f * kColorStep * kColorStep) continue;
    if (std::abs(std::sqrt(a[c]) - std::sqrt(b[c])) > kColorStep) return true;
  }
  return false;
}

/// Hits that are compared at once: what is between the loops below stays in the first-level cache.
constexpr size_t kBlock = 128;
using Flags = std::array<int32_t, kBlock>;             ///< 0 or 1 a hit
using ChannelFlags = std::array<int32_t, 3 * kBlock>;  ///< 0 or 1 a channel

// Loops without branches, over pointers, as the compiler keeps none over std::array in vectors.

LTE_VECTOR_CLONES
void differ_in_kind(const uint8_t* __restrict mask_a, const uint8_t* __restrict mask_b,
                    const int32_t* __restrict instance_a, const int32_t* __restrict instance_b,
                    size_t count, int32_t* __restrict flags) {
  for (size_t i = 0; i < count; ++i)
    flags[i] = (mask_a[i] != mask_b[i] ? 1 : 0) | (instance_a[i] != instance_b[i] ? 1 : 0);
}

/// `pa`, `pb` positions and `na`, `nb` normals.
LTE_VECTOR_CLONES
void differ_in_plane(const float* __restrict pa, const float* __restrict pb,
                     const float* __restrict na, const float* __restrict nb,
                     const float* __restrict depth_a, const float* __restrict depth_b, size_t count,
                     float pixel_size, int32_t* __restrict flags) {
  for (size_t i = 0; i < count; ++i) {
    const size_t x = 3 * i, y = x + 1, z = x + 2;
    const float cosine = na[x] * nb[x] + na[y] * nb[y] + na[z] * nb[z];
    const float dx = pb[x] - pa[x], dy = pb[y] - pa[y], dz = pb[z] - pa[z];
    const float off_a = std::fabs(dx * na[x] + dy * na[y] + dz * na[z]);
    const float off_b = std::fabs(dx * nb[x] + dy * nb[y] + dz * nb[z]);
    const float tolerance = (depth_b[i] < depth_a[i] ? depth_b[i] : depth_a[i]) * pixel_size;
    const int32_t same = (off_a <= tolerance ? 1 : 0) & (off_b <= tolerance ? 1 : 0);
    flags[i] = (cosine < kSameNormal ? 1 : 0) | (same ^ 1);
  }
}

LTE_VECTOR_CLONES
void colors_differ_in(const float* __restrict a, const float* __restrict b, size_t channels,
                      int32_t* __restrict flags) {
  for (size_t k = 0; k < channels; ++k)
    flags[k] = std::fabs(std::sqrt(a[k]) - std::sqrt(b[k])) > kColorStep ? 1 : 0;
}

LTE_VECTOR_CLONES
void emissions_differ_in(const float* __restrict a, const float* __restrict b, size_t channels,
                         int32_t* __restrict flags) {
  for (size_t k = 0; k < channels; ++k) {
    const float larger = a[k] < b[k] ? b[k] : a[k];
    flags[k] = std::fabs(a[k] - b[k]) > kEmissionStep * larger ? 1 : 0;
  }
}

LTE_VECTOR_CLONES
void metals_differ_in(const float* __restrict a, const float* __restrict b, size_t count,
                      int32_t* __restrict flags) {
  for (size_t i = 0; i < count; ++i) flags[i] |= std::fabs(a[i] - b[i]) > kMetalStep ? 1 : 0;
}

/// Adds those of a hit's channels to its own.
LTE_VECTOR_CLONES
void add_channels(const int32_t* __restrict channels, size_t count, int32_t* __restrict flags) {
  for (size_t i = 0; i < count; ++i)
    flags[i] |= channels[3 * i] | channels[3 * i + 1] | channels[3 * i + 2];
}

/// Of two hits of which neither is a surface the kind alone counts.
LTE_VECTOR_CLONES
void set_bits(const int32_t* __restrict kind, const int32_t* __restrict surface,
              const uint8_t* __restrict mask, size_t count, uint8_t bit, uint8_t* __restrict bits) {
  for (size_t i = 0; i < count; ++i) {
    const int32_t flag = kind[i] | (surface[i] & (mask[i] != 0 ? 1 : 0));
    bits[i] = static_cast<uint8_t>(bits[i] | (flag != 0 ? bit : 0));
  }
}

LTE_VECTOR_CLONES
bool any_positive(const float* __restrict values, size_t count) {
  int32_t any = 0;
  for (size_t k = 0; k < count; ++k) any |= values[k] > 0 ? 1 : 0;
  return any != 0;
}

const float* channels_of(std::span<const Vec3> values, size_t first) { return &values[first].x; }

/// Calls use(first, count) for `count` hits, block by block.
template <typename Use>
void each_block(size_t count, const Use& use) {
  for (size_t first = 0; first < count; first += kBlock)
    use(first, std::min(kBlock, count - first));
}

}  // namespace

bool hits_differ(const GBuffer& of_a, size_t a, const GBuffer& of_b, size_t b, float pixel_size) {
  if (of_a.mask[a] != of_b.mask[b] || of_a.instance[a] != of_b.instance[b]) return true;
  if (!of_a.mask[a]) return false;
  if (dot(of_a.normal[a], of_b.normal[b]) < kSameNormal) return true;
  const float tolerance = std::min(of_a.depth[a], of_b.depth[b]) * pixel_size;
  if (!same_plane(of_a.position[a], of_a.normal[a], of_b.position[b], of_b.normal[b], tolerance))
    return true;
  if (colors_differ(of_a.albedo[a], of_b.albedo[b])) return true;
  if (emissions_differ(of_a.emission[a], of_b.emission[b])) return true;
  return !of_a.metallic.empty() && std::abs(of_a.metallic[a] - of_b.metallic[b]) > kMetalStep;
}

void mark_differing_hits(const GBuffer& hits, size_t a, size_t b, size_t count, float pixel_size,
                         uint8_t bit, uint8_t* bits) {
  Flags kind, surface;
  ChannelFlags channels;
  each_block(count, [&](size_t first, size_t some) {
    const size_t i = a + first, j = b + first;
    const auto at_both = [&](std::span<const Vec3> values) {
      return std::pair(channels_of(values, i), channels_of(values, j));
    };
    differ_in_kind(&hits.mask[i], &hits.mask[j], &hits.instance[i], &hits.instance[j], some,
                   kind.data());
    const auto [pa, pb] = at_both(hits.position);
    const auto [na, nb] = at_both(hits.normal);
    differ_in_plane(pa, pb, na, nb, &hits.depth[i], &hits.depth[j], some, pixel_size,
                    surface.data());
    const auto [albedo_a, albedo_b] = at_both(hits.albedo);
    colors_differ_in(albedo_a, albedo_b, 3 * some, channels.data());
    add_channels(channels.data(), some, surface.data());
    const auto [emission_a, emission_b] = at_both(hits.emission);
    if (any_positive(emission_a, 3 * some) || any_positive(emission_b, 3 * some)) {
      emissions_differ_in(emission_a, emission_b, 3 * some, channels.data());
      add_channels(channels.data(), some, surface.data());
    }
    if (!hits.metallic.empty())
      metals_differ_in(&hits.metallic[i], &hits.metallic[j], some, surface.data());
    set_bits(kind.data(), surface.data(), &hits.mask[i], some, bit, bits + first);
  });
}

void mark_differing_emissions(const GBuffer& hits, size_t a, size_t b, size_t count, uint8_t bit,
                              uint8_t* bits) {
  const Flags none{};
  Flags flags;
  ChannelFlags channels;
  const std::array<uint8_t, kBlock> all = [] {
    std::array<uint8_t, kBlock> ones;
    ones.fill(1);
    return ones;
  }();
  each_block(count, [&](size_t first, size_t some) {
    const float *of_a = channels_of(hits.emission, a + first),
                *of_b = channels_of(hits.emission, b + first);
    if (!any_positive(of_a, 3 * some) && !any_positive(of_b, 3 * some)) return;
    emissions_differ_in(of_a, of_b, 3 * some, channels.data());
    flags = none;
    add_channels(channels.data(), some, flags.data());
    set_bits(flags.data(), none.data(), all.data(), some, bit, bits + first);
  });
}

}  // namespace lte::infer
