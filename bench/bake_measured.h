// Internal to lte_bench bake: a scene laid out, the truth at some of its texels, and the figures of
// an answer.
#pragma once

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "infer/renderer/renderer.h"
#include "lte/bake/bake.h"
#include "lte/base/stopwatch.h"

namespace lte::bench {

/// The figures of one method.
struct BakeRow {
  std::string name;
  Seconds seconds;
  double rel_mse = 0, bias = 0, median = 0, p95 = 0, leak = 0;
  double seam = NAN;  ///< where seams are joined
};

struct MeasuredScene {
  const scene::Scene& scene;
  infer::Renderer renderer;
  bake::Layout layout;
  bake::TexelLight sides;  ///< of all texels, by a draft
  std::vector<uint8_t> mask;
  std::vector<Vec3> normals;
  std::vector<uint32_t> which;  ///< texels whose light is known
  /// Two estimates whose noise is not the same, so that neither counts as an answer's error.
  std::array<std::vector<Rgb>, 2> truth;
  Seconds layout_seconds;

  explicit MeasuredScene(const scene::Scene& of) : scene(of), renderer(of) {}
  render::TracedScene traced() const { return {renderer.bvh(), renderer.lights()}; }
  Rgb true_light(size_t k) const { return (truth[0][k] + truth[1][k]) * 0.5f; }
};

/// @param seconds  without the layout's
/// @param answer   to the texel which[k]
BakeRow measure(const MeasuredScene& m, const std::string& name, const Seconds& seconds,
                const std::function<Rgb(size_t k)>& answer);

/// The same of a picture of the atlas, [height, width, 3].
BakeRow measure_picture(const MeasuredScene& m, const std::string& name, const Seconds& seconds,
                        const std::vector<float>& light, const std::vector<uint8_t>& mask);

}  // namespace lte::bench
