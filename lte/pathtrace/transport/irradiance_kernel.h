// Internal: the irradiance estimator for any observer of its rays.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <memory>
#include <span>
#include <vector>

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/pathtrace/blocks/path_sampler.h"
#include "lte/pathtrace/irradiance.h"
#include "lte/pathtrace/ray_offset.h"
#include "lte/pathtrace/transport/transport.h"

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
class PointSums : public LightSink {
 public:
  /// @param groups    1: all light together, whatever group it is of
  /// @param by_group    batches are kept by group too
  /// @param last_depth  whose light is kept apart, too; 0: none
  PointSums(int groups, const Batches& batches, bool by_group, int last_depth)
      : batches_(batches),
        last_depth_(last_depth),
        direct_(groups),
        indirect_(groups),
        last_(last_depth > 0 ? groups : 0),
        batch_(batches.count),
        gray_(by_group ? static_cast<size_t>(groups) * static_cast<size_t>(batches.count) : 0) {}

  void start_point();
  /// Paths of the next block: of this batch, from the block's start on.
  void start_block() { batch_of_path_size_ = 0; }
  void add_path(int batch) { batch_of_path_[batch_of_path_size_++] = batch; }
  void add(int depth, std::span<const Contribution> contributions) override;
  /// Writes point `i`, whose paths are done.
  void store(int64_t i, Irradiance* out) const;

 private:
  struct Sum {
    double x = 0, y = 0, z = 0;
    void add(const Rgb& v) {
      x += v.x;
      y += v.y;
      z += v.z;
    }
  };
  struct BatchSum {
    Sum direct, indirect;
  };
  const Batches batches_;
  const int last_depth_;
  std::vector<Sum> direct_, indirect_, last_;
  std::vector<BatchSum> batch_;
  std::vector<double> gray_;  ///< [groups, batches] indirect light over the channels; may be empty
  int batch_of_path_size_ = 0;
  std::array<int32_t, kBlock> batch_of_path_;
};

/// Traces all batches of one point, in blocks.
/// @param position  in the frame, already off the surface
template <typename Observer>
void trace_point(BasicTransport<Observer>& transport, const Vec3& position, const Vec3& normal,
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

/// estimate_irradiance(), with observers of the rays (transport.h).
/// @param observer_of  the Observer of the rays of point i
template <typename Observer, typename ObserverOf>
Irradiance run_irradiance(const Bvh& bvh, const Lights& lights, std::span<const Vec3> positions,
                          std::span<const Vec3> normals, const IrradianceOptions& options,
                          int64_t first_index, const ObserverOf& observer_of) {
  LTE_CHECK(&bvh.scene() == &lights.scene(), "the BVH and the lights are of two scenes");
  check_irradiance_options(options);
  check_points(positions, normals);
  const Batches batches =
      options.rays == 1 && !options.variance ? Batches{1, 1} : plan_batches(options.rays);
  const int max_depth = options.direct_only ? 1 : options.max_depth;
  const Vec3 frame = bvh.handles().origin;
  const float half_extent = 0.5f * max_component(bvh.bounds().extent());
  Irradiance out;
  out.groups = options.by_group ? lights.groups() : std::min(lights.groups(), 1);
  out.points = static_cast<int64_t>(positions.size());
  out.rays = int64_t{batches.count} * batches.size;
  out.direct.resize(static_cast<size_t>(out.groups * out.points));
  out.indirect.resize(out.direct.size());
  if (options.last_bounce) out.last.resize(out.direct.size());
  if (options.variance) {
    out.variance.resize(positions.size());
    out.variance_total.resize(positions.size());
  }
  if (lights.empty()) return out;
  if (options.variance && options.by_group && options.group_variance)
    out.group_variance.resize(out.direct.size());
  std::atomic<int64_t> rays_traced{0};
  constexpr int64_t kGrain = 4;  // a point is thousands of rays
  parallel_for(out.points, kGrain, [&](int64_t begin, int64_t end) {
    PointSums sums(static_cast<int>(out.groups), batches, !out.group_variance.empty(),
                   options.last_bounce ? max_depth : 0);
    const auto sampler = std::make_unique<PathSampler>(options.sampling, batches.size);
    const auto transport = std::make_unique<BasicTransport<Observer>>(bvh, lights, max_depth,
                                                                      options.roulette_depth, sums);
    for (int64_t i = begin; i < end; ++i) {
      transport->observe(observer_of(i));
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

}  // namespace lte::pathtrace
