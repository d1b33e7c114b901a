#include "lte/scene/area_table.h"

#include <algorithm>
#include <utility>

#include "lte/base/parallel.h"
#include "lte/scene/triangle.h"

namespace lte::scene {
namespace {
constexpr int64_t kGrain = 1 << 15;
}

std::vector<Face> fronts(std::span<const int> instances) {
  std::vector<Face> faces;
  faces.reserve(instances.size());
  for (const int instance : instances) faces.push_back({instance});
  return faces;
}

std::vector<Face> emitting_faces(const Scene& scene, std::span<const int> instances) {
  std::vector<Face> faces;
  for (const int instance : instances) {
    const Material& material =
        scene.materials[scene.meshes[scene.instances[instance].mesh].material];
    faces.push_back({instance});
    if (material.emissive() && material.double_sided) faces.push_back({instance, true});
  }
  return faces;
}

AreaTable::AreaTable(const Scene& scene, std::vector<Face> faces, const RepeatedTriangles* repeated)
    : faces_(std::move(faces)) {
  first_.reserve(faces_.size() + 1);
  first_.push_back(0);
  for (const Face& face : faces_) {
    const Mesh& mesh = scene.meshes[scene.instances[face.instance].mesh];
    first_.push_back(first_.back() + static_cast<int64_t>(mesh.triangles.size()));
  }
  ends_.resize(static_cast<size_t>(first_.back()));
  parallel_for(first_.back(), kGrain, [&](int64_t begin, int64_t end) {
    auto slot = std::upper_bound(first_.begin(), first_.end(), begin) - first_.begin() - 1;
    for (int64_t i = begin; i < end; ++i) {
      while (i >= first_[static_cast<size_t>(slot) + 1]) ++slot;
      const int index = faces_[static_cast<size_t>(slot)].instance;
      const Instance& instance = scene.instances[index];
      const auto triangle = static_cast<uint32_t>(i - first_[static_cast<size_t>(slot)]);
      if (repeated != nullptr && repeated->contains(index, triangle)) continue;
      ends_[static_cast<size_t>(i)] =
          area(world_triangle(scene.meshes[instance.mesh], instance.to_world, triangle));
    }
  });
  // Summed in order on one thread, so that the bits do not depend on the number of threads.
  double sum = 0;
  for (size_t i = 0; i < ends_.size(); ++i) {
    if (ends_[i] > 0) last_ = static_cast<int64_t>(i);
    ends_[i] = sum += ends_[i];
  }
}

AreaTable::Place AreaTable::locate(double target) const {
  // The first end beyond the target: its triangle has area, or its end would not differ from the
  // one before.
  const auto found = std::upper_bound(ends_.begin(), ends_.end(), target) - ends_.begin();
  const auto index = std::min<int64_t>(found, last_);
  const double begin = index == 0 ? 0.0 : ends_[static_cast<size_t>(index) - 1];
  const double size = ends_[static_cast<size_t>(index)] - begin;

  Place place;
  const auto slot = std::upper_bound(first_.begin(), first_.end(), index) - first_.begin() - 1;
  place.face = faces_[static_cast<size_t>(slot)];
  place.triangle = static_cast<uint32_t>(index - first_[static_cast<size_t>(slot)]);
  place.fraction = size > 0 ? std::clamp((target - begin) / size, 0.0, 0x1.fffffffffffffp-1) : 0.0;
  return place;
}

}  // namespace lte::scene
