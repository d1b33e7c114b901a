#include "lte/nn/surfels.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <ATen/ATen.h>
#include <ATen/Parallel.h>
#include <ATen/core/grad_mode.h>

#include "lte/nn/surfel_grid.h"

namespace lte::nn {
namespace {

/// A disc's radius over that of a circle of the area which its point stands for: discs of points
/// that lie unevenly still meet.
constexpr double kOverlap = 1.6;
/// The logarithm of distances, about centred: rooms lie around a fifth of network space.
constexpr float kDistanceShift = 1.6f;
constexpr float kLeastDistance = 1e-4f;
constexpr int64_t kGrain = 256;

std::vector<Surfel> surfels_in(const at::Tensor& table) {
  const auto rows = table.accessor<float, 2>();
  std::vector<Surfel> surfels(static_cast<size_t>(table.size(0)));
  for (int64_t i = 0; i < table.size(0); ++i) {
    const auto triple = [&](int64_t column) {
      return Vec3{rows[i][column], rows[i][column + 1], rows[i][column + 2]};
    };
    surfels[static_cast<size_t>(i)] = {
        triple(Surfels::kPosition), triple(Surfels::kNormal),    rows[i][Surfels::kRadius],
        triple(Surfels::kFront),    triple(Surfels::kBack),      triple(Surfels::kEmission),
        triple(Surfels::kMetal),    rows[i][Surfels::kMetallic], rows[i][Surfels::kRoughness]};
  }
  return surfels;
}

void write(const Sight& sight, float* columns) {
  std::fill_n(columns, kSeenColumns, 0.0f);
  if (!sight.hit) return;
  for (int c = 0; c < 3; ++c) {
    columns[kSeenRadiance + c] = sight.radiance[c];
    columns[kSeenLog + c] = std::log1p(sight.radiance[c]);
  }
  columns[kSeenHit] = 1;
  columns[kSeenDistance] = std::log(std::max(sight.distance, kLeastDistance)) + kDistanceShift;
  columns[kSeenMetal] = sight.metallic;
  columns[kSeenCosine] = sight.cosine;
}

Vec3 vector_at(const float* values, int64_t row) {
  return {values[3 * row], values[3 * row + 1], values[3 * row + 2]};
}

}  // namespace

Surfels::Surfels(const at::Tensor& table, bool total)
    : table_(table), grid_(std::make_shared<SurfelGrid>(surfels_in(table), total)) {}

at::Tensor Surfels::see(const at::Tensor& position, const at::Tensor& directions) const {
  const int64_t Q = directions.size(0), N = directions.size(1);
  const auto prepared = [](const at::Tensor& of) {
    return of.detach().to(at::kCPU, at::kFloat).contiguous();
  };
  const at::Tensor origins = prepared(position), ways = prepared(directions);
  at::Tensor out = at::empty({Q, N, kSeenColumns}, at::kFloat);
  const float *from = origins.const_data_ptr<float>(), *along = ways.const_data_ptr<float>();
  float* seen = out.data_ptr<float>();
  at::parallel_for(0, Q * N, kGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i)
      write(grid_->look(vector_at(from, i / N), vector_at(along, i)), seen + i * kSeenColumns);
  });
  return out.to(directions.options());
}

Surfels make_surfels(const PointSet& points, const at::Tensor& position, double scale,
                     const at::Tensor& emission_scale, const at::Tensor& irradiance,
                     const ModelConfig& config) {
  const at::NoGradGuard no_grad;
  const at::Tensor a = emission_scale.to(points.emission.options());
  const at::Tensor unit = at::where(a > 0, a, 1);
  const at::Tensor none = at::zeros_like(points.albedo).narrow(1, 0, 1);
  const bool gloss = config.gloss && points.gloss.defined();
  const at::Tensor metallic = gloss ? points.gloss.narrow(1, 0, 1) : none,
                   roughness = gloss ? points.gloss.narrow(1, 1, 1) : none + 1;
  const bool apart = config.parts_sides();
  const at::Tensor back =
      apart ? (points.direct_back + points.indirect_back).div(unit) : at::zeros_like(irradiance);
  const at::Tensor direct =
      (apart ? points.direct - points.direct_back : points.direct).div(unit).clamp_min(0);
  const at::Tensor front = config.predicts_total() ? irradiance : direct + irradiance;
  const at::Tensor matt = points.albedo * (1 - metallic);
  const at::Tensor radius = points.area.div(std::numbers::pi).sqrt().mul(kOverlap / scale);
  const at::Tensor table = at::cat({position, points.normal, radius.unsqueeze(1), matt * front,
                                    matt * back, points.emission.div(unit).mul(std::numbers::pi),
                                    points.albedo * metallic, metallic, roughness},
                                   1);
  return Surfels(table.to(at::kCPU, at::kFloat).contiguous(), config.predicts_total());
}

}  // namespace lte::nn
