// Internal: how often each texel is sampled, beside the others.
#pragma once

#include <cstdint>
#include <vector>

#include "lte/bake/estimate.h"
#include "lte/bake/texel_graph.h"

namespace lte::bake {

/// Rates are fractions of this: what has it takes part in every round of passes.
inline constexpr int kFullRate = 64;

/// Passes of each half that a texel of this rate has had after so many rounds. All take part in the
/// first.
inline int passes_of(int rate, int rounds) {
  return rounds < 1 ? 0 : 1 + (rounds - 1) * rate / kFullRate;
}

/// Rates in proportion to the relative error that smoothing leaves (Neyman's allocation): noise of
/// the samples, over the light, and over the neighbours that share it. A texel of a narrow thing
/// has few.
/// @param samples  one pass a half
/// @return  [texels] 1 to kFullRate; 0 where `skipped`
std::vector<uint8_t> sampling_rates(const TexelGraph& graph, const Halves& samples,
                                    const std::vector<uint8_t>& skipped);

}  // namespace lte::bake
