// Reads the textures of lte/image/ktx2.h by the field offsets of the KTX 2.0 specification.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>

#include "lte/base/file.h"
#include "lte/base/half.h"
#include "lte/image/ktx2.h"

namespace lte::test {

inline Rgb from_rgb9e5(uint32_t word) {
  const float scale = std::ldexp(1.0f, static_cast<int>(word >> 27) - 24);
  const auto channel = [&](int shift) { return static_cast<float>(word >> shift & 511) * scale; };
  return {channel(0), channel(9), channel(18)};
}

inline image::Ktx2 read_ktx2(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  const auto word = [&](size_t at) {
    uint32_t value = 0;
    if (at + sizeof value <= bytes.size()) std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
  };
  image::Ktx2 out;
  out.format = word(12) == 123 ? image::Ktx2Format::Rgb9e5 : image::Ktx2Format::Rgba16f;
  out.width = static_cast<int>(word(20));
  out.height = static_cast<int>(word(24));
  out.depth = static_cast<int>(word(28));
  out.layers = static_cast<int>(word(32));
  const size_t first = word(80), size = word(88);
  for (size_t at = first; at < first + size;
       at += out.format == image::Ktx2Format::Rgb9e5 ? 4 : 8) {
    const uint32_t low = word(at), high = word(at + 4);
    const auto half = [](uint32_t bits) { return to_float(Half{static_cast<uint16_t>(bits)}); };
    out.texels.push_back(out.format == image::Ktx2Format::Rgb9e5
                             ? from_rgb9e5(low)
                             : Rgb{half(low), half(low >> 16), half(high)});
  }
  return out;
}

}  // namespace lte::test
