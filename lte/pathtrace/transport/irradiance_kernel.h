// Internal: the irradiance estimator, with a hook that sees the rays (benchmark.h).
#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "lte/pathtrace/irradiance.h"
#include "lte/pathtrace/transport/path_sampler.h"
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
  PointSums(int groups, const Batches& batches)
      : batches_(batches), direct_(groups), indirect_(groups), batch_(batches.count) {}

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
    void add(const Rgb& v) { x += v.x, y += v.y, z += v.z; }
  };
  struct BatchSum {
    Sum direct, indirect;
  };
  const Batches batches_;
  std::vector<Sum> direct_, indirect_;
  std::vector<BatchSum> batch_;
  int batch_of_path_size_ = 0;
  std::array<int32_t, kBlock> batch_of_path_;
};

/// Where the rays of point i are recorded, null for nowhere.
using RecorderOf = std::function<RayRecorder*(int64_t point)>;

/// estimate_irradiance() with a recorder.
Irradiance run_irradiance(const Bvh& bvh, const Lights& lights, std::span<const Vec3> positions,
                          std::span<const Vec3> normals, const IrradianceOptions& options,
                          int64_t first_index, const RecorderOf& recorder_of);

}  // namespace lte::pathtrace
