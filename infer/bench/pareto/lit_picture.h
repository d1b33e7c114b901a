// Pictures from irradiance at surface points, as lte_render composes them: for methods that answer
// points by something else than the network.
#pragma once

#include <functional>
#include <vector>

#include "infer/bench/pareto/method.h"
#include "infer/light/points.h"

namespace lte::infer {

/// Indirect irradiance at the points, W/m².
using IndirectLight = std::function<std::vector<Rgb>(const QueryPoints&)>;

/// Irradiance at points, W/m².
struct DirectAndIndirect {
  std::vector<Rgb> direct, indirect;
};
using PointIrradiance = std::function<DirectAndIndirect(const QueryPoints&)>;

/// Primary hits with anti-aliased edges, `light` at every query, paths for metal. Stages: primary,
/// metal; those of `light` are its own.
MethodPicture compose_picture(const MethodScene& scene, const scene::Camera& camera,
                              const PointIrradiance& light, StageTimes* stages);

/// The same with `indirect` at every query and direct light by `direct_samples` shadow rays. Stages
/// more: indirect, direct.
MethodPicture compose_picture(const MethodScene& scene, const scene::Camera& camera,
                              int direct_samples, const IndirectLight& indirect,
                              StageTimes* stages);

/// The picture of a frame with layers, and its indirect light.
MethodPicture picture_of(const Frame& frame);

}  // namespace lte::infer
