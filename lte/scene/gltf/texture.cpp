// Textures from the images of a file.
#include <array>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "lte/base/check.h"
#include "lte/scene/gltf/context.h"
#include "lte/scene/import/limit_error.h"
#include "lte/scene/import/texture_file.h"

namespace lte::scene::gltf {
namespace {

bool starts_with(Bytes bytes, std::string_view magic) {
  return std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size())
      .starts_with(magic);
}

/// The name of a format that is not read, by its first bytes; "" for PNG, JPEG and WebP.
std::string unread_format(Bytes bytes) {
  for (const char* read : {"\x89PNG", "\xff\xd8", "RIFF"})
    if (starts_with(bytes, read)) return "";
  if (starts_with(bytes, "\xabKTX 20")) return "KTX2";
  if (starts_with(bytes, "\xabKTX")) return "KTX";
  if (starts_with(bytes, "DDS ")) return "DDS";
  return "an unknown format";
}

/// Leaves a texture out of a material: its base color is then the factor alone; what would shine
/// through the texture stays dark, what would be metal by it is matt, and normals stay as they are.
void drop(const TextureRef* ref, Material* material) {
  if (ref == &material->emission_texture) material->emission = {};
  if (ref == &material->metallic_roughness_texture) material->metallic = 0;
}

/// The references of a material, and whether they are to colors.
std::array<std::pair<TextureRef*, bool>, 4> references(Material* material) {
  return {{{&material->base_color_texture, true},
           {&material->emission_texture, true},
           {&material->metallic_roughness_texture, false},
           {&material->normal_texture, false}}};
}

/// Finds for each image the first one of the same bytes: exporters list a picture once for every
/// use.
std::vector<int> first_of_each(const Json& images) {
  std::map<std::string, int> firsts;
  std::vector<int> out;
  for (const Json& image : images) {
    const auto number = static_cast<int>(out.size());
    const Json& source = image.contains("bufferView") ? image["bufferView"] : image["uri"];
    const bool inside =
        source.is_string() && source.get_ref<const std::string&>().starts_with("data:");
    out.push_back(inside ? number : firsts.emplace(source.dump(), number).first->second);
  }
  return out;
}

}  // namespace

std::vector<std::shared_ptr<const Texture>> read_textures(const Context& context, Buffers* buffers,
                                                          std::vector<Material>* materials) {
  // Keyed by the image and whether it holds colors; ordered, as textures come in the order of the
  // file.
  std::map<std::pair<int, bool>, int> texture_of_image;
  std::set<int> needed;  // as more than a normal map
  const std::vector<int> first = first_of_each(context.file.json["images"]);
  for (Material& material : *materials) {
    for (const auto& [ref, color] : references(&material)) {
      if (ref->texture == kNone) continue;
      ref->texture = first[static_cast<size_t>(ref->texture)];
      texture_of_image[{ref->texture, color}] = 0;
      if (ref != &material.normal_texture) needed.insert(ref->texture);
    }
  }
  std::vector<EncodedPicture> pictures;
  for (auto& [use, texture] : texture_of_image) {
    const auto& [image, color] = use;
    const bool optional = !needed.contains(image);
    Bytes bytes;
    try {
      bytes = buffers->image(image);
    } catch (const LimitError&) {
      throw;
    } catch (const Error&) {
      if (!optional) throw;
      context.ignored.add("picture of a normal map that is not there", "image");
      texture = kNone;
      continue;
    }
    if (const std::string format = unread_format(bytes); !format.empty()) {
      context.ignored.add(concat("texture in ", format, ", neither PNG nor JPEG nor WebP"),
                          "image");
      texture = kNone;
      continue;
    }
    texture = static_cast<int>(pictures.size());
    pictures.push_back(
        {bytes, concat(context.file.name, ": images[", image, "]"), color, optional});
  }
  for (Material& material : *materials) {
    for (const auto& [ref, color] : references(&material)) {
      if (ref->texture == kNone) continue;
      ref->texture = texture_of_image[{ref->texture, color}];
      if (ref->texture == kNone) drop(ref, &material);
    }
  }
  std::vector<std::shared_ptr<const Texture>> textures = decode_textures(pictures, &context.budget);
  drop_damaged(&textures, materials, &context.ignored);
  return textures;
}

}  // namespace lte::scene::gltf
