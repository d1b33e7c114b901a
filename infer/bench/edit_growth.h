// Whether an hour of edits leaves anything behind.
#pragma once

#include "infer/bench/bench.h"
#include "infer/renderer/renderer.h"
#include "infer/session/session.h"

namespace lte::infer {

/// Resident memory that may come in the last nine tenths of the edits, and what all may take.
inline constexpr double kMostGrowthMb = 64, kMostResidentMb = 1536;

/// Makes edits of every kind at random, as lte_view makes them: with the light of before, after
/// some with that of a draft, and now and then with all of it and a picture.
/// @throws lte::Error if memory has grown beyond these bounds
BenchResult measure_growth(Session* session, const scene::Camera& camera,
                           const RenderSettings& settings, int edits);

}  // namespace lte::infer
