#include "infer/eval/rivals/blur.h"

#include <algorithm>
#include <cmath>

#include "lte/base/check.h"
#include "lte/base/parallel.h"

namespace lte::infer {
namespace {

constexpr int64_t kSources = 512;
constexpr int64_t kGrain = 256;
constexpr double kSmallestSigma = 1e-9;  // metres; a scene of one point has no extent
constexpr float kVanishing = 1e-20f;

}  // namespace

std::vector<int64_t> spread(int64_t count, int64_t limit) {
  const int64_t picked = std::min(count, limit);
  std::vector<int64_t> out(static_cast<size_t>(picked));
  for (int64_t i = 0; i < picked; ++i) out[static_cast<size_t>(i)] = i * count / picked;
  return out;
}

BlurSources::BlurSources(const QueryPoints& points, std::span<const Rgb> direct) {
  LTE_CHECK(direct.size() == points.position.size(), "blur: ", direct.size(), " values for ",
            points.position.size(), " points");
  for (const int64_t picked : spread(points.size(), kSources)) {
    const auto i = static_cast<size_t>(picked);
    position_.push_back(points.position[i]);
    reflected_.push_back(points.albedo[i] * direct[i]);
    mean_ += reflected_.back();
  }
  if (!position_.empty()) mean_ *= 1 / static_cast<float>(position_.size());
}

std::vector<Rgb> BlurSources::blur(std::span<const Vec3> positions, double sigma_m) const {
  const double sigma = std::max(sigma_m, kSmallestSigma);
  const auto exponent = static_cast<float>(-0.5 / (sigma * sigma));
  std::vector<Rgb> out(positions.size());
  parallel_for(static_cast<int64_t>(positions.size()), kGrain, [&](int64_t begin, int64_t end) {
    for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i) {
      Rgb sum;
      float weights = 0;
      for (size_t j = 0; j < position_.size(); ++j) {
        const Vec3 offset = positions[i] - position_[j];
        const float weight = std::exp(exponent * dot(offset, offset));
        sum += weight * reflected_[j];
        weights += weight;
      }
      out[i] = weights > kVanishing ? sum / weights : mean_;
    }
  });
  return out;
}

}  // namespace lte::infer
