#include "lte/image/ktx2.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <string>
#include <string_view>

#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/image/finite_half.h"

// Fields are little-endian and copied as they are in memory.
static_assert(std::endian::native == std::endian::little);

namespace lte::image {
namespace {

constexpr std::string_view kIdentifier("\xABKTX 20\xBB\r\n\x1A\n", 12);
constexpr size_t kHeader = 80, kLevelIndex = 24;
constexpr int64_t kMaxTexels = int64_t{1} << 28;
constexpr int kMaxSide = 1 << 20;

constexpr int kMantissaBits = 9, kExponentBias = 15;
constexpr float kMaxRgb9e5 = 65408;

/// The file's first 80 bytes, in its order.
struct Header {
  std::array<char, 12> identifier;
  uint32_t vk_format, type_size, width, height, depth, layers, faces, levels, supercompression;
  uint32_t dfd_offset, dfd_size, kvd_offset, kvd_size;
  uint64_t sgd_offset, sgd_size;
};
static_assert(sizeof(Header) == kHeader);

/// Where the only level lies.
struct Level {
  uint64_t offset, size, uncompressed_size;
};
static_assert(sizeof(Level) == kLevelIndex);

struct Layout {
  Ktx2Format format;
  uint32_t vk_format, type_size, texel_size;
};
constexpr std::array<Layout, 2> kLayouts{
    {{Ktx2Format::Rgb9e5, 123, 4, 4}, {Ktx2Format::Rgba16f, 97, 2, 8}}};

const Layout& layout_of(Ktx2Format format) {
  return *std::find_if(kLayouts.begin(), kLayouts.end(),
                       [&](const Layout& layout) { return layout.format == format; });
}

void append_words(std::initializer_list<uint32_t> words, std::string* out) {
  for (const uint32_t word : words) out->append(reinterpret_cast<const char*>(&word), sizeof(word));
}

/// A sample of the basic descriptor block: bits, channel with its qualifiers, and range.
void append_sample(uint32_t offset, uint32_t bits, uint32_t channel, uint32_t lower, uint32_t upper,
                   std::string* out) {
  append_words({offset | (bits - 1) << 16 | channel << 24, 0, lower, upper}, out);
}

/// The data format descriptor: one basic block of Khronos' Data Format 1.3.
std::string descriptor(const Layout& layout) {
  constexpr uint32_t kRgbsda = 1, kBt709 = 1, kLinear = 1, kVersion = 2;
  constexpr uint32_t kExponent = 0x20, kSigned = 0x40, kFloat = 0x80, kAlpha = 15;
  const bool shared = layout.format == Ktx2Format::Rgb9e5;
  const uint32_t samples = shared ? 6 : 4, block = 24 + 16 * samples;
  std::string out;
  append_words({4 + block, 0, kVersion | block << 16, kRgbsda | kBt709 << 8 | kLinear << 16, 0,
                layout.texel_size, 0},
               &out);
  if (shared) {
    // A mantissa of 8448 = 33 · 2^8 is 1 at the exponent 15, where the shared exponent counts from.
    for (uint32_t channel = 0; channel < 3; ++channel) {
      append_sample(9 * channel, 9, channel, 0, 8448, &out);
      append_sample(27, 5, channel | kExponent, 15, 31, &out);
    }
    return out;
  }
  for (uint32_t channel = 0; channel < 4; ++channel) {
    append_sample(16 * channel, 16, (channel < 3 ? channel : kAlpha) | kSigned | kFloat,
                  std::bit_cast<uint32_t>(-1.0f), std::bit_cast<uint32_t>(1.0f), &out);
  }
  return out;
}

void append_key(const std::string& key, const std::string& value, std::string* out) {
  append_words({static_cast<uint32_t>(key.size() + value.size() + 2)}, out);
  out->append(key).push_back('\0');
  out->append(value).push_back('\0');
  out->resize((out->size() + 3) / 4 * 4);
}

/// Rows run right and down, slices away from the first.
std::string keys(const Ktx2& texture) {
  std::string out;
  append_key("KTXorientation", texture.depth > 0 ? "rdi" : "rd", &out);
  append_key("KTXwriter", "lte", &out);
  return out;
}

int64_t texel_count(const Ktx2& texture) {
  return int64_t{texture.width} * texture.height * std::max({texture.layers, texture.depth, 1});
}

void check_shape(const std::string& name, const Ktx2& texture) {
  LTE_CHECK(
      texture.width > 0 && texture.height > 0 && texture.depth >= 0 && texture.layers >= 0 &&
          (texture.depth == 0 || texture.layers == 0) &&
          std::max({texture.width, texture.height, texture.depth, texture.layers}) <= kMaxSide &&
          texel_count(texture) <= kMaxTexels,
      name, ": not a texture of at most ", kMaxTexels, " texels: ", texture.width, " x ",
      texture.height, ", depth ", texture.depth, ", layers ", texture.layers);
}

void append_texel(const Rgb& color, Ktx2Format format, std::string* out) {
  if (format == Ktx2Format::Rgb9e5) return append_words({to_rgb9e5(color)}, out);
  std::array<Half, 4> halves;
  for (int i = 0; i < 3; ++i) halves[static_cast<size_t>(i)] = to_finite_half(color[i]);
  halves[3] = to_half(1);
  out->append(reinterpret_cast<const char*>(halves.data()), sizeof(halves));
}

}  // namespace

uint32_t to_rgb9e5(const Rgb& color) {
  std::array<float, 3> clamped;
  for (int i = 0; i < 3; ++i)
    clamped[static_cast<size_t>(i)] = std::clamp(color[i], 0.0f, kMaxRgb9e5);
  const float largest = *std::max_element(clamped.begin(), clamped.end());
  const auto mantissa = [](float value, int exponent) {
    return static_cast<uint32_t>(
        std::floor(std::ldexp(value, kExponentBias + kMantissaBits - exponent) + 0.5f));
  };
  int exponent = 0;
  if (largest > 0) exponent = std::max(-kExponentBias - 1, std::ilogb(largest)) + 1 + kExponentBias;
  if (mantissa(largest, exponent) == 1u << kMantissaBits) ++exponent;
  return mantissa(clamped[0], exponent) | mantissa(clamped[1], exponent) << 9 |
         mantissa(clamped[2], exponent) << 18 | static_cast<uint32_t>(exponent) << 27;
}

void write_ktx2(const std::filesystem::path& path, const Ktx2& texture) {
  const std::string name = path.string();
  check_shape(name, texture);
  LTE_CHECK(texel_count(texture) == static_cast<int64_t>(texture.texels.size()), name,
            ": expected ", texel_count(texture), " texels, got ", texture.texels.size());
  const Layout& layout = layout_of(texture.format);
  const std::string dfd = descriptor(layout), kvd = keys(texture);
  Header header{};
  std::copy(kIdentifier.begin(), kIdentifier.end(), header.identifier.begin());
  header.vk_format = layout.vk_format;
  header.type_size = layout.type_size;
  header.width = static_cast<uint32_t>(texture.width);
  header.height = static_cast<uint32_t>(texture.height);
  header.depth = static_cast<uint32_t>(texture.depth);
  header.layers = static_cast<uint32_t>(texture.layers);
  header.faces = header.levels = 1;
  header.dfd_offset = kHeader + kLevelIndex;
  header.dfd_size = static_cast<uint32_t>(dfd.size());
  header.kvd_offset = header.dfd_offset + header.dfd_size;
  header.kvd_size = static_cast<uint32_t>(kvd.size());
  Level level{};
  level.offset = (header.kvd_offset + header.kvd_size + 7) / 8 * 8;
  level.size = level.uncompressed_size = texture.texels.size() * layout.texel_size;
  std::string bytes;
  bytes.reserve(level.offset + level.size);
  bytes.append(reinterpret_cast<const char*>(&header), kHeader);
  bytes.append(reinterpret_cast<const char*>(&level), kLevelIndex);
  bytes += dfd + kvd;
  bytes.resize(level.offset);
  for (size_t i = 0; i < texture.texels.size(); ++i) {
    LTE_CHECK(is_finite(texture.texels[i]), name, ": texel ", i, " is not finite");
    append_texel(texture.texels[i], texture.format, &bytes);
  }
  write_file(path, bytes);
}

}  // namespace lte::image
