// How densely textures lie on triangles, kept from look-up to look-up: neighbouring rays meet the
// same triangles.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "lte/scene/scene.h"

namespace lte::scene {

/// For one thread, and while the scene stays as it is.
class TexelDensities {
 public:
  /// Edges of texels a world metre, as `work_out()` says if it is not known.
  template <typename WorkOut>
  double of(const TextureRef& texture, int instance, uint32_t triangle, const WorkOut& work_out) {
    Entry& entry = entries_[(triangle + static_cast<uint32_t>(instance) * 31u) % kEntries];
    if (entry.texture != &texture || entry.instance != instance || entry.triangle != triangle)
      entry = {&texture, instance, triangle, work_out()};
    return entry.density;
  }

 private:
  static constexpr uint32_t kEntries = 256;  // 6 KB, beside what shading reads

  struct Entry {
    const TextureRef* texture = nullptr;
    int instance = kNone;
    uint32_t triangle = 0;
    double density = 0;
  };
  std::array<Entry, kEntries> entries_;
};

/// evaluate_appearance() of surface.h to the bit, quicker where there is a footprint.
void evaluate_appearance(const Scene& scene, int instance, uint32_t triangle, float u, float v,
                         float footprint, TexelDensities* known, Rgb* albedo, Rgb* emission);

}  // namespace lte::scene
