#include "lte/bake/estimate.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "lte/base/parallel.h"
#include "lte/render/way_regression.h"

namespace lte::bake {
namespace {

/// Rounds of means over neighbours, wide to narrow; 0 is the texel alone.
constexpr std::array<int, 5> kRounds = {24, 10, 4, 1, 0};
/// Of the texels over which weights are estimated.
constexpr int kWeightRounds = 6;
/// One over the sum of a texel's squared weights after those rounds, where a texel and its
/// neighbours are kFlatNeighbours: 4 pi times the variance, of which a round adds two thirds.
constexpr float kFlatNeighbours = 9;
constexpr float kWeightTexels = 4 * kPi * kWeightRounds * 2 / 3;
/// Few bright paths make a way look right by chance: what the samples say of it counts as far as it
/// exceeds so many times its own variance, three standard errors.
constexpr float kDoubt = 9;
/// Samples of so many times the light that is expected, and that share of the mean light, are
/// peaks.
constexpr float kPeak = 3;
constexpr double kPeakFloor = 0.1;
constexpr int64_t kTexelGrain = 8192;

void for_texels(size_t count, const std::function<void(size_t)>& use) {
  parallel_for(static_cast<int64_t>(count), kTexelGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) use(static_cast<size_t>(i));
  });
}

/// render::error_weights() of the light that an estimate has found.
std::vector<float> weights_of(const Halves& estimate) {
  std::vector<float> light(estimate[0].size());
  for (size_t i = 0; i < light.size(); ++i)
    light[i] = luminance((estimate[0][i] + estimate[1][i]) * 0.5f);
  return render::error_weights(std::move(light));
}

/// Draws `estimate` towards `narrow`, of which each half comes from the same half of `samples`.
/// @param weight  of errors, weights_of()
/// @param doubt   kDoubt, or 0
void draw_towards(const TexelGraph& graph, const Halves& narrow, const Halves& samples,
                  const std::vector<float>& weight, float doubt, Halves* estimate) {
  const size_t count = samples[0].size();
  render::WayRegression regression(count);
  std::vector<float> square(doubt > 0 ? count : 0);
  for_texels(count, [&](size_t i) {
    for (size_t h = 0; h < 2; ++h) {
      const float before = regression.along[i];
      regression.add(i, weight[i], (*estimate)[h][i], narrow[h][i], samples[1 - h][i]);
      const float along = regression.along[i] - before;
      if (doubt > 0) square[i] += along * along;
    }
  });
  regression.spread(
      [&](std::vector<float> sum) { return graph.spread(std::move(sum), kWeightRounds); });
  // A kernel's square is a kernel of half its variance, times the sum of squared weights.
  if (doubt > 0) square = graph.spread(std::move(square), kWeightRounds / 2);
  for_texels(count, [&](size_t i) {
    if (doubt > 0) {
      const float inside = static_cast<float>(graph.neighbours(i).size() + 1) / kFlatNeighbours;
      const float texels = std::max(1.0f, kWeightTexels * inside);
      regression.shrink(i, doubt * square[i] / texels);
    }
    for (size_t h = 0; h < 2; ++h)
      (*estimate)[h][i] = regression.draw(i, (*estimate)[h][i], narrow[h][i]);
  });
}

/// Means of the samples over kRounds.
std::array<Halves, kRounds.size()> all_means(const TexelGraph& graph, const Halves& samples) {
  std::array<Halves, kRounds.size()> out;
  for (size_t h = 0; h < 2; ++h) {
    out.back()[h] = samples[h];
    for (size_t k = kRounds.size() - 1; k-- > 0;)
      out[k][h] = graph.spread(out[k + 1][h], kRounds[k] - kRounds[k + 1]);
  }
  return out;
}

/// Luminance that is expected of the samples of each half, with a share of the mean light.
using Expected = std::array<std::vector<float>, 2>;

void add_floor(Expected* expected) {
  double sum = 0;
  for (const std::vector<float>& half : *expected)
    for (const float value : half) sum += double{value};
  const auto points = static_cast<double>(2 * std::max<size_t>(1, (*expected)[0].size()));
  const auto dark = static_cast<float>(kPeakFloor * sum / points);
  for (std::vector<float>& half : *expected)
    for (float& value : half) value += dark;
}

/// Samples whose rare bright paths are spread over their surroundings: in a texel alone, they would
/// stay there as a spot. What surroundings of few texels would have beyond what is expected of them
/// is lost: it is not their light but that of all places that could have found it.
Halves without_peaks(const TexelGraph& graph, const Expected& expected, Halves samples) {
  for (size_t h = 0; h < 2; ++h) {
    std::vector<Rgb>& half = samples[h];
    std::vector<Rgb> excess(half.size());
    for_texels(half.size(), [&](size_t i) {
      const float light = luminance(half[i]), most = kPeak * expected[h][i];
      if (light <= most) return;
      excess[i] = half[i] * (1 - most / light);
      half[i] *= most / light;
    });
    excess = graph.spread(std::move(excess), kRounds.front());
    for_texels(half.size(), [&](size_t i) {
      const float light = luminance(excess[i]);
      half[i] += light <= expected[h][i] ? excess[i] : excess[i] * (expected[h][i] / light);
    });
  }
  return samples;
}

/// Of each half's samples, by the means of the other: light that is bright in a small place is so
/// in both.
Expected expected_by_other(const std::array<Halves, kRounds.size()>& means) {
  Expected out;
  for (size_t h = 0; h < 2; ++h) {
    out[h].resize(means[0][h].size());
    for_texels(out[h].size(), [&](size_t i) {
      for (const size_t k : {size_t{0}, kRounds.size() - 2, kRounds.size() - 1})
        out[h][i] = std::max(out[h][i], luminance(means[k][1 - h][i]));
    });
  }
  add_floor(&out);
  return out;
}

Expected expected_by(const Halves& estimate) {
  Expected out;
  out[0].resize(estimate[0].size());
  for_texels(out[0].size(),
             [&](size_t i) { out[0][i] = luminance((estimate[0][i] + estimate[1][i]) * 0.5f); });
  out[1] = out[0];
  add_floor(&out);
  return out;
}

}  // namespace

Halves smooth(const TexelGraph& graph, const Halves& found) {
  std::array<Halves, kRounds.size()> means = all_means(graph, found);
  const Halves samples = without_peaks(graph, expected_by_other(means), found);
  means = all_means(graph, samples);
  // Wide means would hide a dark place beside a bright one, where an error weighs most.
  const std::vector<float> weight = weights_of(means[kRounds.size() - 2]);
  Halves out = std::move(means[0]);
  for (size_t k = 1; k < means.size(); ++k) draw_towards(graph, means[k], samples, weight, 0, &out);
  return out;
}

Halves correct(const TexelGraph& graph, Halves estimate, const Halves& samples) {
  const Halves even = without_peaks(graph, expected_by(estimate), samples);
  // Peaks are held against the way as they were: what was spread is noise that texels share.
  for (const Halves& mean : all_means(graph, even))
    draw_towards(graph, mean, samples, weights_of(estimate), kDoubt, &estimate);
  return estimate;
}

double relative_error(const Halves& estimate) {
  double square = 0, light = 0;
  for (size_t i = 0; i < estimate[0].size(); ++i) {
    const double a = double{luminance(estimate[0][i])}, b = double{luminance(estimate[1][i])};
    square += (a - b) * (a - b) / 4;
    light += (a + b) * (a + b) / 4;
  }
  return light > 0 ? std::sqrt(square / light) : 0;
}

}  // namespace lte::bake
