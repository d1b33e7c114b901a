// What a picture's header says of its size.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace lte::image {

struct DeclaredSize {
  int64_t width = 0, height = 0;

  /// Whether stb, which takes 2^30 bytes of up to four channels and sides of 2^24, may refuse it
  /// for its size alone. It gives no reason then.
  bool beyond_stb() const {
    constexpr int64_t kSide = int64_t{1} << 24, kPixels = int64_t{1} << 28;
    return width > kSide || height > kSide || (width > 0 && height > kPixels / width);
  }
};

/// The size in the header of a PNG or JPEG, whatever it is: decoders refuse large ones without a
/// word about their size.
/// @return  nothing for another format, a broken header, or a side of 0 or of 2^31 and more
std::optional<DeclaredSize> declared_size(std::string_view bytes);

}  // namespace lte::image
