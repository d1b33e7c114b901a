#include "lte/scene/texture.h"

#include <array>
#include <cmath>
#include <utility>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

#include "lte/base/check.h"
#include "lte/image/tonemap.h"

namespace lte::scene {
namespace {

/// Three channels and one more, so that they are worked on at once.
using Float4 = float __attribute__((vector_size(16)));

/// Linear value of each 8-bit code.
const std::array<float, 256>& decode_table(bool srgb) {
  static const auto tables = [] {
    std::array<std::array<float, 256>, 2> out{};
    for (int code = 0; code < 256; ++code) {
      const float value = static_cast<float>(code) / 255.0f;
      out[0][code] = value;
      out[1][code] = image::srgb_to_linear(value);
    }
    return out;
  }();
  return tables[srgb ? 1 : 0];
}

/// The source texels under one texel of the next level, weighted by overlap: two for even sizes,
/// three for odd ones, so that the mean of a level is that of the picture.
struct Taps {
  int first = 0, count = 0;
  std::array<float, 4> weight{};
};

std::vector<Taps> box_taps(int from, int to) {
  std::vector<Taps> out(static_cast<size_t>(to));
  const double ratio = static_cast<double>(from) / to;
  for (int i = 0; i < to; ++i) {
    const double low = i * ratio, high = (i + 1) * ratio;
    Taps& taps = out[static_cast<size_t>(i)];
    taps.first = static_cast<int>(low);
    for (int x = taps.first; x < from && x < high && taps.count < 4; ++x) {
      const double overlap = std::min(high, x + 1.0) - std::max<double>(low, x);
      taps.weight[static_cast<size_t>(taps.count++)] = static_cast<float>(overlap / ratio);
    }
  }
  return out;
}

/// Halves a picture in both directions (a side of 1 stays). `read(x, y, c)` is the source.
template <typename Read>
std::vector<float> halve(int width, int height, int new_width, int new_height, const Read& read) {
  const std::vector<Taps> columns = box_taps(width, new_width), rows = box_taps(height, new_height);
  std::vector<float> out(static_cast<size_t>(new_width) * static_cast<size_t>(new_height) * 3);
  size_t next = 0;
  for (const Taps& row : rows) {
    for (const Taps& column : columns) {
      std::array<float, 3> sum{};
      for (int j = 0; j < row.count; ++j) {
        for (int i = 0; i < column.count; ++i) {
          const float weight =
              row.weight[static_cast<size_t>(j)] * column.weight[static_cast<size_t>(i)];
          for (int c = 0; c < 3; ++c) {
            sum[static_cast<size_t>(c)] += weight * read(column.first + i, row.first + j, c);
          }
        }
      }
      for (const float value : sum) out[next++] = value;
    }
  }
  return out;
}

/// With one more value, as look-ups read four at a time.
std::vector<uint16_t> to_fixed(const std::vector<float>& linear) {
  std::vector<uint16_t> out(linear.size() + 1);
  for (size_t i = 0; i < linear.size(); ++i) {
    out[i] = static_cast<uint16_t>(std::lround(std::clamp(linear[i], 0.0f, 1.0f) * 65535.0f));
  }
  return out;
}

Float4 from_fixed(const uint16_t* fixed) {
  constexpr float kScale = 1.0f / 65535.0f;
#if defined(__SSE2__)
  const __m128i four = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(fixed));
  return _mm_cvtepi32_ps(_mm_unpacklo_epi16(four, _mm_setzero_si128())) * kScale;
#else
  const auto value = [&](int k) { return static_cast<float>(fixed[k]); };
  return Float4{value(0), value(1), value(2), 0} * kScale;
#endif
}

/// std::floor(), which is a call on machines of the baseline. Floats from 2^23 on are whole.
float whole_below(float t) {
  if (!(std::fabs(t) < 0x1p23f)) return t;
  const auto towards_zero = static_cast<float>(static_cast<int>(t));
  return towards_zero > t ? towards_zero - 1 : towards_zero;
}

/// Folds a coordinate into one period, [0, 1]; anything that is not finite becomes 0.
float fold(float t, Wrap wrap) {
  if (!std::isfinite(t)) return 0;
  if (wrap == Wrap::ClampToEdge) return std::clamp(t, 0.0f, 1.0f);
  if (wrap == Wrap::Repeat) return t - whole_below(t);
  const float period = t - 2 * whole_below(t / 2);
  return period > 1 ? 2 - period : period;
}

/// A neighbour's index in [-1, size] brought into the picture. A mirrored edge meets itself, as a
/// clamped one does.
int fold_index(int i, int size, Wrap wrap) {
  if (wrap != Wrap::Repeat) return std::clamp(i, 0, size - 1);
  return i < 0 ? i + size : i >= size ? i - size : i;
}

}  // namespace

Texture::Texture(int width, int height, std::vector<uint8_t> texels, bool srgb)
    : srgb_(srgb), decode_(decode_table(srgb).data()) {
  LTE_CHECK(width > 0 && height > 0, "texture: size must be positive, got ", width, "x", height);
  LTE_CHECK(texels.size() == static_cast<size_t>(width) * static_cast<size_t>(height) * 3,
            "texture: expected 3 bytes for each of ", width, "x", height, " texels, got ",
            texels.size());
  levels_.push_back({width, height, std::move(texels), {}});
  const std::array<float, 256>& table = decode_table(srgb_);
  std::vector<float> linear;  // the last level before rounding, so that errors do not add up
  while (width > 1 || height > 1) {
    const int new_width = std::max(1, width / 2), new_height = std::max(1, height / 2);
    const auto index = [width](int x, int y, int c) {
      return (static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)) * 3 +
             static_cast<size_t>(c);
    };
    if (levels_.size() == 1) {
      const std::vector<uint8_t>& coded = levels_.front().coded;
      linear = halve(width, height, new_width, new_height,
                     [&](int x, int y, int c) { return table[coded[index(x, y, c)]]; });
    } else {
      linear = halve(width, height, new_width, new_height,
                     [&](int x, int y, int c) { return linear[index(x, y, c)]; });
    }
    width = new_width;
    height = new_height;
    levels_.push_back({width, height, {}, to_fixed(linear)});
  }
}

size_t Texture::size_bytes() const {
  size_t bytes = 0;
  for (const Level& level : levels_)
    bytes +=
        level.coded.size() + (level.half.empty() ? 0 : level.half.size() - 1) * sizeof(uint16_t);
  return bytes;
}

Rgb Texture::bilinear(const Level& level, const Vec2& uv, Wrap wrap_u, Wrap wrap_v) const {
  const float x = fold(uv.x, wrap_u) * static_cast<float>(level.width) - 0.5f;
  const float y = fold(uv.y, wrap_v) * static_cast<float>(level.height) - 0.5f;
  const float left = whole_below(x), top = whole_below(y);
  const float fx = x - left, fy = y - top;
  const int x0 = fold_index(static_cast<int>(left), level.width, wrap_u);
  const int x1 = fold_index(static_cast<int>(left) + 1, level.width, wrap_u);
  const int y0 = fold_index(static_cast<int>(top), level.height, wrap_v);
  const int y1 = fold_index(static_cast<int>(top) + 1, level.height, wrap_v);
  const auto blend = [&](const auto* texels, const auto& linear) {
    const auto texel = [&](int column, int row) {
      return linear(texels + 3 * (static_cast<size_t>(row) * static_cast<size_t>(level.width) +
                                  static_cast<size_t>(column)));
    };
    const Float4 out = (texel(x0, y0) * (1 - fx) + texel(x1, y0) * fx) * (1 - fy) +
                       (texel(x0, y1) * (1 - fx) + texel(x1, y1) * fx) * fy;
    return Rgb{out[0], out[1], out[2]};
  };
  if (level.half.empty()) {
    return blend(level.coded.data(), [this](const uint8_t* code) {
      return Float4{decode_[code[0]], decode_[code[1]], decode_[code[2]], 0};
    });
  }
  return blend(level.half.data(), [](const uint16_t* fixed) { return from_fixed(fixed); });
}

Rgb Texture::sample(const Vec2& uv, Wrap wrap_u, Wrap wrap_v, float footprint) const {
  if (!(footprint > 1) || levels_.size() == 1) return bilinear(levels_.front(), uv, wrap_u, wrap_v);
  const float coarsest = static_cast<float>(levels_.size() - 1);
  const float lod = std::min(std::log2(footprint), coarsest);
  const auto fine = static_cast<size_t>(lod);
  const float blend = lod - static_cast<float>(fine);
  const Rgb a = bilinear(levels_[fine], uv, wrap_u, wrap_v);
  return blend > 0 ? a * (1 - blend) + bilinear(levels_[fine + 1], uv, wrap_u, wrap_v) * blend : a;
}

}  // namespace lte::scene
