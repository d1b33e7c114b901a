// Internal: passes of samples over texels, each at places of its own in them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lte/bake/light.h"

namespace lte::bake {

/// Borrows all that it is made of.
class TexelSampler {
 public:
  TexelSampler(const Atlas& atlas, const Texels& texels, const LightOptions& options)
      : atlas_(atlas), texels_(texels), options_(options) {}

  /// Rays and light samples of a pass; `stream` tells uses of random numbers apart.
  render::PointSampling sampling(uint64_t stream) const;
  /// Pass `number` over some texels, whose numbers ascend.
  /// @param back   [charts] 1: light of the back
  /// @param rate   LightState::rate, by which some take no part; empty: all do
  /// @param shard  whose blocks of them are sampled; what they get is the same as of all
  void pass(const render::Integrator& integrator, std::span<const uint32_t> which,
            std::span<const uint8_t> back, const render::PointSampling& sampling, int number,
            TexelSamples* samples, std::span<const uint8_t> rate = {}, Shard shard = {}) const;

 private:
  std::array<float, 3> place_numbers(uint32_t texel, int number) const;
  /// What the ray of a texel draws that has drawn `number` in the same stream.
  pathtrace::SampleNumber sample_number(uint32_t texel, uint64_t stream, uint32_t number) const;

  const Atlas& atlas_;
  const Texels& texels_;
  const LightOptions& options_;
};

}  // namespace lte::bake
