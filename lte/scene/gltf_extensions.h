// The glTF extensions that lte understands.
#pragma once

#include <array>
#include <string_view>

namespace lte::scene::gltf {

/// KHR_mesh_quantization only widens the component types of attributes, and Accessor reads them
/// all.
inline constexpr std::array<std::string_view, 4> kSupportedExtensions = {
    "KHR_lights_punctual", "KHR_materials_emissive_strength", "KHR_mesh_quantization",
    "KHR_texture_transform"};

constexpr bool is_supported_extension(std::string_view name) {
  for (const std::string_view supported : kSupportedExtensions) {
    if (name == supported) return true;
  }
  return false;
}

}  // namespace lte::scene::gltf
