#include "lte/pathtrace/adaptive.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <numeric>

#include "lte/base/check.h"
#include "lte/base/morton.h"
#include "lte/base/random.h"
#include "lte/pathtrace/transport/irradiance_kernel.h"

namespace lte::pathtrace {
namespace {

constexpr int64_t kPointsAtOnce = 4096;  // between two reports of progress
/// How many neighbours in Morton order count on either side. A pilot of 8 batches knows a variance
/// to 53 %; the mean of eight, to 19 %.
constexpr int64_t kNeighboursPerSide = 4;
/// A single pilot knows the variance only roughly; this much more keeps most points below the
/// target.
constexpr double kOwnSafety = 1.3;

float channel_mean(const Rgb& value) { return (value.x + value.y + value.z) / 3; }

/// A Morton code of 10 bits an axis.
uint64_t morton(const Vec3& position, const Bounds& bounds) {
  const float scale = 1023 / std::max(max_component(bounds.extent()), 1e-30f);
  std::array<uint32_t, 3> cell{};
  for (int axis = 0; axis < 3; ++axis)
    cell[static_cast<size_t>(axis)] = static_cast<uint32_t>(
        std::clamp((position[axis] - bounds.low[axis]) * scale, 0.0f, 1023.0f));
  return morton_code(cell);
}

/// One of six: the axis that the normal leans to, and its sign.
uint64_t normal_class(const Vec3& n) {
  int axis = 0;
  for (int a = 1; a < 3; ++a)
    if (std::fabs(n[a]) > std::fabs(n[axis])) axis = a;
  return static_cast<uint64_t>(2 * axis + (n[axis] < 0 ? 1 : 0));
}

/// Traces the pilot, then groups points by the paths that they still need and traces each group.
class Estimator {
 public:
  Estimator(const Bvh& bvh, const Lights& lights, std::span<const Vec3> positions,
            std::span<const Vec3> normals, const AdaptiveOptions& options, const PathsDone& done)
      : bvh_(bvh),
        lights_(lights),
        positions_(positions),
        normals_(normals),
        options_(options),
        done_(done) {}

  AdaptiveIrradiance run() {
    std::vector<size_t> all(positions_.size());
    std::iota(all.begin(), all.end(), size_t{0});
    out_.irradiance = trace(all, options_.min_rays, hash_combine(options_.seed, 1));
    out_.rays.assign(all.size(), static_cast<int32_t>(out_.irradiance.rays));
    const bool keep_pilot = options_.scale == ErrorScale::MeanIndirect;
    const std::vector<int> more = keep_pilot ? by_neighbours() : by_own_pilot();
    std::map<int, std::vector<size_t>> runs;
    for (const size_t i : all) runs[more[i]].push_back(i);
    for (const auto& [rays, which] : runs) {
      if (rays == 0) continue;
      const uint64_t seed = hash_combine(options_.seed, 1 + static_cast<uint64_t>(rays));
      take(which, trace(which, rays, seed), keep_pilot);
    }
    finish();
    return std::move(out_);
  }

 private:
  /// Estimates the points `which` with `rays` paths.
  Irradiance trace(const std::vector<size_t>& which, int rays, uint64_t seed) {
    IrradianceOptions options;
    options.rays = rays;
    options.max_depth = options_.max_depth;
    options.seed = seed;
    Irradiance out;
    out.groups = lights_.groups();
    out.points = static_cast<int64_t>(which.size());
    out.direct.resize(static_cast<size_t>(out.groups) * which.size());
    out.indirect.resize(out.direct.size());
    std::vector<Vec3> position, normal;
    for (int64_t first = 0; first < out.points; first += kPointsAtOnce) {
      const int64_t count = std::min(kPointsAtOnce, out.points - first);
      position.clear();
      normal.clear();
      for (int64_t i = first; i < first + count; ++i) {
        position.push_back(positions_[which[static_cast<size_t>(i)]]);
        normal.push_back(normals_[which[static_cast<size_t>(i)]]);
      }
      const Irradiance block = estimate_irradiance(bvh_, lights_, position, normal, options, first);
      for (int64_t g = 0; g < out.groups; ++g) {
        std::copy_n(block.direct.begin() + g * count, count,
                    out.direct.begin() + g * out.points + first);
        std::copy_n(block.indirect.begin() + g * count, count,
                    out.indirect.begin() + g * out.points + first);
      }
      out.variance.insert(out.variance.end(), block.variance.begin(), block.variance.end());
      out.variance_total.insert(out.variance_total.end(), block.variance_total.begin(),
                                block.variance_total.end());
      out.rays = block.rays;
      out.rays_traced += block.rays_traced;
      if (done_) done_(count * block.rays);
    }
    out_.paths += out.rays * out.points;
    return out;
  }

  /// Paths on top of the pilot, from the pilots of all points but the one they are for.
  std::vector<int> by_neighbours() const {
    const Irradiance& pilot = out_.irradiance;
    const int64_t N = pilot.points;
    double sum = 0;
    for (int64_t i = 0; i < N; ++i) sum += channel_mean(pilot.indirect_sum(i));
    const std::vector<size_t> order = spatial_order();
    std::vector<int> more(order.size());
    for (int64_t k = 0; k < N; ++k) {
      const size_t i = order[static_cast<size_t>(k)];
      const int64_t low = std::max<int64_t>(0, k - kNeighboursPerSide),
                    high = std::min(N - 1, k + kNeighboursPerSide);
      double variance = 0;
      for (int64_t j = low; j <= high; ++j)
        if (j != k) variance += pilot.variance[order[static_cast<size_t>(j)]];
      variance /= static_cast<double>(std::max<int64_t>(1, high - low));
      const double others = sum - channel_mean(pilot.indirect_sum(static_cast<int64_t>(i)));
      const double error = options_.target_error * others / static_cast<double>(N - 1);
      const double wanted =
          N < 2 ? INFINITY : static_cast<double>(pilot.rays) * variance / (error * error);
      more[i] = variance > 0 || N < 2 ? rounded(wanted - static_cast<double>(pilot.rays), 64,
                                                options_.max_rays - static_cast<int>(pilot.rays))
                                      : 0;
    }
    return more;
  }

  /// Paths of the estimate, from the point's own pilot.
  std::vector<int> by_own_pilot() const {
    const Irradiance& pilot = out_.irradiance;
    std::vector<int> rays(positions_.size());
    for (size_t i = 0; i < rays.size(); ++i) {
      const double ratio = relative_error(i) / options_.target_error;
      const double wanted = kOwnSafety * static_cast<double>(pilot.rays) * ratio * ratio;
      rays[i] = rounded(std::max(wanted, 1.0), static_cast<int>(pilot.rays), options_.max_rays);
    }
    return rays;
  }

  /// `rays` from `least` up to the cap in four steps an octave, so that points share runs; 0 for
  /// none.
  static int rounded(double rays, int least, int cap) {
    if (!(rays > 0) || cap <= 0) return 0;
    if (!(rays < cap)) return cap;
    const auto whole = static_cast<uint32_t>(std::ceil(rays));
    const auto step = std::max(static_cast<uint32_t>(least), std::bit_floor(whole) / 4);
    return std::min(cap, static_cast<int>((whole + step - 1) / step * step));
  }

  std::vector<size_t> spatial_order() const {
    Bounds bounds;
    for (const Vec3& p : positions_) bounds.extend(p);
    std::vector<std::pair<uint64_t, size_t>> keys;
    for (size_t i = 0; i < positions_.size(); ++i)
      keys.push_back({(normal_class(normals_[i]) << 32) | morton(positions_[i], bounds), i});
    std::sort(keys.begin(), keys.end());
    std::vector<size_t> order;
    for (const auto& key : keys) order.push_back(key.second);
    return order;
  }

  /// Puts estimates of the points `which` in the place of the pilot's, or beside them: each
  /// weighted by its paths, which is fixed before either was drawn.
  void take(const std::vector<size_t>& which, const Irradiance& fresh, bool keep_pilot) {
    Irradiance& all = out_.irradiance;
    const auto pilot_rays = static_cast<float>(keep_pilot ? all.rays : 0);
    const float weight =
        static_cast<float>(fresh.rays) / (pilot_rays + static_cast<float>(fresh.rays));
    const auto mix = [weight](auto& old, const auto& value) {
      old = old * (1 - weight) + value * weight;
    };
    const auto mix_variance = [weight](auto& old, const auto& value) {
      old = old * ((1 - weight) * (1 - weight)) + value * (weight * weight);
    };
    const size_t N = positions_.size(), count = which.size();
    for (size_t k = 0; k < count; ++k) {
      const size_t i = which[k];
      for (size_t g = 0; g < static_cast<size_t>(all.groups); ++g) {
        mix(all.direct[g * N + i], fresh.direct[g * count + k]);
        mix(all.indirect[g * N + i], fresh.indirect[g * count + k]);
      }
      mix_variance(all.variance[i], fresh.variance[k]);
      mix_variance(all.variance_total[i], fresh.variance_total[k]);
      out_.rays[i] = static_cast<int32_t>(fresh.rays) + (keep_pilot ? out_.rays[i] : 0);
    }
    all.rays_traced += fresh.rays_traced;
  }

  /// Standard error over mean, both averaged over color; infinite where nothing has arrived yet.
  double relative_error(size_t i) const {
    const double mean = channel_mean(out_.irradiance.total(static_cast<int64_t>(i)));
    const Rgb& v = out_.irradiance.variance_total[i];
    const double error = channel_mean({std::sqrt(v.x), std::sqrt(v.y), std::sqrt(v.z)});
    return mean > 0 ? error / mean : INFINITY;
  }

  void finish() {
    Irradiance& all = out_.irradiance;
    double mean = 0, rays = 0;
    for (size_t i = 0; i < positions_.size(); ++i) {
      mean += channel_mean(all.indirect_sum(static_cast<int64_t>(i)));
      rays += out_.rays[i];
    }
    const auto N = static_cast<double>(std::max<size_t>(1, positions_.size()));
    mean /= N;
    all.rays = static_cast<int64_t>(std::llround(rays / N));
    for (size_t i = 0; i < positions_.size(); ++i) {
      if (out_.rays[i] < options_.max_rays) continue;
      // No light at all after every path that was allowed is an answer, not a miss.
      const bool lit = max_component(all.total(static_cast<int64_t>(i))) > 0;
      const bool above = options_.scale == ErrorScale::OwnTotal
                             ? relative_error(i) > options_.target_error
                             : std::sqrt(all.variance[i]) > options_.target_error * mean;
      if (lit && above) ++out_.missed;
    }
  }

  const Bvh& bvh_;
  const Lights& lights_;
  std::span<const Vec3> positions_, normals_;
  const AdaptiveOptions& options_;
  const PathsDone& done_;
  AdaptiveIrradiance out_;
};

}  // namespace

AdaptiveIrradiance estimate_adaptive(const Bvh& bvh, const Lights& lights,
                                     std::span<const Vec3> positions, std::span<const Vec3> normals,
                                     const AdaptiveOptions& options, const PathsDone& done) {
  LTE_CHECK(options.target_error > 0 && std::isfinite(options.target_error),
            "target_error must be a positive number, got ", options.target_error);
  LTE_CHECK(options.min_rays >= 2 && options.min_rays <= options.max_rays,
            "min_rays must be 2 to max_rays (", options.max_rays, "), got ", options.min_rays);
  check_points(positions, normals);
  return Estimator(bvh, lights, positions, normals, options, done).run();
}

}  // namespace lte::pathtrace
