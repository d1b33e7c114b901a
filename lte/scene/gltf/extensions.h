// The glTF extensions that lte understands, and those whose loss it can name.
#pragma once

#include <array>
#include <string_view>

namespace lte::scene::gltf {

/// KHR_mesh_quantization only widens the component types of attributes, and Accessor reads them
/// all.
inline constexpr std::array<std::string_view, 7> kSupportedExtensions = {
    "EXT_mesh_gpu_instancing", "EXT_texture_webp",      "KHR_draco_mesh_compression",
    "KHR_lights_punctual",     "KHR_mesh_quantization", "KHR_materials_emissive_strength",
    "KHR_texture_transform"};

/// An extension that changes how a surface looks and not where it is: a file that requires it still
/// loads, and what is lost is named.
struct Dropped {
  std::string_view extension;
  std::string_view what;
};

inline constexpr std::array<Dropped, 15> kDroppedExtensions = {{
    {"KHR_materials_anisotropy", "anisotropic highlights"},
    {"KHR_materials_clearcoat", "clear coat"},
    {"KHR_materials_diffuse_transmission", "diffuse transmission (surfaces are opaque)"},
    {"KHR_materials_dispersion", "dispersion"},
    {"KHR_materials_ior", "index of refraction"},
    {"KHR_materials_iridescence", "iridescence"},
    {"KHR_materials_pbrSpecularGlossiness", "specular and glossiness (the diffuse color is kept)"},
    {"KHR_materials_sheen", "sheen"},
    {"KHR_materials_specular", "specular strength and color"},
    {"KHR_materials_transmission", "transmission (surfaces are opaque)"},
    {"KHR_materials_unlit", "the wish to be unlit (surfaces are lit)"},
    {"KHR_materials_variants", "material variants (the default one is kept)"},
    {"KHR_materials_volume", "absorption in the volume"},
    {"KHR_xmp_json_ld", "metadata"},
    {"KHR_animation_pointer", "animated properties"},
}};

constexpr bool is_supported_extension(std::string_view name) {
  for (const std::string_view supported : kSupportedExtensions) {
    if (name == supported) return true;
  }
  return false;
}

/// What is lost with an extension; empty if lte knows nothing of it.
constexpr std::string_view dropped_with(std::string_view name) {
  for (const Dropped& dropped : kDroppedExtensions) {
    if (name == dropped.extension) return dropped.what;
  }
  return {};
}

}  // namespace lte::scene::gltf
