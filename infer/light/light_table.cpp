#include "infer/light/light_table.h"

#include <algorithm>

#include "infer/light/network_table.h"
#include "lte/base/check.h"
#include "lte/base/random.h"

namespace lte::infer {
namespace {

// Bytes an entry: what it is made from, its light and walls, and its places in the index, which
// lists it in every cell that it speaks for.
constexpr double kEntryBytes = 2048;
// Estimates of an entry and a light group, of as many as are made at once (gi/radiosity_table.cpp).
constexpr double kEstimateBytes = 24, kMostEstimates = 1 << 21;
// Entries draw other numbers than pixels.
constexpr uint64_t kPlaces = 21, kLight = 22;

}  // namespace

gi::RadiosityTable make_light_table(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                                    const EmbeddingDraws& draws, const TableSettings& settings) {
  LTE_CHECK(settings.paths >= 1, "a table needs a path an entry, got ", settings.paths);
  const uint64_t places = hash_combine(settings.seed, kPlaces);
  if (settings.light == TableLight::Network) {
    LTE_CHECK(!draws.empty(), "a table of the network's light needs its embedding");
    return network_table(bvh, lights, draws, {settings.entries, settings.paths, places});
  }
  // A gather adds a bounce to the table's light, so light of depth 1 is all that none has.
  if (lights.empty() || settings.max_depth < 2) return {bvh, {}, {}};
  const gi::TableEntries entries = gi::sample_entries(bvh, settings.entries, places);
  const gi::EntryLight light =
      gi::estimate_entries(bvh, lights, entries, settings.paths, settings.max_depth - 1,
                           hash_combine(settings.seed, kLight));
  return {bvh, entries, light.total(), light.direct};
}

double table_mb(const TableSettings& settings, int64_t groups) {
  // As many as there are where no surface is level.
  const auto entries = static_cast<double>(settings.entries) * gi::kEntryPoints;
  const double estimates =
      std::min(entries * static_cast<double>(std::max<int64_t>(groups, 1)), kMostEstimates);
  return (entries * kEntryBytes + estimates * kEstimateBytes) / (1 << 20);
}

}  // namespace lte::infer
