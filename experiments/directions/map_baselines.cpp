#include "experiments/directions/map_baselines.h"

#include <ATen/ATen.h>

#include "lte/base/text.h"

namespace lte::experiments {
namespace {

/// What is shown as maps: degrees of harmonics, and Gaussians that store as much as l ≤ 7, 192
/// numbers.
constexpr int kShown = 6, kShownHighest = 20, kShownNumbers = 192;

}  // namespace

MapErrors errors_of(const at::Tensor& maps, const at::Tensor& reference) {
  const at::Tensor wanted = at::log1p(reference), got = at::log1p(maps.clamp_min(0));
  return {((got - wanted) / (wanted + kMapEpsilon)).square().mean().item<double>(),
          (got - wanted).square().mean().item<double>(),
          (maps - reference).square().mean().item<double>()};
}

void MapErrors::add(const MapErrors& of, double share) {
  logrel += share * of.logrel;
  log_mse += share * of.log_mse;
  mse += share * of.mse;
}

at::Tensor first_of(const at::Tensor& maps) { return maps.select(1, 0).contiguous(); }

HarmonicBaselines::HarmonicBaselines(const data::IncidentField& field, int highest,
                                     std::vector<HarmonicErrors>* out)
    : out_(out) {
  std::vector<double> solid_angle;
  const auto cells = static_cast<double>(field.direction.size());
  for (const float pdf : field.pdf) solid_angle.push_back(1 / (cells * pdf));
  for (const HarmonicFit fit :
       {HarmonicFit::Projected, HarmonicFit::Windowed, HarmonicFit::LeastSquares}) {
    for (int degree = 0; degree <= highest; ++degree) {
      fitters_.emplace_back(degree, fit, field.direction, solid_angle);
      out_->push_back({fit, degree, {}, 0});
    }
  }
}

void HarmonicBaselines::add_scene(const at::Tensor& reference, double share, MapRow* row) {
  const at::Tensor tables = reference.flatten(1);
  for (size_t i = 0; i < fitters_.size(); ++i) {
    const at::Tensor fitted = fitters_[i].reconstruct(tables).view(reference.sizes());
    HarmonicErrors& h = (*out_)[i];
    const bool shown =
        h.degree == kShown || (h.degree == kShownHighest && h.fit != HarmonicFit::Windowed);
    if (row != nullptr && shown)
      row->maps.emplace_back(concat("l ≤ ", h.degree, " ", enum_name(h.fit)), first_of(fitted));
    h.errors.add(errors_of(fitted, reference), share);
    h.negative += share * (fitted < 0).to(at::kDouble).mean().item<double>();
  }
}

GaussianBaselines::GaussianBaselines(const data::IncidentField& field,
                                     const std::vector<int>& lobes,
                                     std::vector<GaussianErrors>* out)
    : directions_(direction_table(field.direction)), lobes_(lobes), out_(out) {
  for (const GaussianFit fit : {GaussianFit::Lattice, GaussianFit::Greedy}) {
    for (const int count : lobes) out_->push_back({fit, count, {}});
  }
}

void GaussianBaselines::add_scene(const at::Tensor& reference, double share, MapRow* row) {
  const at::Tensor maps = reference.transpose(0, 1).contiguous();
  std::vector<GaussianSums> sums;
  for (const int count : lobes_) sums.push_back(fit_lattice(count, directions_, maps));
  for (GaussianSums& greedy : fit_greedily(lobes_, directions_, maps))
    sums.push_back(std::move(greedy));
  for (size_t i = 0; i < sums.size(); ++i) {
    const at::Tensor fitted = sums[i].values(directions_).transpose(0, 1).contiguous();
    GaussianErrors& g = (*out_)[i];
    if (row != nullptr && g.numbers() == kShownNumbers)
      row->maps.emplace_back(concat(g.lobes, " Gaussians ", enum_name(g.fit)), first_of(fitted));
    g.errors.add(errors_of(fitted, reference), share);
  }
}

}  // namespace lte::experiments
