// The light that a network is not told of: that which does not reach what it is asked about.
#pragma once

#include <vector>

#include "infer/light/unreached_light.h"
#include "infer/renderer/render_settings.h"
#include "lte/pathtrace/bvh.h"
#include "lte/runtime/network.h"

namespace lte::infer {

/// What EmbedSettings::unreached should be for an embedding of these settings that nothing but
/// `asked` will be asked of: nothing where points are not pruned.
std::vector<int> left_out_light(const pathtrace::Bvh& bvh, const runtime::Network& network,
                                const EmbedSettings& settings, const Asked& asked);

}  // namespace lte::infer
