#include "lte/image/png.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>
#include <string>

#ifdef LTE_PNG_ZLIB
#include <zlib.h>

namespace {

/// In the place of stb's own compressor, which takes many times as long. Stb frees the buffer.
unsigned char* compress_by_zlib(unsigned char* bytes, int size, int* compressed_size, int) {
  uLongf room = compressBound(static_cast<uLong>(size));
  auto* const out = static_cast<unsigned char*>(std::malloc(room));
  if (out == nullptr) return nullptr;
  if (compress2(out, &room, bytes, static_cast<uLong>(size), Z_BEST_SPEED) != Z_OK ||
      room > static_cast<uLongf>(std::numeric_limits<int>::max())) {
    std::free(out);
    return nullptr;
  }
  *compressed_size = static_cast<int>(room);
  return out;
}

}  // namespace

#define STBIW_ZLIB_COMPRESS compress_by_zlib
#endif

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
#include "lte/image/declared_size.h"

namespace lte::image {
namespace {

/// One filter for all rows, the difference to the row above: trying all five takes as long as the
/// compression and saves a twentieth of the bytes of rendered pictures.
constexpr int kUpFilter = 2;
[[maybe_unused]] const int g_filter = stbi_write_force_png_filter = kUpFilter;

struct StbFree {
  void operator()(void* pixels) const { stbi_image_free(pixels); }
};

void append(void* out, void* bytes, int size) {
  const auto* begin = static_cast<const unsigned char*>(bytes);
  static_cast<std::vector<unsigned char>*>(out)->insert(
      static_cast<std::vector<unsigned char>*>(out)->end(), begin, begin + size);
}

const unsigned char* bytes_of(std::string_view file) {
  return reinterpret_cast<const unsigned char*>(file.data());
}

int int_size(std::string_view file) {
  return static_cast<int>(std::min<size_t>(file.size(), std::numeric_limits<int>::max()));
}

unsigned char to_byte(float value) {
  if (!(value > 0)) return 0;  // NaN too
  return static_cast<unsigned char>(std::lround(255 * std::min(value, 1.0f)));
}

std::vector<unsigned char> encode(const std::vector<uint8_t>& bytes, int width, int height,
                                  int channels) {
  LTE_CHECK(static_cast<int64_t>(width) * height <= int64_t{1} << 28, "PNG: ", width, " x ", height,
            " pixels are too many");
  std::vector<unsigned char> png;
  const int written =
      stbi_write_png_to_func(append, &png, width, height, channels, bytes.data(), width * channels);
  LTE_CHECK(written != 0, "PNG: cannot encode ", width, " x ", height, " pixels");
  return png;
}

void write(const std::filesystem::path& path, const std::vector<unsigned char>& png) {
  AtomicFile file(path);
  file.write(png.data(), png.size());
  file.commit();
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

std::vector<uint8_t> to_bytes(const Image& display) {
  std::vector<uint8_t> bytes(display.pixels.size());
  std::transform(display.pixels.begin(), display.pixels.end(), bytes.begin(), to_byte);
  return bytes;
}

std::vector<unsigned char> encode_png(const Image& display) {
  LTE_CHECK(display.channels == 1 || display.channels == 3, "PNG: expected 1 or 3 channels, got ",
            display.channels);
  return encode(to_bytes(display), display.width, display.height, display.channels);
}

std::vector<unsigned char> encode_png(const DisplayPicture& picture) {
  return encode(picture.bytes, picture.width, picture.height, 3);
}

void write_png(const std::filesystem::path& path, const Image& display) {
  write(path, encode_png(display));
}

void write_png(const std::filesystem::path& path, const DisplayPicture& picture) {
  write(path, encode_png(picture));
}

Image read_png(const std::filesystem::path& path, int64_t limit_pixels) {
  return decode_png(read_file(path), path.string(), limit_pixels);
}

DeclaredSize declared_png_size(std::string_view file, const std::string& name) {
  const DeclaredSize declared = declared_size(file).value_or(DeclaredSize{});
  int width = 0, height = 0, channels = 0;
  if (stbi_info_from_memory(bytes_of(file), int_size(file), &width, &height, &channels) == 0) {
    const bool known = file.starts_with("\x89PNG") || file.starts_with("\xff\xd8\xff");
    if (known && declared.beyond_stb()) return declared;
    throw Error(
        concat(name, ": cannot decode: ", known ? "broken header" : "neither PNG nor JPEG"));
  }
  return {std::max<int64_t>(width, declared.width), std::max<int64_t>(height, declared.height)};
}

Image decode_png(std::string_view file, const std::string& name, int64_t limit_pixels) {
  // A small file may declare a huge picture: refuse before the decoder allocates it.
  const DeclaredSize declared = declared_png_size(file, name);
  LTE_CHECK(declared.width > 0 && declared.height > 0, name, ": cannot decode: broken header");
  LTE_CHECK(declared.width <= limit_pixels && declared.height <= limit_pixels / declared.width,
            name, ": ", declared.width, " x ", declared.height, " pixels exceed the limit of ",
            limit_pixels);
  const unsigned char* const bytes = bytes_of(file);
  const int size = int_size(file);
  int width = 0, height = 0, channels = 0;
  LTE_CHECK(stbi_info_from_memory(bytes, size, &width, &height, &channels) != 0, name,
            ": cannot decode: ", declared.width, " x ", declared.height, " pixels are too large");
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
