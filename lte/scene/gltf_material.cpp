// Materials and the way they refer to textures.
#include "lte/base/check.h"
#include "lte/scene/gltf_import.h"

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

/// Texture reference with the file's image as its index; kNone if lte cannot follow it.
TextureRef to_ref(const Context& context, const tinygltf::TextureInfo& info) {
  TextureRef ref;
  if (info.index < 0) return ref;
  const tinygltf::Texture& texture = context.model.textures[static_cast<size_t>(info.index)];
  if (texture.source < 0) {
    context.notes.add("texture without a PNG or JPEG source", "use");
    return ref;
  }
  ref.uv_set = info.texCoord;
  if (texture.sampler >= 0) {
    const tinygltf::Sampler& sampler = context.model.samplers[static_cast<size_t>(texture.sampler)];
    ref.wrap_u = to_wrap(sampler.wrapS), ref.wrap_v = to_wrap(sampler.wrapT);
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
  if (ref.uv_set > 1 || ref.uv_set < 0) {
    context.notes.add("texture coordinates beyond TEXCOORD_1", "use");
    return {};
  }
  ref.texture = texture.source;
  return ref;
}

void note_ignored(const tinygltf::Material& material, Notes* notes) {
  const tinygltf::PbrMetallicRoughness& pbr = material.pbrMetallicRoughness;
  note_extensions(material.extensions, "material", notes);
  if (pbr.metallicRoughnessTexture.index >= 0) notes->add("metallic-roughness texture", "material");
  if (material.normalTexture.index >= 0) notes->add("normal map", "material");
  if (material.occlusionTexture.index >= 0) notes->add("occlusion texture", "material");
  if (material.alphaMode != "OPAQUE") notes->add("alphaMode " + material.alphaMode, "material");
  // The default of metallicFactor is 1, and most files that leave it out mean no metal.
  if (material.values.count("metallicFactor") > 0 && pbr.metallicFactor > 0)
    notes->add("metallicFactor", "material");
}

}  // namespace

std::vector<Material> read_materials(const Context& context) {
  std::vector<Material> out;
  for (size_t i = 0; i < context.model.materials.size(); ++i) {
    const tinygltf::Material& source = context.model.materials[i];
    note_ignored(source, &context.notes);
    Material material;
    material.name = source.name.empty() ? concat("material ", i) : source.name;
    material.base_color = to_rgb(source.pbrMetallicRoughness.baseColorFactor, {1, 1, 1});
    material.base_color_texture = to_ref(context, source.pbrMetallicRoughness.baseColorTexture);
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
