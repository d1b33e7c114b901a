// A small network, a camera, and points of a scene: what tests of sessions compare.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "infer/renderer/renderer.h"
#include "infer/session/session.h"
#include "infer/session/state.h"
#include "lte/scene/export.h"
#include "lte/scene/load.h"
#include "lte/scene/sampler.h"
#include "tests/infer/fixture.h"

namespace lte::infer::session_test {

inline runtime::Network network(nn::LightInput input = nn::LightInput::Traced, bool pruned = false,
                                bool suns = false) {
  const test::TempDir folder;
  test::save_tiny_model(
      folder / "tiny.safetensors",
      {.scene_points = 120, .pruned = pruned, .suns = suns, .light_input = input});
  return runtime::Network(folder / "tiny.safetensors");
}

inline scene::Camera camera() { return {"", {2, 1.6f, 2.8f}, {2, 1, 0}, {0, 1, 0}, 70}; }

inline RenderSettings picture(Output output = Output::Full, Method method = Method::Gather) {
  RenderSettings out;
  out.output = output;
  out.method = method;
  out.width = 24;
  out.height = 16;
  out.passes = 1;
  out.edge_rays = 0;
  out.denoise = false;
  return out;
}

struct Points {
  explicit Points(const scene::Scene& scene) {
    scene::SamplerOptions options;
    options.seed = 7;
    samples = scene::sample_surface(scene, 200, options);
  }
  runtime::QueryPoints queries() const {
    return {samples.position, samples.normal, samples.albedo};
  }
  scene::SurfaceSamples samples;
};

/// The scene as a file would have it.
inline scene::Scene exported(const SessionState& state) {
  const test::TempDir folder;
  state.write_glb(folder / "scene.glb");
  return scene::load_scene(folder / "scene.glb");
}

inline Frame rendered(const scene::Scene& scene, const runtime::Network& network,
                      const RenderSettings& settings) {
  Renderer renderer(scene);
  if (settings.method == Method::Network) renderer.embed(network, {});
  if (renderer.needs_cache(settings)) renderer.make_cache(settings.method, {});
  return renderer.render(camera(), settings);
}

inline double largest_difference(const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
  double out = a.size() == b.size() ? 0 : INFINITY;
  for (size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    for (int c = 0; c < 3; ++c) out = std::max(out, std::fabs(double{a[i][c]} - b[i][c]));
  }
  return out;
}

/// The largest difference of two sessions' answers.
struct AnswerChange {
  double largest = 0;   ///< of a component of irradiance, W/m²
  double relative = 0;  ///< that over the mean irradiance
  double rms = 0;       ///< root mean square of the difference over that of the irradiance
};

/// The answers of now beside those of a session that begins with the scene as edited.
inline AnswerChange change_against_fresh(const Session& session,
                                         const runtime::QueryPoints& queries) {
  const StatePtr state = session.state();
  const SessionState::Parts& parts = state->parts();
  const std::vector<Rgb> here = state->irradiance(queries);
  EditReport ignored;
  const auto base = std::make_shared<const SessionBase>(parts.base->scene, parts.base->network,
                                                        parts.base->settings);
  const std::vector<Rgb> fresh =
      make_parts(base, parts.edits, nullptr, {.cameras = parts.cameras}, &ignored)->answer(queries);
  AnswerChange change;
  double sum = 0, squares = 0, squares_off = 0;
  for (size_t i = 0; i < here.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      const double off = double{here[i][c]} - fresh[i][c];
      change.largest = std::max(change.largest, std::fabs(off));
      squares_off += off * off;
      squares += double{fresh[i][c]} * fresh[i][c];
      sum += double{fresh[i][c]} / (3.0 * static_cast<double>(here.size()));
    }
  }
  change.relative = sum > 0 ? change.largest / sum : change.largest;
  change.rms = squares > 0 ? std::sqrt(squares_off / squares) : std::sqrt(squares_off);
  return change;
}

inline double mean_of(const std::vector<Rgb>& values) {
  double sum = 0;
  for (const Rgb& v : values) sum += (double{v.x} + v.y + v.z) / 3;
  return sum / static_cast<double>(values.size());
}

}  // namespace lte::infer::session_test
