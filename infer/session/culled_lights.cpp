#include "infer/session/culled_lights.h"

#include <algorithm>
#include <tuple>

namespace lte::infer {
namespace {

bool contains(const std::vector<int>& values, int value) {
  return std::find(values.begin(), values.end(), value) != values.end();
}

auto key(const scene::Camera& c) {
  return std::tuple(c.origin, c.target, c.up, c.vfov, c.mirrored);
}

}  // namespace

bool same_camera(const scene::Camera& a, const scene::Camera& b) { return key(a) == key(b); }

bool same_cameras(const std::vector<scene::Camera>& a, const std::vector<scene::Camera>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), same_camera);
}

std::vector<scene::Camera> without_repeats(std::vector<scene::Camera> cameras) {
  cameras.erase(std::unique(cameras.begin(), cameras.end(), same_camera), cameras.end());
  return cameras;
}

bool CulledLights::fits(const SceneEdits& edits, const std::vector<scene::Camera>& seen_by) const {
  return same_cameras(cameras, seen_by) && same_points(*found_for, edits);
}

std::vector<int> groups_of(const SceneEdits& edits, const std::vector<int>& lights) {
  std::vector<int> groups;
  for (size_t g = 0; g < edits.settings.size(); ++g) {
    if (contains(lights, edits.settings[g].label.id)) groups.push_back(static_cast<int>(g));
  }
  return groups;
}

std::vector<LightGroups> without_groups(std::vector<LightGroups> layers, const SceneEdits& edits,
                                        const std::vector<int>& groups) {
  for (LightGroups& layer : layers)
    std::erase_if(layer.groups, [&](const int group) { return contains(groups, group); });
  std::erase_if(layers, [&](const LightGroups& layer) {
    return std::all_of(layer.groups.begin(), layer.groups.end(), [&](const int group) {
      return edits.settings[static_cast<size_t>(group)].brightness <= 0;
    });
  });
  return layers;
}

}  // namespace lte::infer
