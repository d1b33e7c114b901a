// Materials and the way they refer to textures.
#include <algorithm>

#include "lte/base/check.h"
#include "lte/scene/gltf/context.h"

namespace lte::scene::gltf {
namespace {

Rgb to_rgb(const std::vector<double>& values, const Rgb& fallback) {
  if (values.size() < 3) return fallback;
  return {static_cast<float>(values[0]), static_cast<float>(values[1]),
          static_cast<float>(values[2])};
}

Wrap to_wrap(int mode) {
  if (mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return Wrap::ClampToEdge;
  return mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? Wrap::MirroredRepeat : Wrap::Repeat;
}

Vec2 to_vec2(const tinygltf::Value& values) {
  return {static_cast<float>(values.Get(0).GetNumberAsDouble()),
          static_cast<float>(values.Get(1).GetNumberAsDouble())};
}

/// The WebP picture comes first: the other one is for readers that lack it.
int to_image(const tinygltf::Texture& texture) {
  const auto webp = texture.extensions.find("EXT_texture_webp");
  if (webp == texture.extensions.end() || !webp->second.Has("source")) return texture.source;
  return webp->second.Get("source").GetNumberAsInt();
}

/// Texture reference with the file's image as its index; kNone if lte cannot follow it.
TextureRef to_ref(const Context& context, const tinygltf::TextureInfo& info) {
  TextureRef ref;
  if (info.index < 0) return ref;
  const tinygltf::Texture& texture = context.model.textures[static_cast<size_t>(info.index)];
  const int image = to_image(texture);
  if (image < 0) {
    context.ignored.add("texture without a PNG, JPEG or WebP source", "use");
    return ref;
  }
  ref.uv_set = info.texCoord;
  if (texture.sampler >= 0) {
    const tinygltf::Sampler& sampler = context.model.samplers[static_cast<size_t>(texture.sampler)];
    ref.wrap_u = to_wrap(sampler.wrapS);
    ref.wrap_v = to_wrap(sampler.wrapT);
  }
  if (const auto found = info.extensions.find("KHR_texture_transform");
      found != info.extensions.end()) {
    const tinygltf::Value& transform = found->second;
    if (transform.Has("offset")) ref.offset = to_vec2(transform.Get("offset"));
    if (transform.Has("scale")) ref.scale = to_vec2(transform.Get("scale"));
    if (transform.Has("rotation"))
      ref.rotation = static_cast<float>(transform.Get("rotation").GetNumberAsDouble());
    if (transform.Has("texCoord")) ref.uv_set = transform.Get("texCoord").GetNumberAsInt();
  }
  if (ref.uv_set >= kUvSets || ref.uv_set < 0) {
    context.ignored.add(concat("texture coordinates beyond TEXCOORD_", kUvSets - 1), "use");
    return {};
  }
  ref.texture = image;
  return ref;
}

void ignore_unsupported(const tinygltf::Material& material, IgnoredFeatures* ignored) {
  const tinygltf::PbrMetallicRoughness& pbr = material.pbrMetallicRoughness;
  ignore_unknown_extensions(material.extensions, "material", ignored);
  if (pbr.metallicRoughnessTexture.index >= 0 && !(pbr.metallicFactor > 0))
    ignored->add("metallic-roughness texture without metallicFactor", "material");
  if (material.occlusionTexture.index >= 0) ignored->add("occlusion texture", "material");
  if (material.alphaMode != "OPAQUE") ignored->add("alphaMode " + material.alphaMode, "material");
}

/// Texture of an extension, which tinygltf keeps as JSON.
tinygltf::TextureInfo to_info(const tinygltf::Value& value) {
  tinygltf::TextureInfo info;
  info.index = value.Get("index").GetNumberAsInt();
  if (value.Has("texCoord")) info.texCoord = value.Get("texCoord").GetNumberAsInt();
  if (value.Has("extensions") && value.Get("extensions").Has("KHR_texture_transform")) {
    info.extensions["KHR_texture_transform"] = value.Get("extensions").Get("KHR_texture_transform");
  }
  return info;
}

/// Metal as the specification's defaults have it: a file that says nothing means metallicFactor 1,
/// roughnessFactor 1. What is no metal is Lambertian, without the specification's dielectric coat.
void read_metal(const Context& context, const tinygltf::PbrMetallicRoughness& source,
                Material* material) {
  const auto unit = [](double value) { return static_cast<float>(std::clamp(value, 0.0, 1.0)); };
  material->metallic = unit(source.metallicFactor);
  material->roughness = unit(source.roughnessFactor);
  if (material->metallic > 0)
    material->metallic_roughness_texture = to_ref(context, source.metallicRoughnessTexture);
}

/// tinygltf has a type of its own for normal maps.
void read_normal_map(const Context& context, const tinygltf::NormalTextureInfo& source,
                     Material* material) {
  tinygltf::TextureInfo info;
  info.index = source.index;
  info.texCoord = source.texCoord;
  info.extensions = source.extensions;
  material->normal_texture = to_ref(context, info);
  material->normal_scale = static_cast<float>(source.scale);
}

/// The older specular-glossiness model keeps the color of a surface apart; it comes first, as it
/// does for every reader that has it.
void read_surface(const Context& context, const tinygltf::Material& source, Material* material) {
  const auto glossy = source.extensions.find("KHR_materials_pbrSpecularGlossiness");
  if (glossy == source.extensions.end()) {
    material->base_color = to_rgb(source.pbrMetallicRoughness.baseColorFactor, {1, 1, 1});
    material->base_color_texture = to_ref(context, source.pbrMetallicRoughness.baseColorTexture);
    read_metal(context, source.pbrMetallicRoughness, material);
    return;
  }
  if (glossy->second.Has("diffuseFactor")) {
    for (int c = 0; c < 3; ++c) {
      material->base_color[c] =
          static_cast<float>(glossy->second.Get("diffuseFactor").Get(c).GetNumberAsDouble());
    }
  }
  if (glossy->second.Has("diffuseTexture"))
    material->base_color_texture = to_ref(context, to_info(glossy->second.Get("diffuseTexture")));
}

}  // namespace

std::vector<Material> read_materials(const Context& context) {
  std::vector<Material> out;
  for (size_t i = 0; i < context.model.materials.size(); ++i) {
    const tinygltf::Material& source = context.model.materials[i];
    ignore_unsupported(source, &context.ignored);
    Material material;
    material.name = source.name.empty() ? concat("material ", i) : source.name;
    read_surface(context, source, &material);
    read_normal_map(context, source.normalTexture, &material);
    material.double_sided = source.doubleSided;
    material.emission = to_rgb(source.emissiveFactor, {0, 0, 0});
    const auto strength = source.extensions.find("KHR_materials_emissive_strength");
    if (strength != source.extensions.end() && strength->second.Has("emissiveStrength")) {
      material.emission *=
          static_cast<float>(strength->second.Get("emissiveStrength").GetNumberAsDouble());
    }
    LTE_CHECK(is_finite(material.emission), context.file.name, ": materials[", i,
              "]: its emission is not finite");
    if (material.emissive()) material.emission_texture = to_ref(context, source.emissiveTexture);
    out.push_back(std::move(material));
  }
  return out;
}

}  // namespace lte::scene::gltf
