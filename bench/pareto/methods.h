// The methods of the chart of time against error: pictures by lte_render's renderer in each of its
// ways, with a name, a family (a line in the chart) and words for people.
//
// methods.cpp alone calls the renderer: a new way is a row of all_methods() there.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "infer/renderer/renderer.h"
#include "lte/image/image.h"
#include "lte/runtime/network.h"
#include "lte/scene/scene.h"

namespace lte::bench {

/// Loading and the BVH come before, and are in no row.
struct MethodScene {
  infer::Renderer& renderer;  ///< with the BVH and lights; keeps what one method prepares
  const runtime::Network& network;
  int width = 0, height = 0;
  int max_depth = 5;  ///< surface hits after the primary one
  uint64_t seed = 0;
};

/// Radiance towards the camera.
struct MethodPicture {
  image::Image whole;
  /// Of that, light reflected more than once; called when no time is taken. Null where a method
  /// cannot tell.
  std::function<image::Image()> indirect;
};

struct Method {
  std::string name;    ///< one word: what --methods takes
  std::string family;  ///< one word: a line in the chart; --methods takes it too
  std::string settings;
  /// Work once for all views, e.g. encoding.
  std::function<void(const MethodScene& scene)> prepare;
  /// @param spent_s  seconds that prepare() took, for methods that keep to a time
  std::function<MethodPicture(const MethodScene& scene, const scene::Camera& camera,
                              double spent_s)>
      render;
};

/// Every method, in the order of the table.
std::vector<Method> all_methods();

/// Those whose name or family is among `words`; all of them if there are none.
/// @throws lte::Error naming the word that is neither, and the families
std::vector<Method> choose_methods(const std::vector<std::string>& words);

}  // namespace lte::bench
