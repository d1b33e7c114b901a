// Images to textures.
#include <algorithm>
#include <map>

// Static, as another library of the program may carry its own copy; and only the two formats that
// glTF has: every other decoder is one more door for a broken file.
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_NO_STDIO
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_image.h>
#pragma GCC diagnostic pop

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/scene/gltf_import.h"

namespace lte::scene::gltf {
namespace {

bool starts_with(Bytes bytes, std::initializer_list<uint8_t> magic) {
  return bytes.size() >= magic.size() &&
         std::equal(magic.begin(), magic.end(), bytes.begin(),
                    [](uint8_t a, std::byte b) { return static_cast<std::byte>(a) == b; });
}

/// @param where  file and element, for messages
std::shared_ptr<const Texture> decode(Bytes bytes, int64_t limit_pixels, const std::string& where) {
  LTE_CHECK(starts_with(bytes, {0x89, 'P', 'N', 'G'}) || starts_with(bytes, {0xff, 0xd8}), where,
            ": neither PNG nor JPEG");
  LTE_CHECK(bytes.size() <= INT32_MAX, where, ": ", bytes.size(),
            " bytes are too many for one image");
  const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
  const int size = static_cast<int>(bytes.size());
  int width = 0, height = 0, channels = 0;
  LTE_CHECK(stbi_info_from_memory(data, size, &width, &height, &channels) == 1, where,
            ": broken image header");
  LTE_CHECK(int64_t{width} * height <= limit_pixels, where, ": ", width, "x", height,
            " pixels exceed the limit of ", limit_pixels);
  const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
      stbi_load_from_memory(data, size, &width, &height, &channels, 3), stbi_image_free);
  LTE_CHECK(pixels != nullptr, where, ": cannot decode the image: ", stbi_failure_reason());
  std::vector<uint8_t> texels(
      pixels.get(), pixels.get() + static_cast<size_t>(width) * static_cast<size_t>(height) * 3);
  return std::make_shared<const Texture>(width, height, std::move(texels), /*srgb=*/true);
}

}  // namespace

std::vector<std::shared_ptr<const Texture>> read_textures(const Context& context, Buffers* buffers,
                                                          std::vector<Material>* materials) {
  std::map<int, int> texture_of_image;  // ordered: textures come in the order of the file
  for (const Material& material : *materials) {
    for (const TextureRef* ref : {&material.base_color_texture, &material.emission_texture}) {
      if (ref->texture != kNone) texture_of_image[ref->texture] = 0;
    }
  }
  std::vector<std::pair<int, Bytes>> sources;
  for (auto& [image, texture] : texture_of_image) {
    texture = static_cast<int>(sources.size());
    sources.emplace_back(image, buffers->image(image));
  }
  std::vector<std::shared_ptr<const Texture>> textures(sources.size());
  parallel_for(static_cast<int64_t>(sources.size()), 1, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) {
      const auto& [image, bytes] = sources[static_cast<size_t>(i)];
      textures[static_cast<size_t>(i)] = decode(bytes, context.limits.texture_pixels,
                                                concat(context.file.name, ": images[", image, "]"));
    }
  });
  for (Material& material : *materials) {
    for (TextureRef* ref : {&material.base_color_texture, &material.emission_texture}) {
      if (ref->texture != kNone) ref->texture = texture_of_image[ref->texture];
    }
  }
  return textures;
}

}  // namespace lte::scene::gltf
