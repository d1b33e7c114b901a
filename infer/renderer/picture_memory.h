// What a picture takes of memory, known before any work is done.
#pragma once

#include "infer/renderer/renderer.h"
#include "lte/runtime/memory_limit.h"

namespace lte::infer {

/// What the most of a picture takes above scene, model and embedding, in MiB: the frame, with the
/// band that is worked on or with what writing it as EXR (settings.layers) or PNG adds.
/// docs/pictures.md compares it with measurements.
double picture_mb(const RenderSettings& settings);

/// @param available_mb  available_memory_mb()
/// @throws runtime::NotEnoughMemory if the picture does not fit into the machine; lte::Error if it
///         has more pixels than a PNG is written with.
void check_picture_fits(const RenderSettings& settings, double available_mb);
/// @throws runtime::NotEnoughMemory if it does not fit into what `limit` leaves.
void check_picture_fits(const RenderSettings& settings, const runtime::MemoryLimit& limit);

}  // namespace lte::infer
