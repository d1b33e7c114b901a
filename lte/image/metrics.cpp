#include "lte/image/metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "lte/base/parallel.h"

namespace lte::image {
namespace {

constexpr double kMaxPsnr = 100;
constexpr int kRadius = 5;
constexpr int kWindow = 2 * kRadius + 1;

/// The mean of `term(a, b)` in double. Chunks have a fixed size and are added in order, so that the
/// bits are the same for any number of threads.
template <typename Term>
double mean_of(const char* what, std::span<const float> a, std::span<const float> b,
               const Term& term) {
  constexpr int64_t kChunk = 1 << 16;
  LTE_CHECK(a.size() == b.size(), what, ": sizes differ: ", a.size(), " and ", b.size());
  LTE_CHECK(!a.empty(), what, ": no values");
  const auto count = static_cast<int64_t>(a.size());
  std::vector<double> sums(static_cast<size_t>((count + kChunk - 1) / kChunk));
  parallel_for(count, kChunk, [&](int64_t begin, int64_t end) {
    double sum = 0;
    for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i)
      sum += term(a[i], b[i]);
    sums[static_cast<size_t>(begin / kChunk)] = sum;
  });
  return std::accumulate(sums.begin(), sums.end(), 0.0) / static_cast<double>(count);
}

double log1p_positive(double value) { return std::log1p(value < 0 ? 0 : value); }  // NaN stays

/// The 11 weights of the separable window; they sum to 1, so their products do too.
std::array<double, kWindow> gaussian() {
  constexpr double kSigma = 1.5;
  std::array<double, kWindow> weights{};
  for (int i = 0; i < kWindow; ++i) {
    const double x = (i - kRadius) / kSigma;
    weights[static_cast<size_t>(i)] = std::exp(-0.5 * x * x);
  }
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (double& weight : weights) weight /= sum;
  return weights;
}

/// Windowed means of a, b, a², b², ab.
using Moments = std::array<double, 5>;

double similarity(const Moments& m) {
  constexpr double kC1 = 0.01 * 0.01;
  constexpr double kC2 = 0.03 * 0.03;
  const double variance_a = m[2] - m[0] * m[0];
  const double variance_b = m[3] - m[1] * m[1];
  const double covariance = m[4] - m[0] * m[1];
  return (2 * m[0] * m[1] + kC1) * (2 * covariance + kC2) /
         ((m[0] * m[0] + m[1] * m[1] + kC1) * (variance_a + variance_b + kC2));
}

/// One channel of two pictures.
struct Plane {
  const Image& a;
  const Image& b;
  int channel;

  /// Moments over the row of the window that is centred at x.
  Moments row(int x, int y, const std::array<double, kWindow>& weights) const {
    Moments sum{};
    for (int k = 0; k < kWindow; ++k) {
      const double va = a.at(x + k - kRadius, y)[channel];
      const double vb = b.at(x + k - kRadius, y)[channel];
      const double weight = weights[static_cast<size_t>(k)];
      sum[0] += weight * va;
      sum[1] += weight * vb;
      sum[2] += weight * va * va;
      sum[3] += weight * vb * vb;
      sum[4] += weight * va * vb;
    }
    return sum;
  }
};

/// Sum and count of the similarity over the masked pixels of rows [begin, end).
std::pair<double, int64_t> sum_rows(const Plane& plane, int begin, int end,
                                    std::span<const uint8_t> mask) {
  static const std::array<double, kWindow> weights = gaussian();
  const int columns = plane.a.width - 2 * kRadius;
  std::vector<Moments> rows;
  rows.reserve(static_cast<size_t>(columns) * static_cast<size_t>(end - begin + 2 * kRadius));
  for (int y = begin - kRadius; y < end + kRadius; ++y) {
    for (int x = kRadius; x < kRadius + columns; ++x) rows.push_back(plane.row(x, y, weights));
  }
  double sum = 0;
  int64_t count = 0;
  for (int y = begin; y < end; ++y) {
    for (int column = 0; column < columns; ++column) {
      const size_t pixel = static_cast<size_t>(y) * static_cast<size_t>(plane.a.width) +
                           static_cast<size_t>(column + kRadius);
      if (!mask.empty() && mask[pixel] == 0) continue;
      Moments moments{};
      for (int k = 0; k < kWindow; ++k) {
        const Moments& part =
            rows[static_cast<size_t>(y - begin + k) * static_cast<size_t>(columns) +
                 static_cast<size_t>(column)];
        for (size_t m = 0; m < moments.size(); ++m)
          moments[m] += weights[static_cast<size_t>(k)] * part[m];
      }
      sum += similarity(moments);
      ++count;
    }
  }
  return {sum, count};
}

}  // namespace

double mse(std::span<const float> a, std::span<const float> reference) {
  return mean_of("MSE", a, reference, [](double x, double y) { return (x - y) * (x - y); });
}

double psnr(double mse, double peak) {
  LTE_CHECK(peak > 0, "PSNR: expected a positive peak, got ", peak);
  if (mse <= 0) return kMaxPsnr;
  return std::min(10 * std::log10(peak * peak / mse), kMaxPsnr);  // in this order NaN stays NaN
}

double relative_mse(std::span<const float> a, std::span<const float> reference, double epsilon) {
  return mean_of("relative MSE", a, reference,
                 [epsilon](double x, double y) { return (x - y) * (x - y) / (y * y + epsilon); });
}

double log_relative_l2(std::span<const float> a, std::span<const float> reference, double epsilon) {
  return mean_of("log-relative L2", a, reference, [epsilon](double x, double y) {
    const double log_y = log1p_positive(y);
    const double error = (log1p_positive(x) - log_y) / (log_y + epsilon);
    return error * error;
  });
}

double ssim(const Image& a, const Image& reference, std::span<const uint8_t> mask) {
  constexpr int kBand = 32;
  LTE_CHECK(a.width == reference.width && a.height == reference.height &&
                a.channels == reference.channels,
            "SSIM: sizes differ: ", a.width, " x ", a.height, " x ", a.channels, " and ",
            reference.width, " x ", reference.height, " x ", reference.channels);
  LTE_CHECK(a.width >= kWindow && a.height >= kWindow, "SSIM: expected at least ", kWindow,
            " pixels a side, got ", a.width, " x ", a.height);
  const size_t pixels = static_cast<size_t>(a.width) * static_cast<size_t>(a.height);
  LTE_CHECK(mask.empty() || mask.size() == pixels, "SSIM: expected a mask of ", pixels,
            " entries, got ", mask.size());
  const int rows = a.height - 2 * kRadius;
  const int bands = (rows + kBand - 1) / kBand;
  std::vector<std::pair<double, int64_t>> parts(static_cast<size_t>(bands) *
                                                static_cast<size_t>(a.channels));
  parallel_for(static_cast<int64_t>(parts.size()), 1, [&](int64_t part, int64_t) {
    const int begin = kRadius + static_cast<int>(part) % bands * kBand;
    const int end = std::min(begin + kBand, kRadius + rows);
    const Plane plane{a, reference, static_cast<int>(part) / bands};
    parts[static_cast<size_t>(part)] = sum_rows(plane, begin, end, mask);
  });
  double sum = 0;
  int64_t count = 0;
  for (const auto& [part_sum, part_count] : parts) {
    sum += part_sum;
    count += part_count;
  }
  return count > 0 ? sum / static_cast<double>(count) : 1;
}

}  // namespace lte::image
