#include "infer/renderer/left_out_light.h"

namespace lte::infer {

std::vector<int> left_out_light(const pathtrace::Bvh& bvh, const runtime::Network& network,
                                const EmbedSettings& settings, const Asked& asked) {
  if (!settings.prunes(network)) return {};
  return unreached_groups(bvh, asked, settings.seed);
}

}  // namespace lte::infer
