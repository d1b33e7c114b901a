#include "lte/nn/points/surfels.h"

#include <numbers>

#include "lte/tensor/functions.h"

namespace lte::nn {
namespace {

/// A disc's radius over that of a circle of the area which its point stands for: discs of points
/// that lie unevenly still meet.
constexpr double kOverlap = 1.6;

}  // namespace

at::Tensor Surfels::see(const at::Tensor& position, const at::Tensor& directions) const {
  const auto prepared = [&](const at::Tensor& of) {
    return of.detach().to(table().device(), at::kFloat);
  };
  return ops::see_surfels(prepared(position), prepared(directions), grid_).to(directions.options());
}

Surfels make_surfels(const PointSet& points, const at::Tensor& position, double scale,
                     const at::Tensor& emission_scale, const at::Tensor& irradiance) {
  const at::NoGradGuard no_grad;
  const at::Tensor a = emission_scale.to(points.emission.options());
  const at::Tensor unit = at::where(a > 0, a, 1);
  const at::Tensor none = at::zeros_like(points.albedo).narrow(1, 0, 1);
  const bool gloss = points.gloss.defined();
  const at::Tensor metallic = gloss ? points.gloss.narrow(1, 0, 1) : none,
                   roughness = gloss ? points.gloss.narrow(1, 1, 1) : none + 1;
  const at::Tensor back = (points.direct_back + points.indirect_back).div(unit);
  const at::Tensor front = (points.direct - points.direct_back).div(unit).clamp_min(0) + irradiance;
  const at::Tensor matt = points.albedo * (1 - metallic);
  // In double: libraries round square roots of floats each their own way.
  const at::Tensor radius = points.area.to(at::kDouble)
                                .div(std::numbers::pi)
                                .sqrt()
                                .mul(kOverlap / scale)
                                .to(points.area.scalar_type());
  const at::Tensor table = at::cat({position, points.normal, radius.unsqueeze(1), matt * front,
                                    matt * back, points.emission.div(unit).mul(std::numbers::pi),
                                    points.albedo * metallic, metallic, roughness},
                                   1);
  return Surfels(table.to(at::kFloat));
}

}  // namespace lte::nn
