#include "infer/render/scene_size.h"

#include "lte/base/log.h"
#include "lte/pathtrace/placement/free_space.h"
#include "lte/scene/light_points.h"

namespace lte::infer {

void say_unit(const std::string& name, const pathtrace::Bvh& bvh) {
  const float height = pathtrace::survey(bvh).room_height;
  const char* unit = pathtrace::likely_unit(height);
  if (unit == nullptr) return;
  log_info(name, ": rooms are ", height, " units high, so the unit is most likely ", unit,
           bvh.scene().lights.empty()
               ? "; surfaces and environments light alike in any unit"
               : "; it is taken for the metre, and point and spot lights fall off by it");
}

void check_size(const std::string& name, const scene::Scene& scene, const runtime::Network& network,
                bool rescale) {
  const double extent = max_component(scene::point_bounds(scene).extent());
  const double known = network.config().scale;
  network.check_fits(extent, rescale);
  if (rescale && extent < network.least_extent()) {
    log_info(name, ": spans ", extent, " m; for the network alone it is enlarged to ",
             network.least_extent(),
             " m, as the least that it knows (--set rescale=off: as it is)");
  }
  if (extent <= known) return;
  log_info(name, ": spans ", extent, " m; for the network alone it is shrunk to the ", known,
           " m that the model knows (--set rescale=off refuses instead)");
}

}  // namespace lte::infer
