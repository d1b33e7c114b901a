// Learning rate and averaging rate as functions of the step alone, so that a resumed run needs no
// state for them.
#pragma once

#include <cstdint>

#include "train/config.h"

namespace lte::train {

/// Rises linearly over `warmup_steps` to `learning_rate`, stays there until the last `decay_share`
/// of all steps, and falls along half a cosine to `min_learning_rate`, which the last step uses.
/// With a decay_share of 1 the fall begins after the warm-up.
/// @param step  steps done before this one, 0 to config.steps − 1; later ones have the floor
double learning_rate(const OptimConfig& config, int64_t step);

/// Decay of the averaged weights at `step`: min(ema_decay, (1 + step) / (10 + step)), so that the
/// average forgets its random start.
double ema_decay(const OptimConfig& config, int64_t step);

}  // namespace lte::train
