#include "lte/bake/estimate.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>
#include <utility>

#include "lte/base/parallel.h"
#include "lte/render/way_regression.h"

namespace lte::bake {
namespace {

/// Rounds of means over neighbours, wide to narrow; 0 is the texel alone.
constexpr std::array<int, 5> kRounds = {24, 10, 4, 1, 0};
/// Of what a denoiser has left: wide for levels that it has lost, narrow where charts part.
constexpr std::array<int, 2> kRoundsAfterDenoising = {24, 4};
/// Of the texels over which weights are estimated.
constexpr int kWeightRounds = 12;
/// One over the sum of a texel's squared weights after those rounds, where a texel and its
/// neighbours are kFlatNeighbours: 4 pi times the variance, of which a round adds two thirds.
constexpr float kFlatNeighbours = 9;
constexpr float kWeightTexels = 4 * kPi * kWeightRounds * 2 / 3;
/// Chance makes a way look right: what the samples say of it counts as far as it exceeds so many
/// times its own variance. Of few bright paths that is three standard errors.
constexpr float kDoubt = 1, kDoubtOfPaths = 9;
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
/// @param doubt   kDoubt or kDoubtOfPaths
void draw_towards(const TexelGraph& graph, const Halves& narrow, const Halves& samples,
                  const std::vector<float>& weight, float doubt, Halves* estimate) {
  const size_t count = samples[0].size();
  render::WayRegression regression(count);
  std::vector<float> square(count);
  for_texels(count, [&](size_t i) {
    for (size_t h = 0; h < 2; ++h) {
      const float before = regression.along[i];
      regression.add(i, weight[i], (*estimate)[h][i], narrow[h][i], samples[1 - h][i]);
      const float along = regression.along[i] - before;
      square[i] += along * along;
    }
  });
  regression.spread(
      [&](std::vector<float> sum) { return graph.spread(std::move(sum), kWeightRounds); });
  // A kernel's square is a kernel of half its variance, times the sum of squared weights.
  square = graph.spread(std::move(square), kWeightRounds / 2);
  for_texels(count, [&](size_t i) {
    const float inside = static_cast<float>(graph.neighbours(i).size() + 1) / kFlatNeighbours;
    const float texels = std::max(1.0f, kWeightTexels * inside);
    regression.shrink(i, doubt * square[i] / texels);
    for (size_t h = 0; h < 2; ++h)
      (*estimate)[h][i] = regression.draw(i, (*estimate)[h][i], narrow[h][i]);
  });
}

Halves means(const TexelGraph& graph, const Halves& samples, int rounds) {
  return {graph.spread(samples[0], rounds), graph.spread(samples[1], rounds)};
}

/// The estimate and a mean of what it lacks: unlike a mean of the samples it keeps what the
/// estimate knows in finer detail, and does not lean inwards at the ends of surfaces (Tukey's
/// twicing).
Halves with_mean_of_rest(const TexelGraph& graph, const Halves& samples, const Halves& estimate,
                         int rounds) {
  Halves out;
  for (size_t h = 0; h < 2; ++h) {
    std::vector<Rgb> rest(samples[h].size());
    for_texels(rest.size(), [&](size_t i) { rest[i] = samples[h][i] - estimate[h][i]; });
    out[h] = graph.spread(std::move(rest), rounds);
    for_texels(out[h].size(), [&](size_t i) { out[h][i] += estimate[h][i]; });
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

/// Of each half's samples, by those and the means of the other: light that is bright in a small
/// place is so in both.
Expected expected_by_other(const std::array<const Halves*, 3>& found) {
  Expected out;
  for (size_t h = 0; h < 2; ++h) {
    out[h].resize((*found[0])[h].size());
    for_texels(out[h].size(), [&](size_t i) {
      for (const Halves* mean : found)
        out[h][i] = std::max(out[h][i], luminance((*mean)[1 - h][i]));
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

Halves smooth(const TexelGraph& graph, const Halves& found, const Denoise& denoise) {
  const auto wider = [&](const Halves& narrow) { return means(graph, narrow, kRounds[0] - 1); };
  Halves narrow = means(graph, found, 1), wide = wider(narrow);
  const Halves samples = without_peaks(graph, expected_by_other({&found, &narrow, &wide}), found);
  narrow = means(graph, samples, 1);
  wide = wider(narrow);
  // Wide means would hide a dark place beside a bright one, where an error weighs most.
  const std::vector<float> weight = weights_of(narrow);
  Halves out;
  const auto draw = [&](std::span<const int> rounds) {
    for (const int k : rounds)
      draw_towards(graph, with_mean_of_rest(graph, samples, out, k), samples, weight, kDoubt, &out);
  };
  if (denoise) {
    for (size_t h = 0; h < 2; ++h) out[h] = denoise(found[h]);
    // Where light is even over a chart of few pixels, a wide mean is better.
    draw_towards(graph, wide, samples, weight, kDoubt, &out);
    draw(kRoundsAfterDenoising);
  } else {
    out = wide;
    draw(std::span(kRounds).subspan(1));
  }
  return out;
}

Halves correct(const TexelGraph& graph, Halves estimate, const Halves& samples,
               const Denoise& denoise) {
  const std::vector<float> weight = weights_of(estimate);
  if (denoise) {
    const Halves clean = {denoise(samples[0]), denoise(samples[1])};
    draw_towards(graph, clean, samples, weight, kDoubt, &estimate);
    return estimate;
  }
  const Halves even = without_peaks(graph, expected_by(estimate), samples);
  // Peaks are held against the way as they were: what was spread is noise that texels share.
  for (const int rounds : kRounds) {
    draw_towards(graph, with_mean_of_rest(graph, even, estimate, rounds), samples, weight,
                 kDoubtOfPaths, &estimate);
  }
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
