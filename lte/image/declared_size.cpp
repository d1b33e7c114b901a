#include "lte/image/declared_size.h"

#include <cstddef>

namespace lte::image {
namespace {

/// A big-endian number of `count` bytes, all of which are there.
int64_t number(std::string_view bytes, size_t at, size_t count) {
  int64_t out = 0;
  for (size_t i = 0; i < count; ++i) out = out << 8 | static_cast<unsigned char>(bytes[at + i]);
  return out;
}

std::optional<DeclaredSize> checked(int64_t width, int64_t height) {
  constexpr int64_t kMax = (int64_t{1} << 31) - 1;  // of PNG; other formats have less
  if (width < 1 || height < 1 || width > kMax || height > kMax) return std::nullopt;
  return DeclaredSize{width, height};
}

/// Signature, length and name of the first chunk, then its width and height (PNG, section 11.2.2).
std::optional<DeclaredSize> png_size(std::string_view bytes) {
  if (bytes.size() < 24 || bytes.substr(12, 4) != "IHDR") return std::nullopt;
  return checked(number(bytes, 16, 4), number(bytes, 20, 4));
}

/// Whether a marker begins a frame: SOF0 to SOF15 but for DHT, JPG and DAC (T.81, table B.1).
bool begins_frame(unsigned char marker) {
  return marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
}

/// Segments of a marker and a length up to that of the frame: precision, height, width.
std::optional<DeclaredSize> jpeg_size(std::string_view bytes) {
  size_t at = 2;
  while (at + 4 <= bytes.size()) {
    if (bytes[at] != '\xff') return std::nullopt;
    const auto marker = static_cast<unsigned char>(bytes[at + 1]);
    if (marker == 0xff) {  // padding
      ++at;
      continue;
    }
    if (begins_frame(marker)) {
      if (at + 9 > bytes.size()) return std::nullopt;
      return checked(number(bytes, at + 7, 2), number(bytes, at + 5, 2));
    }
    const bool bare = marker == 0x01 || (marker >= 0xd0 && marker <= 0xd8);
    at += 2 + (bare ? 0 : static_cast<size_t>(number(bytes, at + 2, 2)));
  }
  return std::nullopt;
}

}  // namespace

std::optional<DeclaredSize> declared_size(std::string_view bytes) {
  if (bytes.starts_with("\x89PNG")) return png_size(bytes);
  if (bytes.starts_with("\xff\xd8")) return jpeg_size(bytes);
  return std::nullopt;
}

}  // namespace lte::image
