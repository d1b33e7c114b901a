// How much of a scene is metal, which the network knows nothing of.
#pragma once

#include <string>

#include "lte/scene/scene.h"

namespace lte::scene {

/// Shares of a scene's surface or of what a camera sees, [0, 1].
struct MetalShare {
  double metal = 0;       ///< area by how metallic it is
  double by_default = 0;  ///< of that, what is_default_metal() has
};

/// Whether a material is what glTF assumes where a file names no material, or no metallicFactor and
/// roughnessFactor: metallic 1, roughness 1, without a texture of them. Few files mean it.
bool is_default_metal(const Material& material);

/// Shares of the surface area. A texture is looked up once a triangle, averaged over its size.
MetalShare metal_share(const Scene& scene);

/// Whether no surface is anything but metal; a texture may say otherwise.
bool all_metal(const Scene& scene);

/// "12 % of the visible surface is metal, mostly by glTF's default, ..."; empty without metal.
/// @param of  "visible surface"
std::string metal_text(const MetalShare& share, const std::string& of);

}  // namespace lte::scene
