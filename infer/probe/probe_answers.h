// The answers of lte_probe: who gives them, and what error they have.
#pragma once

#include <string>
#include <vector>

#include "infer/check/light_check.h"
#include "infer/probe/probe_command.h"
#include "infer/renderer/renderer.h"
#include "lte/pathtrace/probe.h"
#include "lte/runtime/network.h"
#include "lte/scene/point_table.h"

namespace lte::infer {

/// A table in the making, and what there is to say about it.
struct ProbeAnswer {
  pathtrace::ProbeResult light;
  /// W/m², root mean square over the channels; empty where nothing is known of it.
  std::vector<double> expected_error;
  std::vector<std::string> culled_lights;  ///< by name
  LightCheck check;                        ///< without paths: none
};

/// Rays a point, as the flags or the method have them.
int64_t rays_of(const ProbeRequest& request);

/// The line that says who answers, before anything else is said.
std::string who_answers(const ProbeRequest& request);

/// @param network   for the methods that need one (ProbeRequest::needs_network())
/// @param settings  of its embedding
ProbeAnswer answer_points(const ProbeRequest& request, const runtime::Network* network,
                          const EmbedSettings& settings, const scene::PointTable& points,
                          Renderer* renderer);

/// Black: nothing shines, so there is nothing to ask about.
ProbeAnswer darkness(const scene::PointTable& points);

}  // namespace lte::infer
