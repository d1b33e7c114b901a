#include "lte/image/flip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "lte/base/parallel.h"

namespace lte::image {
namespace {

using Color = std::array<double, 3>;

constexpr double kPi = std::numbers::pi;
constexpr double kColorExponent = 0.7;    // q_c
constexpr double kSmallShare = 0.4;       // p_c: of the largest color difference, what maps to...
constexpr double kSmallError = 0.95;      // p_t
constexpr double kFeatureExponent = 0.5;  // q_f
constexpr double kFeatureWidth = 0.082;   // w, degrees

/// Linear Rec.709 to CIE XYZ, in the fractions that FLIP's authors use: white is the sum of a row.
constexpr std::array<Color, 3> kToXyz{
    {{10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794},
     {2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897},
     {1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382}}};

Color white() {
  Color out{};
  for (size_t i = 0; i < 3; ++i) out[i] = kToXyz[i][0] + kToXyz[i][1] + kToXyz[i][2];
  return out;
}
const Color kWhite = white();

Color times(const std::array<Color, 3>& matrix, const Color& v) {
  Color out{};
  for (size_t i = 0; i < 3; ++i)
    out[i] = matrix[i][0] * v[0] + matrix[i][1] * v[1] + matrix[i][2] * v[2];
  return out;
}

std::array<Color, 3> inverse(const std::array<Color, 3>& m) {
  std::array<Color, 3> out{};
  double determinant = 0;
  for (size_t i = 0; i < 3; ++i) {
    for (size_t j = 0; j < 3; ++j) {
      const size_t i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      out[j][i] = m[i1][j1] * m[i2][j2] - m[i1][j2] * m[i2][j1];
    }
    determinant += m[0][i] * out[i][0];
  }
  for (Color& row : out)
    for (double& value : row) value /= determinant;
  return out;
}
const std::array<Color, 3> kFromXyz = inverse(kToXyz);

/// The opponent space that the eye's contrast sensitivity is known in.
Color to_ycxcz(const Color& linear) {
  Color n = times(kToXyz, linear);
  for (size_t i = 0; i < 3; ++i) n[i] /= kWhite[i];
  return {116 * n[1] - 16, 500 * (n[0] - n[1]), 200 * (n[1] - n[2])};
}

Color from_ycxcz(const Color& c) {
  const double y = (c[0] + 16) / 116;
  return times(kFromXyz,
               {kWhite[0] * (y + c[1] / 500), kWhite[1] * y, kWhite[2] * (y - c[2] / 200)});
}

/// CIELAB with the chroma scaled by lightness: colors differ less in the dark (Hunt).
Color to_hunt_lab(const Color& linear) {
  constexpr double kDelta = 6.0 / 29;
  Color f = times(kToXyz, linear);
  for (size_t i = 0; i < 3; ++i) {
    const double t = f[i] / kWhite[i];
    f[i] = t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3 * kDelta * kDelta) + 4.0 / 29;
  }
  const double lightness = 116 * f[1] - 16;
  return {lightness, 0.01 * lightness * 500 * (f[0] - f[1]),
          0.01 * lightness * 200 * (f[1] - f[2])};
}

double hyab(const Color& a, const Color& b) {
  return std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]);
}

/// A one-dimensional filter from −radius to radius.
using Taps = std::vector<double>;
/// One channel of a picture.
using Plane = std::vector<double>;

template <typename Weight>
Taps taps(int radius, const Weight& weight) {
  Taps out;
  for (int i = -radius; i <= radius; ++i) out.push_back(weight(static_cast<double>(i)));
  return out;
}

/// Rows filtered by `across`, columns by `down`; both have the same radius.
Plane filtered(const Plane& in, int width, int height, const Taps& across, const Taps& down) {
  const int radius = static_cast<int>(across.size()) / 2;
  Plane rows(in.size()), out(in.size());
  const auto pass = [&](const Plane& from, const Taps& weights, int dx, int dy, Plane* to) {
    parallel_for(height, 8, [&](int64_t begin, int64_t end) {
      for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
        for (int x = 0; x < width; ++x) {
          double sum = 0;
          for (int k = -radius; k <= radius; ++k) {
            const int sx = std::clamp(x + k * dx, 0, width - 1);
            const int sy = std::clamp(y + k * dy, 0, height - 1);
            sum += weights[static_cast<size_t>(k + radius)] *
                   from[static_cast<size_t>(sy) * static_cast<size_t>(width) +
                        static_cast<size_t>(sx)];
          }
          (*to)[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)] = sum;
        }
      }
    });
  };
  pass(in, across, 1, 0, &rows);
  pass(rows, down, 0, 1, &out);
  return out;
}

/// A contrast sensitivity function: a sum of Gaussians, each a·√(π/b)·exp(−π² d² / b) at d degrees.
struct Sensitivity {
  double a, b;
};
constexpr Sensitivity kAchromatic{1, 0.0047}, kRedGreen{1, 0.0053};
constexpr std::array<Sensitivity, 2> kBlueYellow{{{34.1, 0.04}, {13.5, 0.025}}};

/// Low-pass filters of the three channels, scaled to keep a constant picture as it is.
class EyeFilter {
 public:
  explicit EyeFilter(double pixels_per_degree)
      : step_(1 / pixels_per_degree),
        // Three standard deviations of the widest of the Gaussians.
        radius_(static_cast<int>(
            std::ceil(3 * std::sqrt(kBlueYellow[0].b / (2 * kPi * kPi)) * pixels_per_degree))) {}

  Plane apply(const Plane& in, int width, int height, size_t channel) const {
    if (channel == 0) return gaussian(in, width, height, kAchromatic.b);
    if (channel == 1) return gaussian(in, width, height, kRedGreen.b);
    double total = 0;
    Plane out(in.size(), 0.0);
    for (const Sensitivity& part : kBlueYellow) {
      const double weight = part.a * std::sqrt(kPi / part.b) * square_sum(part.b);
      const Plane blurred = gaussian(in, width, height, part.b);
      for (size_t i = 0; i < out.size(); ++i) out[i] += weight * blurred[i];
      total += weight;
    }
    for (double& value : out) value /= total;
    return out;
  }

 private:
  Taps bare(double b) const {
    return taps(radius_,
                [&](double i) { return std::exp(-kPi * kPi * i * step_ * i * step_ / b); });
  }
  /// Sum of the two-dimensional kernel.
  double square_sum(double b) const {
    double sum = 0;
    for (const double value : bare(b)) sum += value;
    return sum * sum;
  }
  Plane gaussian(const Plane& in, int width, int height, double b) const {
    Taps weights = bare(b);
    double sum = 0;
    for (const double value : weights) sum += value;
    for (double& value : weights) value /= sum;
    return filtered(in, width, height, weights, weights);
  }

  double step_;
  int radius_;
};

/// First (edges) or second (points) derivative of a Gaussian, its positive weights scaled to a sum
/// of 1 and its negative ones to −1.
Taps derivative(int order, double sigma, int radius) {
  Taps out = taps(radius, [&](double x) {
    const double gaussian = std::exp(-x * x / (2 * sigma * sigma));
    return order == 1 ? -x * gaussian : (x * x / (sigma * sigma) - 1) * gaussian;
  });
  double positive = 0, negative = 0;
  for (const double value : out) (value > 0 ? positive : negative) += value;
  for (double& value : out) value /= value > 0 ? positive : -negative;
  return out;
}

/// Strength of edges or points of an achromatic plane in [0, 1].
Plane features(const Plane& y, int width, int height, int order, double pixels_per_degree) {
  const double sigma = 0.5 * kFeatureWidth * pixels_per_degree;
  const int radius = static_cast<int>(std::ceil(3 * sigma));
  const Taps change = derivative(order, sigma, radius);
  Taps smooth = taps(radius, [&](double x) { return std::exp(-x * x / (2 * sigma * sigma)); });
  double sum = 0;
  for (const double value : smooth) sum += value;
  for (double& value : smooth) value /= sum;
  Plane out = filtered(y, width, height, change, smooth);
  const Plane down = filtered(y, width, height, smooth, change);
  for (size_t i = 0; i < out.size(); ++i) out[i] = std::hypot(out[i], down[i]);
  return out;
}

/// A picture as the two pipelines of FLIP see it.
struct Seen {
  std::vector<Color> color;  ///< what the eye resolves, in Hunt-adjusted CIELAB
  Plane edges, points;

  Seen(const Image& linear, double pixels_per_degree) {
    const int width = linear.width, height = linear.height;
    const auto pixels = static_cast<size_t>(width) * static_cast<size_t>(height);
    std::array<Plane, 3> planes;
    for (Plane& plane : planes) plane.resize(pixels);
    for (size_t i = 0; i < pixels; ++i) {
      Color c{};
      for (size_t k = 0; k < 3; ++k) {
        const float value = linear.pixels[3 * i + k];
        c[k] = value > 0 ? std::min(double{value}, 1.0) : 0;  // NaN is black
      }
      c = to_ycxcz(c);
      for (size_t k = 0; k < 3; ++k) planes[k][i] = c[k];
    }
    Plane achromatic(pixels);
    for (size_t i = 0; i < pixels; ++i) achromatic[i] = (planes[0][i] + 16) / 116;
    edges = features(achromatic, width, height, 1, pixels_per_degree);
    points = features(achromatic, width, height, 2, pixels_per_degree);
    const EyeFilter filter(pixels_per_degree);
    for (size_t k = 0; k < 3; ++k) planes[k] = filter.apply(planes[k], width, height, k);
    color.resize(pixels);
    for (size_t i = 0; i < pixels; ++i) {
      Color c = from_ycxcz({planes[0][i], planes[1][i], planes[2][i]});
      for (double& value : c) value = std::clamp(value, 0.0, 1.0);
      color[i] = to_hunt_lab(c);
    }
  }
};

/// The color difference in [0, 1], differences beyond `kSmallShare` of the largest compressed.
double redistribute(double difference, double largest) {
  const double error = std::pow(difference, kColorExponent);
  const double small = kSmallShare * largest;
  return error < small ? kSmallError / small * error
                       : kSmallError + (error - small) / (largest - small) * (1 - kSmallError);
}

void check_pair(const Image& a, const Image& reference, double pixels_per_degree) {
  LTE_CHECK(a.width == reference.width && a.height == reference.height,
            "FLIP: sizes differ: ", a.width, " x ", a.height, " and ", reference.width, " x ",
            reference.height);
  LTE_CHECK(a.channels == 3 && reference.channels == 3, "FLIP: expected 3 channels, got ",
            a.channels, " and ", reference.channels);
  LTE_CHECK(pixels_per_degree > 0, "FLIP: expected positive pixels per degree, got ",
            pixels_per_degree);
}

}  // namespace

Image flip(const Image& a, const Image& reference, double pixels_per_degree) {
  check_pair(a, reference, pixels_per_degree);
  const Seen test(a, pixels_per_degree), wanted(reference, pixels_per_degree);
  const double largest =
      std::pow(hyab(to_hunt_lab({0, 1, 0}), to_hunt_lab({0, 0, 1})), kColorExponent);
  Image out(a.width, a.height, 1);
  for (size_t i = 0; i < out.pixels.size(); ++i) {
    const double color = redistribute(hyab(test.color[i], wanted.color[i]), largest);
    const double feature = std::max(std::abs(test.edges[i] - wanted.edges[i]),
                                    std::abs(test.points[i] - wanted.points[i]));
    const double weight = std::pow(feature / std::numbers::sqrt2, kFeatureExponent);
    out.pixels[i] = static_cast<float>(std::pow(color, 1 - weight));
  }
  return out;
}

double masked_mean(const Image& scalar, std::span<const uint8_t> mask) {
  double sum = 0;
  size_t count = 0;
  for (size_t i = 0; i < scalar.pixels.size(); ++i) {
    if (!mask.empty() && mask[i] == 0) continue;
    sum += scalar.pixels[i];
    ++count;
  }
  return count > 0 ? sum / static_cast<double>(count) : 0;
}

}  // namespace lte::image
