#include "lte/scene/import/texture_file.h"

#include <algorithm>
#include <cstdint>
#include <string_view>

#include <webp/decode.h>

// Static, as another library of the program may carry its own copy; and only the formats that
// scenes use: every other decoder is one more door for a broken file.
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_ONLY_TGA
#define STBI_ONLY_BMP
#define STBI_NO_STDIO
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#ifndef __clang__  // which has no such warning; stb sets the members of a context as it needs them
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#include <stb_image.h>
#pragma GCC diagnostic pop

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/image/declared_size.h"

namespace lte::scene {
namespace {

/// As the decoders have it.
struct Size {
  int width = 0, height = 0;
  int64_t pixels() const { return int64_t{width} * height; }
};

bool is_webp(const EncodedPicture& picture) {
  const auto at = [&](size_t i) { return std::to_integer<char>(picture.bytes[i]); };
  return picture.bytes.size() >= 12 && at(0) == 'R' && at(1) == 'I' && at(2) == 'F' &&
         at(3) == 'F' && at(8) == 'W' && at(9) == 'E' && at(10) == 'B' && at(11) == 'P';
}

const uint8_t* data(const EncodedPicture& picture) {
  return reinterpret_cast<const uint8_t*>(picture.bytes.data());
}

DeclaredPicture read_size(const EncodedPicture& picture) {
  const std::string_view bytes(reinterpret_cast<const char*>(picture.bytes.data()),
                               picture.bytes.size());
  if (is_webp(picture)) {
    WebPBitstreamFeatures features;
    LTE_CHECK(WebPGetFeatures(data(picture), picture.bytes.size(), &features) == VP8_STATUS_OK,
              picture.where, ": broken WebP header");
    LTE_CHECK(features.has_animation == 0, picture.where, ": an animated WebP is no texture");
    return {picture.where, features.width, features.height};
  }
  LTE_CHECK(picture.bytes.size() <= INT32_MAX, picture.where, ": ", picture.bytes.size(),
            " bytes are too many for one image");
  const image::DeclaredSize declared = image::declared_size(bytes).value_or(image::DeclaredSize{});
  Size size;
  int channels = 0;
  if (stbi_info_from_memory(data(picture), static_cast<int>(picture.bytes.size()), &size.width,
                            &size.height, &channels) != 1) {
    if (declared.beyond_stb()) return {picture.where, declared.width, declared.height};
    throw Error(
        concat(picture.where, ": broken image header, or none of PNG, JPEG, WebP, TGA and BMP"));
  }
  LTE_CHECK(size.width > 0 && size.height > 0, picture.where, ": a picture without pixels");
  return {picture.where, std::max<int64_t>(size.width, declared.width),
          std::max<int64_t>(size.height, declared.height)};
}

std::vector<uint8_t> decode_webp(const EncodedPicture& picture, Size* size) {
  // Into libwebp's own memory first: of a damaged picture the system never hands out the pages.
  const std::unique_ptr<uint8_t, void (*)(void*)> pixels(
      WebPDecodeRGB(data(picture), picture.bytes.size(), &size->width, &size->height), WebPFree);
  LTE_CHECK(pixels != nullptr, picture.where,
            ": cannot decode the image: damaged or truncated WebP");
  return {pixels.get(), pixels.get() + static_cast<size_t>(size->pixels()) * 3};
}

std::vector<uint8_t> decode_stb(const EncodedPicture& picture, Size* size) {
  int channels = 0;
  const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
      stbi_load_from_memory(data(picture), static_cast<int>(picture.bytes.size()), &size->width,
                            &size->height, &channels, 3),
      stbi_image_free);
  LTE_CHECK(pixels != nullptr, picture.where, ": cannot decode the image: ", stbi_failure_reason());
  return {pixels.get(), pixels.get() + static_cast<size_t>(size->pixels()) * 3};
}

std::shared_ptr<const Texture> decode(const EncodedPicture& picture) {
  Size size;
  std::vector<uint8_t> texels =
      is_webp(picture) ? decode_webp(picture, &size) : decode_stb(picture, &size);
  return std::make_shared<const Texture>(size.width, size.height, std::move(texels), picture.srgb);
}

}  // namespace

std::vector<std::shared_ptr<const Texture>> decode_textures(
    const std::vector<EncodedPicture>& pictures, LoadBudget* budget) {
  std::vector<DeclaredPicture> sizes;
  std::vector<uint8_t> damaged(pictures.size());
  for (size_t i = 0; i < pictures.size(); ++i) {
    try {
      sizes.push_back(read_size(pictures[i]));
    } catch (const Error&) {
      if (!pictures[i].optional) throw;
      damaged[i] = 1;
    }
  }
  budget->add_pictures(sizes, kTextureBytes);
  std::vector<std::shared_ptr<const Texture>> textures(pictures.size());
  parallel_for(static_cast<int64_t>(pictures.size()), 1, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) {
      const auto k = static_cast<size_t>(i);
      if (damaged[k]) continue;
      try {
        textures[k] = decode(pictures[k]);
      } catch (const Error&) {
        if (!pictures[k].optional) throw;
      }
    }
  });
  return textures;
}

void drop_damaged(std::vector<std::shared_ptr<const Texture>>* textures,
                  std::vector<Material>* materials, IgnoredFeatures* ignored) {
  std::vector<int> place;
  int kept = 0;
  for (const auto& texture : *textures) place.push_back(texture != nullptr ? kept++ : kNone);
  if (static_cast<size_t>(kept) == textures->size()) return;
  for (Material& material : *materials) {
    for (TextureRef* ref : {&material.base_color_texture, &material.emission_texture,
                            &material.metallic_roughness_texture, &material.normal_texture}) {
      if (ref->texture != kNone) ref->texture = place[static_cast<size_t>(ref->texture)];
    }
  }
  ignored->add("damaged picture of a normal map", "image",
               static_cast<int64_t>(textures->size()) - kept);
  std::erase(*textures, nullptr);
}

}  // namespace lte::scene
