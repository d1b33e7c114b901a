// The table of light on surfaces that gathered pictures read: made once a scene, for all views.
#pragma once

#include <cstdint>

#include "infer/light/embedding_draws.h"
#include "lte/base/enum_names.h"
#include "lte/gi/radiosity_table.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights/lights.h"

namespace lte::infer {

/// Where a table's light comes from.
enum class TableLight {
  Raw,     ///< path-traced estimates: no network is needed
  Network  ///< the network's indirect light and sampled direct light
};
constexpr EnumNames<TableLight, 2> enum_names(TableLight) {
  return {{{TableLight::Raw, "raw"}, {TableLight::Network, "network"}}};
}

struct TableSettings {
  TableLight light = TableLight::Raw;
  int64_t entries = 4096;  ///< where surfaces are level (gi::sample_entries())
  int paths = 16;          ///< of each entry there; from the network: its shadow rays
  int max_depth = 5;       ///< of the picture: surface hits after the primary one
  uint64_t seed = 0;
};

/// Entries with their light, direct light apart: where that is uneven the table does not know it.
/// @param draws  embeddings of this scene; TableLight::Raw needs none
/// @throws lte::Error without an embedding that is needed
gi::RadiosityTable make_light_table(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                                    const EmbeddingDraws& draws, const TableSettings& settings);

/// What making and keeping a table takes, in MiB.
/// @param groups  light groups of the scene
double table_mb(const TableSettings& settings, int64_t groups);

}  // namespace lte::infer
