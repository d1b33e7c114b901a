#include "lte/nn/points/light_prior.h"

#include <algorithm>

#include "lte/nn/constants.h"
#include "lte/ops/knn.h"
#include "lte/ops/light_prior.h"
#include "lte/tensor/functions.h"

namespace lte::nn {
namespace {

constexpr int64_t kBlock = 8192;  ///< queries whose pairs are held at a time

/// Weighted means over the neighbours, [Q, C] of weights [Q, k] and values [Q, k, C].
at::Tensor weighted(const at::Tensor& weight, const at::Tensor& values) {
  return at::bmm(weight.unsqueeze(1), values).squeeze(1);
}

/// ops::light_prior_means() on any device and in any dtype, for GPUs and gradient checks.
at::Tensor composed_means(const LightPrior& prior, const at::Tensor& position,
                          const at::Tensor& normal, const at::Tensor& near) {
  const ops::PriorWeights& weights = kPriorWeights;
  const int64_t Q = near.size(0), k = near.size(1);
  const at::Tensor rows = near.reshape({-1});
  const auto gather = [&](const at::Tensor& of) {
    return of.index_select(0, rows).view({Q, k, of.size(1)});
  };
  const at::Tensor offset = gather(prior.position).sub(position.unsqueeze(1));
  const at::Tensor up = normal.unsqueeze(2);  // [Q, 3, 1]
  const auto cosine = [&](int64_t side) {
    return at::bmm(gather(prior.normal.narrow(1, 3 * side, 3)), up);
  };
  const at::Tensor front = cosine(0), behind = cosine(1), back = behind > front;  // [Q, k, 1]
  const at::Tensor product = at::where(back, behind, front);
  /// [Q, k, .] of the side that each query reads.
  const auto side_of = [&](const at::Tensor& of) {
    const at::Tensor both = gather(of);
    const int64_t columns = of.size(1) / 2;
    return at::where(back, both.narrow(2, columns, columns), both.narrow(2, 0, columns));
  };
  const at::Tensor facing = product.squeeze(2).clamp_min(0);
  const at::Tensor distance2 = offset.square().sum(2);
  const at::Tensor height = at::bmm(offset, up).squeeze(2);
  const at::Tensor scale = distance2.mean(1, /*keepdim=*/true).clamp_min(weights.least_distance2);
  const at::Tensor exponent =
      distance2.mul(-weights.near).sub(height.square(), weights.plane).div(scale);
  const at::Tensor weight = facing.square().square().mul(exponent.exp()).add(weights.least);
  const at::Tensor total = weight.sum(1, /*keepdim=*/true), share = weight.div(total);
  const at::Tensor light = side_of(prior.light);
  const at::Tensor all = gather(prior.light).sum(1);
  const int64_t columns = light.size(2);
  const at::Tensor both = all.narrow(1, 0, columns) + all.narrow(1, columns, columns);
  const at::Tensor mean =
      weighted(share, light) + (both - light.sum(1)).mul(weights.least).div(total);
  const at::Tensor gray = light.narrow(2, 0, 3).mean(2, /*keepdim=*/true);  // [Q, k, 1]
  const at::Tensor middle = mean.narrow(1, 0, 3).mean(1).view({Q, 1, 1});
  const at::Tensor difference = gray.sub(middle);
  std::vector<at::Tensor> means = {mean,
                                   weighted(share, difference.square()),
                                   total,
                                   facing.mean(1, /*keepdim=*/true),
                                   height.div(scale.sqrt()).mean(1, /*keepdim=*/true),
                                   gray.mean(1),
                                   scale};
  if (prior.error.defined())
    means.push_back(weighted(share.square(), gray.mul(side_of(prior.error)).square()));
  return at::cat(means, 1);
}

at::Tensor means(const LightPrior& prior, const at::Tensor& position, const at::Tensor& normal) {
  const at::Tensor query = position.to(at::kFloat).contiguous();
  const at::Tensor near =
      std::get<0>(prior.nearest ? prior.nearest->search(query)
                                : ops::knn(query, prior.position, kPriorNeighbours));
  if (position.device().is_cpu() && position.scalar_type() == at::kFloat)
    return ops::light_prior_means(position, normal, prior.position, prior.normal, prior.light,
                                  prior.error, near, kPriorWeights);
  return composed_means(prior, position, normal, near);
}

/// ops::light_prior_features() likewise.
at::Tensor composed_features(const at::Tensor& means) {
  const auto column = [&](int64_t c) { return means.narrow(1, c, 1); };
  using Column = ops::PriorColumn;
  const at::Tensor light = means.narrow(1, Column::kLight, ops::kPriorLight);
  const at::Tensor gray = light.narrow(1, 0, 3).mean(1, /*keepdim=*/true);
  const auto relative = [&](int64_t variance) {
    return column(variance).sqrt().div(gray.add(kPriorScales.least_mean));
  };
  std::vector<at::Tensor> features = {
      light.log1p(),
      relative(Column::kVariance).log1p(),
      column(Column::kWeight).log().div(kPriorScales.log),
      column(Column::kFacing),
      column(Column::kHeight),
      column(Column::kGray).log1p().sub(gray.log1p()),
      column(Column::kDistance2).log().add(kPriorScales.log_shift).div(kPriorScales.log)};
  if (means.size(1) > Column::kNoise) features.push_back(relative(Column::kNoise));
  return at::cat(features, 1);
}

LightReading reading(const at::Tensor& means, const at::Tensor& floor) {
  const bool fused = means.is_cpu() && means.scalar_type() == at::kFloat;
  return {means.narrow(1, ops::PriorColumn::kLight, 3).add(floor),
          fused ? ops::light_prior_features(means, kPriorScales) : composed_features(means)};
}

}  // namespace

LightReading LightPrior::read(const at::Tensor& query, const at::Tensor& facing) const {
  const int64_t Q = query.size(0);
  if (position.size(0) == 0) {
    const int64_t columns = error.defined() ? kLightFeatures + 1 : kLightFeatures;
    return {at::ones_like(query), at::zeros({Q, columns}, query.options())};
  }
  if (Q <= kBlock) return reading(means(*this, query, facing), floor);
  at::Tensor all = at::empty({Q, ops::kPriorMeans + (error.defined() ? 1 : 0)}, query.options());
  for (int64_t begin = 0; begin < Q; begin += kBlock) {
    const int64_t count = std::min(kBlock, Q - begin);
    all.narrow(0, begin, count)
        .copy_(means(*this, query.narrow(0, begin, count), facing.narrow(0, begin, count)));
  }
  return reading(all, floor);
}

void LightPrior::make_index() {
  if (position.is_cpu() && position.size(0) > 0)
    nearest = std::make_shared<const ops::KnnIndex>(position, kPriorNeighbours);
}

LightPrior make_light_prior(const at::Tensor& position, const at::Tensor& normal,
                            const at::Tensor& emission, const at::Tensor& light,
                            const at::Tensor& error) {
  const at::Tensor rows = emission.amax(1).eq(0).nonzero().view({-1});
  LightPrior prior;
  prior.position = position.index_select(0, rows).to(at::kFloat).contiguous();
  const at::Tensor front = normal.index_select(0, rows);
  prior.normal = at::cat({front, front.mul(-kPriorBack)}, 1);
  prior.light = light.index_select(0, rows);
  if (error.defined()) prior.error = error.index_select(0, rows);
  const at::Tensor indirect =
      prior.light.narrow(1, 0, 3).add(prior.light.narrow(1, ops::kPriorLight, 3));
  prior.floor = rows.size(0) > 0 ? indirect.mean(0, /*keepdim=*/false, at::kDouble)
                                       .mul(kPriorFloor)
                                       .to(light.scalar_type())
                                 : at::zeros({3}, light.options());
  prior.make_index();
  return prior;
}

}  // namespace lte::nn
