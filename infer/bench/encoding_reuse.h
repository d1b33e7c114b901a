// What an encoding has in common with that of the scene before an edit.
#pragma once

#include "infer/bench/bench.h"
#include "infer/session/session.h"

namespace lte::infer {

/// Compares points, their light and the encoder's latents of two states that have all light in one
/// layer each: what an encoder of nothing but changed parts could keep.
/// @throws lte::Error unless both are Accuracy::Full and the network answers in both
BenchResult compare_encodings(const SessionState& before, const SessionState& now);

}  // namespace lte::infer
