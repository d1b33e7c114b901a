// Internal: the irradiance estimator, with a hook that sees the rays (benchmark.h).
#pragma once

#include <atomic>
#include <vector>

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/pathtrace/irradiance.h"
#include "lte/pathtrace/path_sampler.h"
#include "lte/pathtrace/transport.h"

namespace lte::pathtrace {

/// How the paths of a point are cut into independently scrambled point sets, from which variance is
/// estimated.
struct Batches {
  int count = 0, size = 0;
};

/// Few rays: up to 8 batches, so that a variance exists. Many: 8 batches, 16 from 4,096 rays on, of
/// whole blocks of the sequence. More batches know the variance better and stratify less.
Batches plan_batches(int rays);

/// @throws lte::Error naming the first offending point: not finite, or a normal that is not unit.
void check_points(std::span<const Vec3> positions, std::span<const Vec3> normals);

/// @throws lte::Error naming the first option out of range.
void check_irradiance_options(const IrradianceOptions& options);

/// Sums of one point: by group, and by batch for the variance.
class PointSums {
 public:
  explicit PointSums(int groups) : direct(groups), indirect(groups) {}

  void start_point() {
    std::fill(direct.begin(), direct.end(), Sum{});
    std::fill(indirect.begin(), indirect.end(), Sum{});
    total_squares = indirect_squares = total_mean = indirect_mean = {};
  }
  void add(int group, int depth, const Rgb& value) {
    (depth == 1 ? direct : indirect)[static_cast<size_t>(group)].add(value);
    (depth == 1 ? batch_direct_ : batch_indirect_).add(value);
  }
  /// Takes the mean of the batch into the running sums over batches.
  void finish_batch(int size);
  /// Writes point `i`, from batches that have been finished.
  void store(const Batches& batches, int64_t i, Irradiance* out) const;

  struct Sum {
    double x = 0, y = 0, z = 0;
    void add(const Rgb& v) { x += v.x, y += v.y, z += v.z; }
  };
  std::vector<Sum> direct, indirect;
  Sum total_squares, indirect_squares, total_mean, indirect_mean;

 private:
  Sum batch_direct_, batch_indirect_;
};

/// Paths from one point. @param position  relative to the frame origin, already off the surface
template <typename Recorder>
void trace_point(Transport<Recorder>& transport, const Lights& lights, const Vec3& position,
                 const Vec3& normal, const Batches& batches, Sampling sampling, uint64_t seed,
                 uint64_t stream, PointSums& sums) {
  sums.start_point();
  PathSampler sampler(sampling, seed, stream);
  const Rgb white{1, 1, 1};
  for (int batch = 0; batch < batches.count; ++batch) {
    sampler.start_set(batches.size);
    for (int i = 0; i < batches.size && !lights.empty(); ++i) {
      sampler.next_path();
      transport.sample_light(position, normal, white, sampler.light_choice(0),
                             sampler.light_point(0), 1, sums);
      PathState path;
      path.origin = position;
      path.normal = normal;
      path.direction = cosine_direction(normal, sampler.direction(0), &path.pdf);
      transport.follow(path, sampler, sums);
    }
    sums.finish_batch(batches.size);
  }
}

/// estimate_irradiance() with a recorder for each point from `recorder_of(i)`, a reference.
template <typename RecorderOf>
Irradiance run_irradiance(const Bvh& bvh, const Lights& lights, std::span<const Vec3> positions,
                          std::span<const Vec3> normals, const IrradianceOptions& options,
                          int64_t first_index, const RecorderOf& recorder_of) {
  LTE_CHECK(&bvh.scene() == &lights.scene(), "the BVH and the lights are of two scenes");
  check_irradiance_options(options);
  check_points(positions, normals);
  const Batches batches = plan_batches(options.rays);
  const int max_depth = options.direct_only ? 1 : options.max_depth;
  const Vec3 frame = bvh.handles().origin;
  const float half_extent = 0.5f * max_component(bvh.bounds().extent());
  Irradiance out;
  out.groups = lights.groups();
  out.points = static_cast<int64_t>(positions.size());
  out.rays = int64_t{batches.count} * batches.size;
  out.direct.resize(static_cast<size_t>(out.groups * out.points));
  out.indirect.resize(out.direct.size());
  out.variance.resize(positions.size());
  out.variance_total.resize(positions.size());
  std::atomic<int64_t> rays_traced{0};
  constexpr int64_t kGrain = 4;  // a point is thousands of rays
  parallel_for(out.points, kGrain, [&](int64_t begin, int64_t end) {
    PointSums sums(lights.groups());
    for (int64_t i = begin; i < end; ++i) {
      auto&& recorder = recorder_of(i);
      Transport transport(bvh, lights, max_depth, options.roulette_depth, recorder);
      // The offset follows the world coordinates: their rounding is what puts a point behind its
      // surface.
      const Vec3 origin = offset_origin(positions[i], normals[i], half_extent) - frame;
      trace_point(transport, lights, origin, normals[i], batches, options.sampling, options.seed,
                  static_cast<uint64_t>(first_index + i), sums);
      sums.store(batches, i, &out);
      rays_traced += transport.rays_traced();
    }
  });
  out.rays_traced = rays_traced;
  return out;
}

}  // namespace lte::pathtrace
