#include "lte/image/png.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>

// Static, as another library of the program may carry its own copy. Only the two formats that
// scenes use: every other decoder is one more door for a broken file.
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_NO_STDIO
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STBI_WRITE_NO_STDIO
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_image.h>
#include <stb_image_write.h>
#pragma GCC diagnostic pop

#include "lte/base/file.h"

namespace lte::image {
namespace {

struct StbFree {
  void operator()(void* pixels) const { stbi_image_free(pixels); }
};

void append(void* out, void* bytes, int size) {
  const auto* begin = static_cast<const unsigned char*>(bytes);
  static_cast<std::vector<unsigned char>*>(out)->insert(
      static_cast<std::vector<unsigned char>*>(out)->end(), begin, begin + size);
}

unsigned char to_byte(float value) {
  if (!(value > 0)) return 0;  // NaN too
  return static_cast<unsigned char>(std::lround(255 * std::min(value, 1.0f)));
}

template <typename T>
Image to_image(const T* samples, int width, int height, int channels) {
  Image picture(width, height, channels);
  constexpr float kMax = std::numeric_limits<T>::max();
  for (size_t i = 0; i < picture.pixels.size(); ++i)
    picture.pixels[i] = static_cast<float>(samples[i]) / kMax;
  return picture;
}

}  // namespace

std::vector<unsigned char> encode_png(const Image& display) {
  LTE_CHECK(display.channels == 1 || display.channels == 3, "PNG: expected 1 or 3 channels, got ",
            display.channels);
  LTE_CHECK(static_cast<int64_t>(display.width) * display.height <= int64_t{1} << 28,
            "PNG: ", display.width, " x ", display.height, " pixels are too many");
  std::vector<unsigned char> bytes(display.pixels.size());
  std::transform(display.pixels.begin(), display.pixels.end(), bytes.begin(), to_byte);
  std::vector<unsigned char> png;
  const int written =
      stbi_write_png_to_func(append, &png, display.width, display.height, display.channels,
                             bytes.data(), display.width * display.channels);
  LTE_CHECK(written != 0, "PNG: cannot encode ", display.width, " x ", display.height, " pixels");
  return png;
}

void write_png(const std::filesystem::path& path, const Image& display) {
  const std::vector<unsigned char> png = encode_png(display);
  AtomicFile file(path);
  file.write(png.data(), png.size());
  file.commit();
}

Image read_png(const std::filesystem::path& path, int64_t limit_pixels) {
  const std::string file = read_file(path);
  const auto* bytes = reinterpret_cast<const unsigned char*>(file.data());
  const int size = static_cast<int>(std::min<size_t>(file.size(), std::numeric_limits<int>::max()));
  const std::string name = path.string();
  int width = 0, height = 0, channels = 0;
  if (stbi_info_from_memory(bytes, size, &width, &height, &channels) == 0) {
    const bool known = file.rfind("\x89PNG", 0) == 0 || file.rfind("\xff\xd8\xff", 0) == 0;
    throw Error(concat(
        name, ": cannot decode: ",
        known ? "its header is broken or declares too many pixels" : "neither PNG nor JPEG"));
  }
  // A small file may declare a huge picture: refuse before the decoder allocates it.
  LTE_CHECK(static_cast<int64_t>(width) * height <= limit_pixels, name, ": ", width, " x ", height,
            " pixels exceed the limit of ", limit_pixels);
  const int wanted = channels == 2 || channels == 4 ? 4 : 3;
  const auto decode = [&](auto load) {
    const std::unique_ptr<
        std::remove_pointer_t<decltype(load(bytes, size, &width, &height, &channels, wanted))>,
        StbFree>
        samples(load(bytes, size, &width, &height, &channels, wanted));
    LTE_CHECK(samples, name, ": cannot decode: ", stbi_failure_reason());
    return to_image(samples.get(), width, height, wanted);
  };
  return stbi_is_16_bit_from_memory(bytes, size) != 0 ? decode(stbi_load_16_from_memory)
                                                      : decode(stbi_load_from_memory);
}

}  // namespace lte::image
