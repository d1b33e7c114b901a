#include "lte/image/picture.h"

#include <bit>
#include <cstring>
#include <limits>
#include <memory>
#include <string>
#include <string_view>

// Static, as another library of the program may carry its own copy. PNG and JPEG have their decoder
// in png.cpp.
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_TGA
#define STBI_ONLY_HDR
#define STBI_NO_STDIO
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_image.h>
#pragma GCC diagnostic pop

#include "lte/base/file.h"
#include "lte/base/text.h"
#include "lte/base/to_number.h"
#include "lte/image/exr.h"
#include "lte/image/png.h"

namespace lte::image {
namespace {

void check_size(const std::string& name, int64_t width, int64_t height, int64_t limit_pixels) {
  LTE_CHECK(width > 0 && height > 0, name, ": its header gives an empty picture");
  LTE_CHECK(width <= limit_pixels && height <= limit_pixels / width, name, ": ", width, " x ",
            height, " pixels exceed the limit of ", limit_pixels);
}

/// Size of a TGA or HDR.
DeclaredSize read_stb_size(const std::string& name, std::string_view bytes) {
  LTE_CHECK(bytes.size() <= std::numeric_limits<int>::max(), name, ": ", bytes.size(),
            " bytes are too many for one picture");
  int width = 0, height = 0, channels = 0;
  LTE_CHECK(stbi_info_from_memory(reinterpret_cast<const stbi_uc*>(bytes.data()),
                                  static_cast<int>(bytes.size()), &width, &height, &channels) != 0,
            name, ": broken picture header");
  return {width, height};
}

/// TGA as bytes, HDR as floats: `load` is stbi_load_from_memory or stbi_loadf_from_memory, `most`
/// what stands for 1.
template <typename Load>
Image decode(const std::string& name, std::string_view bytes, int64_t limit_pixels,
             const Load& load, float most) {
  const DeclaredSize declared = read_stb_size(name, bytes);
  check_size(name, declared.width, declared.height, limit_pixels);
  int width = 0, height = 0, channels = 0;
  auto* const raw = load(reinterpret_cast<const stbi_uc*>(bytes.data()),
                         static_cast<int>(bytes.size()), &width, &height, &channels, 3);
  const std::unique_ptr<void, void (*)(void*)> owner(raw, stbi_image_free);
  LTE_CHECK(raw != nullptr, name, ": cannot decode: ", stbi_failure_reason());
  Image image(width, height, 3);
  for (size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i] = static_cast<float>(raw[i]) / most;
  return image;
}

/// The next word of a PFM header, ended by exactly one white space.
std::string_view header_word(const std::string& name, std::string_view bytes, size_t* place) {
  const size_t begin = *place;
  while (*place < bytes.size() && std::strchr(" \t\r\n", bytes[*place]) == nullptr) ++*place;
  LTE_CHECK(*place < bytes.size() && *place > begin && *place - begin < 32, name,
            ": broken PFM header");
  return bytes.substr(begin, (*place)++ - begin);
}

template <typename T>
T number(const std::string& name, std::string_view word) {
  const auto value = to_number<T>(word);
  LTE_CHECK(value, name, ": broken PFM header: \"", word, "\" is no number");
  return *value;
}

/// What stands before the pixels of a portable float map: "PF" or "Pf", sizes, and a scale whose
/// sign tells the byte order.
struct PfmHeader {
  int channels = 0, width = 0, height = 0;
  double scale = 0;
  size_t bytes = 0;
};

PfmHeader read_pfm_header(const std::string& name, std::string_view bytes) {
  PfmHeader header;
  header.channels = header_word(name, bytes, &header.bytes) == "PF" ? 3 : 1;
  header.width = number<int>(name, header_word(name, bytes, &header.bytes));
  header.height = number<int>(name, header_word(name, bytes, &header.bytes));
  header.scale = number<double>(name, header_word(name, bytes, &header.bytes));
  return header;
}

/// Rows stand from the bottom up.
Image decode_pfm(const std::string& name, std::string_view bytes, int64_t limit_pixels) {
  const auto [channels, width, height, scale, place] = read_pfm_header(name, bytes);
  check_size(name, width, height, limit_pixels);
  const size_t row = static_cast<size_t>(width) * static_cast<size_t>(channels);
  const size_t wanted = row * static_cast<size_t>(height) * sizeof(float);
  LTE_CHECK(bytes.size() - place >= wanted, name, ": truncated PFM, ", wanted,
            " bytes of pixels expected, ", bytes.size() - place, " there");
  Image image(width, height, channels);
  for (int y = 0; y < height; ++y) {
    for (size_t i = 0; i < row; ++i) {
      uint32_t bits = 0;
      const size_t source = place + (static_cast<size_t>(height - 1 - y) * row + i) * sizeof(bits);
      std::memcpy(&bits, bytes.data() + source, sizeof(bits));
      if (scale > 0) bits = __builtin_bswap32(bits);  // positive: big-endian
      image.at(0, y)[i] = std::bit_cast<float>(bits);
    }
  }
  return image;
}

enum class Format { Coded, Exr, Pfm, Hdr, Tga };

Format format_of(const std::string& name, std::string_view bytes) {
  if (bytes.starts_with("\x89PNG") || bytes.starts_with("\xff\xd8")) return Format::Coded;
  if (bytes.starts_with("\x76\x2f\x31\x01")) return Format::Exr;
  if (bytes.starts_with("PF") || bytes.starts_with("Pf")) return Format::Pfm;
  if (bytes.starts_with("#?")) return Format::Hdr;
  LTE_CHECK(lower_case(name).ends_with(".tga"), name,
            ": none of PNG, JPEG, TGA, OpenEXR, PFM and Radiance HDR");
  return Format::Tga;
}

}  // namespace

Picture read_picture(const std::filesystem::path& path, int64_t limit_pixels) {
  const MappedFile file(path);
  return decode_picture({reinterpret_cast<const char*>(file.data()), file.size()}, path.string(),
                        limit_pixels);
}

Picture decode_picture(std::string_view bytes, const std::string& name, int64_t limit_pixels) {
  switch (format_of(name, bytes)) {
    case Format::Coded:
      return {decode_png(bytes, name, limit_pixels), true};
    case Format::Exr: {
      const DeclaredSize size = declared_exr_size(bytes, name);
      check_size(name, size.width, size.height, limit_pixels);
      return {decode_exr(bytes, name), false};
    }
    case Format::Pfm:
      return {decode_pfm(name, bytes, limit_pixels), false};
    case Format::Hdr:
      return {decode(name, bytes, limit_pixels, stbi_loadf_from_memory, 1), false};
    case Format::Tga:
      return {decode(name, bytes, limit_pixels, stbi_load_from_memory, 255), true};
  }
  return {};
}

DeclaredSize read_picture_size(std::string_view bytes, const std::string& name) {
  switch (format_of(name, bytes)) {
    case Format::Coded:
      return declared_png_size(bytes, name);
    case Format::Exr:
      return declared_exr_size(bytes, name);
    case Format::Pfm: {
      const PfmHeader header = read_pfm_header(name, bytes);
      check_size(name, header.width, header.height, std::numeric_limits<int64_t>::max());
      return {header.width, header.height};
    }
    case Format::Hdr:
    case Format::Tga:
      return read_stb_size(name, bytes);
  }
  return {};
}

}  // namespace lte::image
