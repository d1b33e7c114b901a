// What methods by lte_render's renderer share.
#pragma once

#include "infer/bench/pareto/method.h"
#include "infer/renderer/renderer.h"

namespace lte::infer {

/// Encodes the scene for the network, and adds the stages of that.
void embed_scene(const MethodScene& scene, StageTimes* stages);

/// Makes the table that gathered light reads, but for depth and seed, which are the scene's, and
/// adds its stage.
void make_table(const MethodScene& scene, const TableSettings& table, StageTimes* stages);

/// Adds the stages of the picture of gathered light that the renderer has just made.
void add_picture_stages(const MethodScene& scene, StageTimes* view);

/// A picture with these settings, but for size, depth and seed, which are the scene's.
MethodPicture render_view(const MethodScene& scene, const RenderSettings& settings,
                          const scene::Camera& camera);

}  // namespace lte::infer
