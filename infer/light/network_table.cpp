#include "infer/light/network_table.h"

namespace lte::infer {

gi::RadiosityTable network_table(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                                 const EmbeddingDraws& draws, const NetworkTableOptions& options) {
  const gi::TableEntries entries = gi::sample_entries(bvh, options.entries, options.seed);
  std::vector<Rgb> total = draws.decode({entries.position, entries.normal, entries.albedo});
  const gi::EntryLight light = gi::estimate_entries(bvh, lights, entries, options.direct_rays,
                                                    /*max_depth=*/1, options.seed);
  for (size_t i = 0; i < total.size(); ++i) total[i] += light.direct[i];
  return {bvh, entries, total, light.direct};
}

}  // namespace lte::infer
