// The methods of the chart of time against error: each renders views of a scene, and says what it
// did once for all of them.
//
// A new method is a row of all_methods() (methods.cpp): a name, its family (a line in the chart),
// words for its settings, and a function that prepares what its views share.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "infer/renderer/renderer.h"
#include "lte/image/image.h"
#include "lte/runtime/network.h"
#include "lte/scene/scene.h"

namespace lte::infer {

/// What all methods are given. Loading and the BVH come before, and are in no row.
struct MethodScene {
  Renderer& renderer;  ///< with the BVH and lights; keeps the embedding of one method at a time
  const runtime::Network& network;
  int width = 0, height = 0;
  int max_depth = 5;  ///< surface hits after the primary one
  uint64_t seed = 0;
};

/// Radiance towards the camera, anti-aliased.
struct MethodPicture {
  image::Image whole;
  /// Of that, what was reflected more than once: asked for after the picture, when no time is
  /// taken. Empty for a method that cannot tell.
  std::function<image::Image()> indirect;
};

/// Wall-clock seconds by stage. A stage named kDirect is what a picture of indirect light alone
/// would not take.
using StageTimes = std::map<std::string, double>;
inline constexpr const char* kDirect = "direct";

/// Renders one view; adds its stages.
using RenderView = std::function<MethodPicture(const scene::Camera& camera, StageTimes* stages)>;

struct Method {
  std::string name;      ///< one word: what --methods takes
  std::string family;    ///< one word: a line in the chart; --methods takes it too
  std::string settings;  ///< for people
  /// What is done once for all views, e.g. encoding. What it returns is used until another method
  /// prepares the same scene.
  std::function<RenderView(const MethodScene& scene, StageTimes* stages)> prepare;
};

/// Every method there is, in the order of the table.
std::vector<Method> all_methods();

/// Those whose name or family is among `words`; all of them if there are none.
/// @throws lte::Error naming the word that is neither, and the families there are.
std::vector<Method> choose_methods(const std::vector<std::string>& words);

// The families: a file each.

/// Path tracing, `paths` a pixel.
Method path_tracing(int paths);
/// Path tracing whose reflected light is denoised with the albedo and normals of pixel centres, by
/// Open Image Denoise where it is found.
Method denoised_paths(int paths);
/// lte_render as it is: every pixel is decoded.
/// @param direct_samples  shadow rays a pixel
Method network_everywhere(int direct_samples);
/// The same with few pixels decoded and the others taken from them, as `--sparse on` has it; and as
/// `--quality draft` has it.
Method network_sparsely(int direct_samples);
Method network_draft();
/// lte_render --indirect decoded --correction-paths.
Method network_corrected(int paths);
/// Denoised path tracing of one pixel in step², upsampled as sparse answers are.
Method reduced_paths(int step, int paths);
/// The same pipeline without the network: light estimates at as many scene points, of as many paths
/// as the network reads, averaged over the nearest at each pixel by distance, plane and normal.
Method light_estimates(int64_t scene_points, int neighbours);
/// As `--indirect gather` has it: light gathered from a table of raw estimates, with as many gather
/// as shadow rays a pixel, denoised.
Method gathered_light(int rays);
/// The same at a quarter of the pixels; and from a table that the network has filled.
Method gathered_sparsely(int rays);
Method gathered_from_network(int rays);
/// As `--quality draft` has it; for those of more than 2^20 pixels; for views that share light.
enum class DraftKind { Plain, Large, Kept };
Method gathered_draft(DraftKind kind);
/// As `--quality final` has it, with its own number of correcting paths or, from 0 on, so many.
Method gathered_final(int paths = -1);
/// As `--time-budget` has it: what is done once and one view together take this time.
Method time_budget(double seconds);
/// A light map for many views: as many paths at about so many texels on all surfaces, denoised.
Method light_map(int64_t texels, int paths);

}  // namespace lte::infer
