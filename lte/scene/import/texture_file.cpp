#include "lte/scene/import/texture_file.h"

#include <algorithm>
#include <cstdint>
#include <initializer_list>

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

namespace lte::scene {
namespace {

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

Size read_size(const EncodedPicture& picture) {
  Size size;
  if (is_webp(picture)) {
    WebPBitstreamFeatures features;
    LTE_CHECK(WebPGetFeatures(data(picture), picture.bytes.size(), &features) == VP8_STATUS_OK,
              picture.where, ": broken WebP header");
    LTE_CHECK(features.has_animation == 0, picture.where, ": an animated WebP is no texture");
    size = {features.width, features.height};
  } else {
    LTE_CHECK(picture.bytes.size() <= INT32_MAX, picture.where, ": ", picture.bytes.size(),
              " bytes are too many for one image");
    int channels = 0;
    LTE_CHECK(stbi_info_from_memory(data(picture), static_cast<int>(picture.bytes.size()),
                                    &size.width, &size.height, &channels) == 1,
              picture.where, ": broken image header, or none of PNG, JPEG, WebP, TGA and BMP");
  }
  LTE_CHECK(size.width > 0 && size.height > 0, picture.where, ": a picture without pixels");
  return size;
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

std::shared_ptr<const Texture> decode(const EncodedPicture& picture, Size size) {
  std::vector<uint8_t> texels =
      is_webp(picture) ? decode_webp(picture, &size) : decode_stb(picture, &size);
  return std::make_shared<const Texture>(size.width, size.height, std::move(texels), picture.srgb);
}

}  // namespace

std::vector<std::shared_ptr<const Texture>> decode_textures(
    const std::vector<EncodedPicture>& pictures, const LoadLimits& limits) {
  std::vector<Size> sizes;
  int64_t total = 0;
  for (const EncodedPicture& picture : pictures) {
    sizes.push_back(read_size(picture));
    const Size& size = sizes.back();
    LTE_CHECK(size.pixels() <= limits.texture_pixels, picture.where, ": ", size.width, "x",
              size.height, " pixels exceed the limit of ", limits.texture_pixels);
    total += size.pixels();
    LTE_CHECK(total <= limits.total_texture_pixels, picture.where,
              ": with this picture textures have ", total, " pixels, more than the limit of ",
              limits.total_texture_pixels, " for all");
  }
  std::vector<std::shared_ptr<const Texture>> textures(pictures.size());
  parallel_for(static_cast<int64_t>(pictures.size()), 1, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) {
      const auto k = static_cast<size_t>(i);
      textures[k] = decode(pictures[k], sizes[k]);
    }
  });
  return textures;
}

}  // namespace lte::scene
