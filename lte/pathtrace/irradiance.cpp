#include "lte/pathtrace/irradiance.h"

#include <atomic>
#include <cmath>
#include <memory>

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/pathtrace/transport/irradiance_kernel.h"

namespace lte::pathtrace {
namespace {

constexpr int kMaxRays = 1 << 26;
constexpr int kMaxDepth = 1024;

Rgb sum_groups(const std::vector<Rgb>& values, int64_t groups, int64_t points, int64_t point) {
  Rgb sum;
  for (int64_t g = 0; g < groups; ++g) sum += values[static_cast<size_t>(g * points + point)];
  return sum;
}

/// Unbiased variance of the mean of `count` independent values; rounding below zero is cut off.
double variance_of_mean(double sum, double squares, int count) {
  const double mean = sum / count;
  return std::max(0.0, squares / count - mean * mean) / (count - 1);
}

}  // namespace

Batches plan_batches(int rays) {
  if (rays <= 8) return {std::max(rays, 2), 1};
  const int count = rays < 4096 ? 8 : 16;
  const int block = rays <= 64 ? 1 : 64 / count;
  const int size = (rays + count - 1) / count;
  return {count, (size + block - 1) / block * block};
}

void check_points(std::span<const Vec3> positions, std::span<const Vec3> normals) {
  LTE_CHECK(positions.size() == normals.size(), "irradiance needs one normal a position: got ",
            positions.size(), " positions and ", normals.size(), " normals");
  for (size_t i = 0; i < positions.size(); ++i) {
    LTE_CHECK(is_finite(positions[i]), "position ", i, " is not finite");
    LTE_CHECK(is_finite(normals[i]), "normal ", i, " is not finite");
    LTE_CHECK(std::fabs(dot(normals[i], normals[i]) - 1) < 1e-3f, "normal ", i,
              " is not a unit vector: its length is ", length(normals[i]));
  }
}

void check_irradiance_options(const IrradianceOptions& options) {
  LTE_CHECK(options.rays >= 1 && options.rays <= kMaxRays, "rays must be 1 to ", kMaxRays, ", got ",
            options.rays);
  LTE_CHECK(options.max_depth >= 1 && options.max_depth <= kMaxDepth, "max_depth must be 1 to ",
            kMaxDepth, ", got ", options.max_depth);
  LTE_CHECK(options.roulette_depth >= 1, "roulette_depth must be at least 1, got ",
            options.roulette_depth);
}

void PointSums::start_point() {
  std::fill(direct_.begin(), direct_.end(), Sum{});
  std::fill(indirect_.begin(), indirect_.end(), Sum{});
  std::fill(batch_.begin(), batch_.end(), BatchSum{});
}

void PointSums::add(int depth, std::span<const Contribution> contributions) {
  std::vector<Sum>& groups = depth == 1 ? direct_ : indirect_;
  Sum BatchSum::*const part = depth == 1 ? &BatchSum::direct : &BatchSum::indirect;
  for (const Contribution& c : contributions) {
    groups[static_cast<size_t>(c.light_group)].add(c.value);
    const int32_t batch = batch_of_path_[static_cast<size_t>(c.path)];
    (batch_[static_cast<size_t>(batch)].*part).add(c.value);
  }
}

void PointSums::store(int64_t i, Irradiance* out) const {
  const double scale = kPi / (static_cast<double>(batches_.count) * batches_.size);
  for (size_t g = 0; g < direct_.size(); ++g) {
    const auto slot = g * static_cast<size_t>(out->points) + static_cast<size_t>(i);
    const auto scaled = [scale](const Sum& sum) {
      return Rgb{static_cast<float>(sum.x * scale), static_cast<float>(sum.y * scale),
                 static_cast<float>(sum.z * scale)};
    };
    out->direct[slot] = scaled(direct_[g]);
    out->indirect[slot] = scaled(indirect_[g]);
  }
  if (out->variance.empty()) return;  // not asked for
  const auto variance = [this](const auto& value_of) {
    double sum = 0, squares = 0;
    for (const BatchSum& batch : batch_) {
      const double mean = kPi * value_of(batch) / batches_.size;
      sum += mean;
      squares += mean * mean;
    }
    return static_cast<float>(variance_of_mean(sum, squares, batches_.count));
  };
  Rgb indirect, total;
  double Sum::*const channels[] = {&Sum::x, &Sum::y, &Sum::z};
  for (int c = 0; c < 3; ++c) {
    const auto channel = channels[c];
    indirect[c] = variance([=](const BatchSum& b) { return b.indirect.*channel; });
    total[c] = variance([=](const BatchSum& b) { return b.direct.*channel + b.indirect.*channel; });
  }
  out->variance[i] = (indirect.x + indirect.y + indirect.z) / 3;
  out->variance_total[i] = total;
}

namespace {

/// All batches of one point, in blocks. @param position  in the frame, already off the surface
void trace_point(Transport& transport, const Vec3& position, const Vec3& normal,
                 const Batches& batches, PathSampler& sampler, PointSums& sums) {
  sums.start_point();
  const auto flush = [&] {
    transport.trace_from_surface(position, normal, sampler);
    sampler.clear();
    sums.start_block();
  };
  sums.start_block();
  for (int batch = 0; batch < batches.count; ++batch) {
    sampler.start_set();
    for (int i = 0; i < batches.size; ++i) {
      if (sampler.paths() == kBlock) flush();
      sampler.add_path();
      sums.add_path(batch);
    }
  }
  flush();
}

}  // namespace

Irradiance run_irradiance(const Bvh& bvh, const Lights& lights, std::span<const Vec3> positions,
                          std::span<const Vec3> normals, const IrradianceOptions& options,
                          int64_t first_index, const RecorderOf& recorder_of) {
  LTE_CHECK(&bvh.scene() == &lights.scene(), "the BVH and the lights are of two scenes");
  check_irradiance_options(options);
  check_points(positions, normals);
  const Batches batches =
      options.rays == 1 && !options.variance ? Batches{1, 1} : plan_batches(options.rays);
  const int max_depth = options.direct_only ? 1 : options.max_depth;
  const Vec3 frame = bvh.handles().origin;
  const float half_extent = 0.5f * max_component(bvh.bounds().extent());
  Irradiance out;
  out.groups = lights.groups();
  out.points = static_cast<int64_t>(positions.size());
  out.rays = int64_t{batches.count} * batches.size;
  out.direct.resize(static_cast<size_t>(out.groups * out.points));
  out.indirect.resize(out.direct.size());
  if (options.variance) {
    out.variance.resize(positions.size());
    out.variance_total.resize(positions.size());
  }
  if (lights.empty()) return out;
  std::atomic<int64_t> rays_traced{0};
  constexpr int64_t kGrain = 4;  // a point is thousands of rays
  parallel_for(out.points, kGrain, [&](int64_t begin, int64_t end) {
    PointSums sums(lights.groups(), batches);
    const auto sampler = std::make_unique<PathSampler>(options.sampling, batches.size);
    const auto transport =
        std::make_unique<Transport>(bvh, lights, max_depth, options.roulette_depth, sums);
    for (int64_t i = begin; i < end; ++i) {
      transport->record(recorder_of ? recorder_of(i) : nullptr);
      sampler->start_stream(options.seed, static_cast<uint64_t>(first_index + i));
      // The offset follows the world coordinates: their rounding is what puts a point behind its
      // surface.
      const Vec3 origin = offset_origin(positions[i], normals[i], half_extent) - frame;
      trace_point(*transport, origin, normals[i], batches, *sampler, sums);
      sums.store(i, &out);
    }
    rays_traced += transport->rays_traced();
  });
  out.rays_traced = rays_traced;
  return out;
}

Rgb Irradiance::direct_sum(int64_t point) const {
  return sum_groups(direct, groups, points, point);
}

Rgb Irradiance::indirect_sum(int64_t point) const {
  return sum_groups(indirect, groups, points, point);
}

Rgb Irradiance::total(int64_t point) const { return direct_sum(point) + indirect_sum(point); }

Irradiance estimate_irradiance(const Bvh& bvh, const Lights& lights,
                               std::span<const Vec3> positions, std::span<const Vec3> normals,
                               const IrradianceOptions& options, int64_t first_index) {
  return run_irradiance(bvh, lights, positions, normals, options, first_index, {});
}

}  // namespace lte::pathtrace
