#include "lte/nn/points/point_set.h"

#include <algorithm>
#include <cmath>
#include <compare>
#include <limits>

#include "lte/tensor/functions.h"

namespace lte::nn {
namespace {

/// Largest albedo that is taken for one. It may exceed 1 where a texture does.
constexpr double kLargestAlbedo = 16;
/// Largest component of a unit normal, with room for rounding.
constexpr double kLargestNormal = 1.01;

/// The first row of `t` with a value outside [low, high], as NaN is; −1 where there is none. On the
/// CPU one pass, which for a few rows is a hundredth of the time of tensors in between.
int64_t first_outside(const at::Tensor& t, double low, double high) {
  const int64_t rows = t.size(0);
  if (!t.is_cpu() || t.scalar_type() != at::kFloat) {
    const at::Tensor bad = (t >= low).logical_and(t <= high).logical_not();
    if (!bad.any().item<bool>()) return -1;
    return bad.view({rows, -1}).any(1).nonzero()[0][0].item<int64_t>();
  }
  const at::Tensor dense = t.contiguous();
  const auto* const values = dense.const_data_ptr<float>();
  const int64_t columns = rows > 0 ? t.numel() / rows : 0;
  for (int64_t row = 0; row < rows; ++row) {
    bool inside = true;
    for (int64_t i = row * columns; i < (row + 1) * columns; ++i) {
      const double value = values[i];
      inside = inside && value >= low && value <= high;
    }
    if (!inside) return row;
  }
  return -1;
}

/// @throws c10::Error unless `t` is [rows, 3] or [rows] and every value is finite. Names the first
/// row that is not.
void check_rows(const at::Tensor& t, int64_t rows, bool triple, const char* what,
                const char* name) {
  const bool shape_ok = t.defined() && t.dim() == (triple ? 2 : 1) && t.size(0) == rows &&
                        (!triple || t.size(1) == 3);
  TORCH_CHECK(shape_ok, what, ": ", name, " must be [", rows, triple ? ", 3]" : "]", ", got ",
              t.defined() ? c10::str(t.sizes()) : std::string("nothing"));
  constexpr double kMax = std::numeric_limits<double>::max();
  const int64_t row = first_outside(t, -kMax, kMax);
  TORCH_CHECK(row < 0, what, ": ", name, " of row ", row, " is not finite");
}

/// @throws c10::Error naming the first row with a value outside [low, high].
void check_range(const at::Tensor& t, double low, double high, const char* what, const char* name) {
  const int64_t row = first_outside(t, low, high);
  TORCH_CHECK(row < 0, what, ": ", name, " of row ", row, " is outside [", low, ", ", high, "]");
}

void check_surface(const at::Tensor& position, const at::Tensor& normal, const at::Tensor& albedo,
                   const char* what) {
  TORCH_CHECK(position.defined() && position.dim() == 2, what, ": position must be [N, 3]");
  const int64_t rows = position.size(0);
  check_rows(position, rows, true, what, "position");
  check_rows(normal, rows, true, what, "normal");
  check_rows(albedo, rows, true, what, "albedo");
  check_range(normal, -kLargestNormal, kLargestNormal, what, "normal");
  check_range(albedo, 0, kLargestAlbedo, what, "albedo");
}

void check_light(const at::Tensor& irradiance, const PointSet& points, const char* name) {
  TORCH_CHECK(irradiance.defined(), "scene points: ", name, " is missing, which this model reads");
  check_rows(irradiance, points.position.size(0), true, "scene points", name);
  check_range(irradiance, 0, INFINITY, "scene points", name);
}

/// @throws c10::Error naming the first row at which the back has more light than both sides.
void check_back(const at::Tensor& back, const at::Tensor& both, const PointSet& points,
                const char* name) {
  check_light(back, points, name);
  const at::Tensor bad = (back > both).any(1);
  if (!bad.any().item<bool>()) return;
  TORCH_CHECK(false, "scene points: ", name, " of row ", bad.nonzero()[0][0].item<int64_t>(),
              " is more than that of both sides");
}

/// @throws c10::Error unless `shares` is [M, 2] in [0, 1]. Names the first row that is not.
void check_shares(const at::Tensor& shares, const PointSet& points, const char* name) {
  const int64_t rows = points.position.size(0);
  TORCH_CHECK(shares.dim() == 2 && shares.size(0) == rows && shares.size(1) == 2,
              "scene points: ", name, " must be [", rows, ", 2], got ", shares.sizes());
  const at::Tensor bad = ((shares >= 0).logical_and(shares <= 1)).logical_not().any(1);
  if (!bad.any().item<bool>()) return;
  TORCH_CHECK(false, "scene points: ", name, " of row ", bad.nonzero()[0][0].item<int64_t>(),
              " is outside [0, 1]");
}

void check_error(const PointSet& points) {
  constexpr const char* kName = "standard error of indirect irradiance";
  TORCH_CHECK(points.indirect_error.defined(), "scene points: ", kName,
              " is missing, which this model reads");
  check_shares(points.indirect_error, points, kName);
}

}  // namespace

void check_surfaces(const PointSet& points) {
  check_surface(points.position, points.normal, points.albedo, "scene points");
  const int64_t rows = points.position.size(0);
  TORCH_CHECK(rows >= 1, "scene points: there are none");
  check_rows(points.emission, rows, true, "scene points", "emission");
  check_rows(points.area, rows, false, "scene points", "area");
  check_range(points.emission, 0, INFINITY, "scene points", "emission");
  check_range(points.area, 0, INFINITY, "scene points", "area");
}

void check_points(const PointSet& points, const ModelConfig& config) {
  check_surfaces(points);
  if (config.predicts_radiance() && points.gloss.defined())
    check_shares(points.gloss, points, "gloss (metallic, roughness)");
  if (!config.reads_light()) return;
  check_light(points.direct, points, "direct irradiance");
  check_light(points.indirect, points, "indirect irradiance");
  check_back(points.direct_back, points.direct, points, "direct irradiance of the back");
  check_back(points.indirect_back, points.indirect, points, "indirect irradiance of the back");
  if (config.reads_estimates()) check_error(points);
}

void check_queries(const QuerySet& queries) {
  check_surface(queries.position, queries.normal, queries.albedo, "query points");
}

void check_directions(const QuerySet& queries, const at::Tensor& directions) {
  constexpr double kTolerance = 1e-2;
  const int64_t Q = queries.position.size(0);
  TORCH_CHECK(directions.defined() && directions.dim() == 3 && directions.size(0) == Q &&
                  directions.size(2) == 3,
              "directions: must be [", Q, ", N, 3], got ",
              directions.defined() ? c10::str(directions.sizes()) : std::string("nothing"));
  const auto refuse = [](const at::Tensor& bad, const char* what) {
    if (!bad.any().item<bool>()) return;
    const at::Tensor first = bad.nonzero()[0];
    TORCH_CHECK(false, "directions: direction ", first[1].item<int64_t>(), " of query ",
                first[0].item<int64_t>(), " ", what);
  };
  const at::Tensor length = directions.square().sum(2).sqrt();
  // Written so that what is not finite is refused too.
  refuse(((length - 1).abs() <= kTolerance).logical_not(), "is not a unit vector");
  const at::Tensor cosine = (directions * queries.normal.unsqueeze(1)).sum(2);
  refuse((cosine >= -kTolerance).logical_not(), "points into the surface");
}

PointSet PointSet::to(c10::Device device) const {
  PointSet out = *this;
  for (at::Tensor* t : out.tensors()) {
    if (t->defined()) *t = t->to(device);
  }
  return out;
}

PointSet in_canonical_order(const PointSet& points) {
  PointSet out = points;
  std::vector<at::Tensor> columns;
  for (const at::Tensor* t : out.tensors())
    if (t->defined()) columns.push_back(t->to(at::kCPU, at::kFloat).view({t->size(0), -1}));
  const at::Tensor rows = at::cat(columns, 1).contiguous();
  const auto* values = rows.const_data_ptr<float>();
  const int64_t width = rows.size(1);
  at::Tensor order = at::arange(rows.size(0), at::kLong);
  auto* first = order.data_ptr<int64_t>();
  std::sort(first, first + order.size(0), [&](int64_t a, int64_t b) {
    // Values that are not finite have a place, too; the checks of an encoder name them.
    for (int64_t i = 0; i < width; ++i) {
      const auto by = std::strong_order(values[a * width + i], values[b * width + i]);
      if (by != 0) return by < 0;
    }
    return false;
  });
  for (at::Tensor* t : out.tensors())
    if (t->defined()) *t = t->index_select(0, order.to(t->device()));
  return out;
}

QuerySet QuerySet::to(c10::Device device) const {
  return {position.to(device), normal.to(device), albedo.to(device)};
}

at::Tensor emission_scale(const PointSet& points) {
  const at::Tensor emission = points.emission.to(at::kDouble);
  const at::Tensor area = points.area.to(at::kDouble);
  const double total_area = area.sum().item<double>();
  // Points of no area, which nobody samples but tests and callers may give, count alike.
  const at::Tensor mean =
      total_area > 0 ? at::mv(emission.t(), area).div(total_area) : emission.mean(0);
  return mean.to(at::kCPU);
}

double mean_emission(const PointSet& points) {
  const double mean = emission_scale(points).mean().item<double>();
  return mean > 0 ? mean : 1;
}

std::array<double, 3> target_factors(const at::Tensor& emission_scale) {
  std::array<double, 3> factors{};
  for (size_t c = 0; c < 3; ++c) {
    const double mean = emission_scale[static_cast<int64_t>(c)].item<double>();
    factors[c] = mean > 0 ? 1 / mean : 0;
  }
  return factors;
}

}  // namespace lte::nn
