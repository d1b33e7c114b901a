#include "lte/image/picture.h"

#include <bit>
#include <charconv>
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
#include "lte/image/exr.h"
#include "lte/image/png.h"

namespace lte::image {
namespace {

void check_size(const std::string& name, int64_t width, int64_t height, int64_t limit_pixels) {
  LTE_CHECK(width > 0 && height > 0, name, ": its header gives an empty picture");
  LTE_CHECK(width <= limit_pixels && height <= limit_pixels / width, name, ": ", width, " x ",
            height, " pixels exceed the limit of ", limit_pixels);
}

/// TGA as bytes, HDR as floats: `load` is stbi_load_from_memory or stbi_loadf_from_memory, `most`
/// what stands for 1.
template <typename Load>
Image decode(const std::string& name, std::string_view bytes, int64_t limit_pixels,
             const Load& load, float most) {
  LTE_CHECK(bytes.size() <= std::numeric_limits<int>::max(), name, ": ", bytes.size(),
            " bytes are too many for one picture");
  const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
  const int size = static_cast<int>(bytes.size());
  int width = 0, height = 0, channels = 0;
  LTE_CHECK(stbi_info_from_memory(data, size, &width, &height, &channels) != 0, name,
            ": broken picture header");
  check_size(name, width, height, limit_pixels);
  auto* const raw = load(data, size, &width, &height, &channels, 3);
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
  T value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  LTE_CHECK(error == std::errc() && end == word.data() + word.size(), name,
            ": broken PFM header: \"", word, "\" is no number");
  return value;
}

/// Portable float map: "PF" or "Pf", sizes, a scale whose sign tells the byte order, then rows from
/// the bottom up.
Image decode_pfm(const std::string& name, std::string_view bytes, int64_t limit_pixels) {
  size_t place = 0;
  const int channels = header_word(name, bytes, &place) == "PF" ? 3 : 1;
  const auto width = number<int>(name, header_word(name, bytes, &place));
  const auto height = number<int>(name, header_word(name, bytes, &place));
  const auto scale = number<double>(name, header_word(name, bytes, &place));
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

bool has_extension(const std::filesystem::path& path, std::string_view wanted) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension == wanted;
}

}  // namespace

Picture read_picture(const std::filesystem::path& path, int64_t limit_pixels) {
  const std::string name = path.string();
  const MappedFile file(path);
  const std::string_view bytes(reinterpret_cast<const char*>(file.data()), file.size());
  if (bytes.starts_with("\x89PNG") || bytes.starts_with("\xff\xd8"))
    return {read_png(path, limit_pixels), true};
  if (bytes.starts_with("\x76\x2f\x31\x01")) {
    Image image = read_exr(path);
    check_size(name, image.width, image.height, limit_pixels);
    return {std::move(image), false};
  }
  if (bytes.starts_with("PF") || bytes.starts_with("Pf"))
    return {decode_pfm(name, bytes, limit_pixels), false};
  if (bytes.starts_with("#?"))
    return {decode(name, bytes, limit_pixels, stbi_loadf_from_memory, 1), false};
  LTE_CHECK(has_extension(path, ".tga"), name,
            ": none of PNG, JPEG, TGA, OpenEXR, PFM and Radiance HDR");
  return {decode(name, bytes, limit_pixels, stbi_load_from_memory, 255), true};
}

}  // namespace lte::image
