#include "infer/eval/measure/scores.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "lte/base/check.h"
#include "lte/image/flip.h"
#include "lte/image/metrics.h"
#include "lte/image/tonemap.h"
#include "lte/runtime/points.h"

namespace lte::infer {
namespace {

constexpr double kWhitePercentile = 0.99;

/// PSNR with the reference's 99th percentile as white.
double exposed_psnr(double mse, std::span<const Rgb> reference) {
  return image::psnr(mse, 1 / white_exposure(reference));
}

/// FLIP clamps to [0, 1] and encodes by itself.
image::Image exposed(image::Image linear, float exposure) {
  for (float& value : linear.pixels) value *= exposure;
  return linear;
}

Scores combine(const std::vector<Scores>& scenes,
               const std::function<double(std::vector<double>)>& statistic) {
  Scores out;
  if (scenes.empty()) return out;
  for (const auto& entry : scenes.front()) {
    const std::string& name = entry.first;
    const auto has_it = [&](const Scores& scores) { return find_score(scores, name) != nullptr; };
    if (!std::all_of(scenes.begin(), scenes.end(), has_it)) continue;
    Score score;
    const auto over_scenes = [&](auto member, size_t metric) {
      std::vector<double> values;
      for (const Scores& scene : scenes) {
        const Score* const found = find_score(scene, name);
        if (found && std::isfinite((found->*member)[metric]))
          values.push_back((found->*member)[metric]);
      }
      return values.empty() ? kMissing : statistic(values);
    };
    for (size_t k = 0; k < kPointMetrics.size(); ++k)
      score.points[k] = over_scenes(&Score::points, k);
    for (size_t k = 0; k < kViewMetrics.size(); ++k) score.views[k] = over_scenes(&Score::views, k);
    out.emplace_back(name, score);
  }
  return out;
}

}  // namespace

const Score* find_score(const Scores& scores, const std::string& name) {
  for (const auto& [predictor, score] : scores) {
    if (predictor == name) return &score;
  }
  return nullptr;
}

double mean_of(std::span<const double> values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

double median_of(std::vector<double> values) {
  if (values.empty()) return kMissing;
  const auto half = static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), values.begin() + half, values.end());
  const double upper = values[static_cast<size_t>(half)];
  if (values.size() % 2) return upper;
  return 0.5 * (*std::max_element(values.begin(), values.begin() + half) + upper);
}

Score::Score() {
  points.fill(kMissing);
  views.fill(kMissing);
}

double white_exposure(std::span<const Rgb> reference) {
  if (reference.empty()) return 1;
  std::vector<float> values;
  values.reserve(reference.size());
  for (const Rgb& value : reference) values.push_back(luminance(value));
  const auto rank =
      static_cast<std::ptrdiff_t>(kWhitePercentile * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  const double white = values[static_cast<size_t>(rank)];
  return white > 0 ? 1 / white : 1;
}

PointScore score_points(std::span<const Rgb> prediction, std::span<const Rgb> reference) {
  LTE_CHECK(prediction.size() == reference.size(), "scores: ", prediction.size(),
            " predictions for ", reference.size(), " references");
  if (reference.empty()) return Score().points;
  const std::span<const float> a = runtime::floats(prediction), b = runtime::floats(reference);
  const double mse = image::mse(a, b);
  return {mse, exposed_psnr(mse, reference), image::relative_mse(a, b),
          image::log_relative_l2(a, b)};
}

image::Image fill_mask(std::span<const Rgb> values, std::span<const uint8_t> mask, int width,
                       int height) {
  image::Image out(width, height, 3);
  size_t next = 0;
  for (size_t i = 0; i < mask.size(); ++i) {
    if (mask[i]) out.set_rgb(i, values[next++]);
  }
  return out;
}

ViewScore score_view(std::span<const Rgb> prediction, std::span<const Rgb> reference,
                     std::span<const Rgb> seen, std::span<const uint8_t> mask, int width,
                     int height) {
  const PointScore points = score_points(prediction, reference);
  if (reference.empty()) return Score().views;
  const auto exposure = static_cast<float>(white_exposure(reference));
  const image::Image a = fill_mask(prediction, mask, width, height);
  const image::Image b = fill_mask(seen, mask, width, height);
  const double ssim = image::ssim(image::tonemap(a, exposure), image::tonemap(b, exposure), mask);
  const double ldr =
      image::masked_mean(image::flip(exposed(a, exposure), exposed(b, exposure)), mask);
  const double hdr =
      image::masked_mean(image::hdr_flip(a, b, image::flip_exposures(b, mask)), mask);
  return {points[0], points[1], ssim, points[2], ldr, hdr};
}

Scores mean_scores(const std::vector<Scores>& scenes) { return combine(scenes, mean_of); }
Scores median_scores(const std::vector<Scores>& scenes) { return combine(scenes, median_of); }

}  // namespace lte::infer
