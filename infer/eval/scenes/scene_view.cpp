#include "infer/eval/scenes/scene_view.h"

#include <algorithm>
#include <utility>

#include "infer/picture/surface_guides.h"
#include "lte/base/check.h"
#include "lte/pathtrace/placement/added_light.h"
#include "lte/pathtrace/placement/auto_camera.h"
#include "lte/pathtrace/render.h"
#include "lte/scene/load_camera.h"

namespace lte::infer {
namespace {

/// Of a look at what a camera sees at all.
constexpr int kLookWidth = 32, kLookHeight = 24, kLookPaths = 16;
/// Share of the picture that has to be a surface.
constexpr double kMinSeen = 0.01;
/// Diagonals of the bounds beyond which a camera belongs to another scene.
constexpr float kFarthest = 3;
/// Share of the picture that has to be left without emitters.
constexpr double kMinUnlit = 0.05;

bool is_far(const scene::Camera& camera, const Bounds& bounds) {
  const float margin = kFarthest * length(bounds.extent());
  const Vec3 p = camera.origin, low = bounds.low, high = bounds.high;
  return std::max({low.x - p.x, p.x - high.x, low.y - p.y, p.y - high.y, low.z - p.z,
                   p.z - high.z}) > margin;
}

}  // namespace

SceneView load_view(const scene::FoundScene& file, const SceneFlags& loading, float aspect,
                    const std::shared_ptr<SharedDenoiser>& denoiser) {
  SceneView view;
  view.name = file.name;
  scene::Scene scene = load_scene(file.path, loading);
  std::vector<scene::Camera> cameras;
  if (!file.camera.empty()) {
    cameras = {scene::load_camera(file.camera)};
    view.camera_from = "camera file";
  } else if (!scene.cameras.empty()) {
    cameras = {scene.cameras.front()};
    view.camera_from = "scene";
  }
  for (const std::string& ignored : scene.ignored) view.notes.push_back("ignored: " + ignored);
  if (pathtrace::Lights(scene).empty())
    view.notes.push_back("without light; added " + pathtrace::add_light("auto", cameras, &scene));
  auto held = std::make_unique<const scene::Scene>(std::move(scene));
  view.renderer = std::make_unique<Renderer>(std::make_shared<pathtrace::Bvh>(*held),
                                             std::make_shared<pathtrace::Lights>(*held), denoiser);
  if (cameras.empty()) {
    cameras = {pathtrace::auto_camera(view.renderer->bvh(), 0, aspect)};
    view.camera_from = "automatic";
  }
  view.scene = std::move(held);
  view.camera = cameras.front();
  return view;
}

void check_camera_file(const scene::FoundScene& file, const SceneView& view, float aspect) {
  const pathtrace::Bvh& bvh = view.renderer->bvh();
  const Bounds& bounds = bvh.bounds();
  const auto fail = [&](const char* what) {
    throw Error(concat(file.camera.string(), ": ", what, " ", file.path.filename().string(),
                       ", which lies at ", bounds.low.x, " ", bounds.low.y, " ", bounds.low.z,
                       " to ", bounds.high.x, " ", bounds.high.y, " ", bounds.high.z,
                       "; is it the camera of another scene?"));
  };
  if (is_far(view.camera, bounds)) fail("stands far outside of");
  const auto height = static_cast<int>(static_cast<float>(kLookWidth) / aspect);
  const int rows = std::clamp(height, kLookHeight / 2, 2 * kLookWidth);
  const pathtrace::GBuffer hits = pathtrace::trace_gbuffer(bvh, view.camera, kLookWidth, rows);
  const auto seen = std::count(hits.mask.begin(), hits.mask.end(), uint8_t{1});
  if (static_cast<double>(seen) < kMinSeen * kLookWidth * rows) fail("sees nothing of");
  const image::Image look =
      pathtrace::render_reference(bvh, view.renderer->lights(), view.camera, kLookWidth, rows,
                                  {kLookPaths, RenderSettings().max_depth + 1, 0});
  if (std::none_of(look.pixels.begin(), look.pixels.end(), [](float v) { return v > 0; }))
    fail("sees no light in");
}

std::vector<uint8_t> irradiance_mask(const SceneView& view, int width, int height) {
  const pathtrace::GBuffer hits =
      pathtrace::trace_gbuffer(view.renderer->bvh(), view.camera, width, height);
  const SurfaceGuides guides = guides_of(hits);
  std::vector<uint8_t> matt(guides.pixels()), unlit(guides.pixels());
  for (size_t i = 0; i < matt.size(); ++i) {
    matt[i] = guides.mask[i] && !guides.metal[i];
    unlit[i] = matt[i] && !(max_component(hits.emission[i]) > 0);
  }
  const auto left = std::count(unlit.begin(), unlit.end(), uint8_t{1});
  return static_cast<double>(left) >= kMinUnlit * static_cast<double>(unlit.size()) ? unlit : matt;
}

}  // namespace lte::infer
