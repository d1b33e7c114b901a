#include "lte/bake/light_group.h"

#include "lte/base/check.h"
#include "lte/scene/light_gains.h"

namespace lte::bake {

scene::Scene with_light_of(const scene::Scene& scene, int group, std::vector<int>* tree_of_mesh) {
  LTE_CHECK(group >= 0 && group < static_cast<int>(scene.light_groups.size()),
            "there is no light group ", group);
  std::vector<float> gains(scene.light_groups.size());
  gains[static_cast<size_t>(group)] = 1;
  return scene::with_gains(scene, gains, tree_of_mesh);
}

}  // namespace lte::bake
