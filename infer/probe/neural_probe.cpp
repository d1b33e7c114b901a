#include "infer/probe/neural_probe.h"

#include <cmath>

#include "lte/scene/surface.h"

namespace lte::infer {
namespace {

/// Shares of the standard error over draws, of the answer at a point and of the mean answer that an
/// expected error is made of (docs/metrics.md).
struct ErrorShares {
  double spread, answer, mean;
};
constexpr ErrorShares kSeveralDraws{2, 0.2, 0.05}, kOneDraw{0, 0.3, 0.08};

}  // namespace

PointAlbedo albedo_at(const pathtrace::Bvh& bvh, const scene::PointTable& points) {
  PointAlbedo out;
  const float reach = kSurfaceDistance * length(bvh.bounds().extent());
  for (size_t i = 0; i < points.size(); ++i) {
    const Vec3& n = points.normal[i];
    const pathtrace::Hit hit = bvh.intersect({points.position[i] + n * reach, -n, 0, 2 * reach});
    Rgb albedo = kFreeAlbedo, emission;
    if (hit.valid()) {
      scene::evaluate_appearance(bvh.scene(), hit.instance, hit.triangle, hit.u, hit.v, 0, &albedo,
                                 &emission);
    } else {
      ++out.off_surface;
    }
    out.albedo.push_back(albedo);
  }
  return out;
}

void Draws::add(const std::vector<Rgb>& answers) { answers_.push_back(answers); }

std::vector<Rgb> Draws::mean() const {
  std::vector<Rgb> sum(answers_.front().size());
  for (const std::vector<Rgb>& answers : answers_)
    for (size_t i = 0; i < sum.size(); ++i) sum[i] += answers[i];
  for (Rgb& value : sum) value *= 1 / static_cast<float>(answers_.size());
  return sum;
}

std::vector<double> Draws::standard_error() const {
  if (answers_.size() < 2) return {};
  const std::vector<Rgb> middle = mean();
  const auto draws = static_cast<double>(answers_.size());
  std::vector<double> out(middle.size());
  for (size_t i = 0; i < middle.size(); ++i) {
    double squares = 0;
    for (const std::vector<Rgb>& answers : answers_)
      squares += std::pow(rms(answers[i] - middle[i]), 2);
    out[i] = std::sqrt(squares / (draws - 1) / draws);
  }
  return out;
}

std::vector<double> expected_error(std::span<const Rgb> answer,
                                   std::span<const double> standard_error) {
  double mean = 0;
  for (const Rgb& value : answer) mean += rms(value) / static_cast<double>(answer.size());
  const ErrorShares& share = standard_error.empty() ? kOneDraw : kSeveralDraws;
  std::vector<double> out(answer.size());
  for (size_t i = 0; i < answer.size(); ++i) {
    const double spread = standard_error.empty() ? 0 : share.spread * standard_error[i];
    out[i] = std::hypot(share.answer * rms(answer[i]), share.mean * mean, spread);
  }
  return out;
}

double rms(const Rgb& value) { return std::sqrt(double{dot(value, value)} / 3); }

}  // namespace lte::infer
