#include "lte/bake/rates.h"

#include <algorithm>
#include <cmath>

namespace lte::bake {
namespace {

/// Rounds of neighbours that light and noise are averaged over, and the texels that the mean of all
/// counts for beside them.
constexpr int kNoiseRounds = 4;
constexpr double kPrior = 4;
/// Of the mean light: what is darker counts like that, as where errors are compared.
constexpr double kDark = 0.1;
/// The relative error with the full rate, over the mean, and the least rate.
constexpr double kMost = 4, kLeast = 1.0 / 8;

}  // namespace

std::vector<uint8_t> sampling_rates(const TexelGraph& graph, const Halves& samples,
                                    const std::vector<uint8_t>& skipped) {
  const size_t count = graph.size();
  std::vector<float> found(count), square(count);
  for (size_t i = 0; i < count; ++i) found[i] = luminance(samples[0][i] + samples[1][i]) / 2;
  const std::vector<float> light = graph.spread(std::move(found), kNoiseRounds);
  std::vector<double> error(count);
  double mean = 0, used = 0;
  for (size_t i = 0; i < count; ++i) {
    if (skipped[i] != 0) continue;
    mean += double{light[i]};
    ++used;
  }
  if (!(mean > 0)) return std::vector<uint8_t>(count, kFullRate);
  const double dark = kDark * mean / used;
  double prior = 0;
  for (size_t i = 0; i < count; ++i) {
    const double half =
        double{luminance(samples[0][i] - samples[1][i])} / 2 / (double{light[i]} + dark);
    square[i] = static_cast<float>(half * half);
    prior += skipped[i] != 0 ? 0 : half * half / used;
  }
  const std::vector<float> near = graph.spread(std::move(square), kNoiseRounds);
  double sum = 0;
  for (size_t i = 0; i < count; ++i) {
    if (skipped[i] != 0) continue;
    const auto shared = static_cast<double>(graph.neighbours(i).size() + 1);
    error[i] = std::sqrt((shared * double{near[i]} + kPrior * prior) / (shared + kPrior) / shared);
    sum += error[i] / used;
  }
  std::vector<uint8_t> out(count);
  for (size_t i = 0; i < count; ++i) {
    if (skipped[i] != 0) continue;
    const double share = sum > 0 ? std::clamp(error[i] / (kMost * sum), kLeast, 1.0) : 1;
    out[i] = static_cast<uint8_t>(std::lround(kFullRate * share));
  }
  return out;
}

}  // namespace lte::bake
