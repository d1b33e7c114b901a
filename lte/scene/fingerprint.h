// What a scene is, in a few digits: two scenes of one fingerprint have the same light.
#pragma once

#include <string>

#include "lte/scene/scene.h"

namespace lte::scene {

/// Checksums of 16 hexadecimal digits (lte/base/checksum.h) over the scene as it is in memory, so
/// that what flags have changed about it counts too. Names and cameras do not count.
struct Fingerprint {
  std::string geometry;   ///< meshes and where they stand
  std::string materials;  ///< colors, metal, emission and their textures
  std::string lights;     ///< punctual lights, environment, and which instances are one luminaire

  friend bool operator==(const Fingerprint&, const Fingerprint&) = default;
};

Fingerprint fingerprint(const Scene& scene);

/// Of a mesh alone, its material left out.
std::string mesh_fingerprint(const Mesh& mesh);

}  // namespace lte::scene
