#include "lte/nn/light_cache.h"

#include <algorithm>

#include <ATen/ATen.h>

#include "lte/nn/constants.h"
#include "lte/ops/irradiance_cache.h"
#include "lte/ops/knn.h"

namespace lte::nn {
namespace {

constexpr int64_t kBlock = 8192;  ///< queries whose pairs are held at a time

/// Weighted means over the neighbours, [Q, C] of weights [Q, k] and values [Q, k, C].
at::Tensor weighted(const at::Tensor& weight, const at::Tensor& values) {
  return at::bmm(weight.unsqueeze(1), values).squeeze(1);
}

const ops::CacheWeights& weights_of(const LightCache& cache) {
  return cache.sides() == 2 ? kApartWeights : kCacheWeights;
}

/// ops::irradiance_cache_means() on any device and in any dtype, for GPUs and gradient checks.
at::Tensor composed_means(const LightCache& cache, const at::Tensor& position,
                          const at::Tensor& normal, const at::Tensor& near) {
  const ops::CacheWeights& weights = weights_of(cache);
  const int64_t Q = near.size(0), k = near.size(1), sides = cache.sides();
  const at::Tensor rows = near.reshape({-1});
  const auto gather = [&](const at::Tensor& of) {
    return of.index_select(0, rows).view({Q, k, of.size(1)});
  };
  const at::Tensor offset = gather(cache.position).sub(position.unsqueeze(1));
  const at::Tensor up = normal.unsqueeze(2);  // [Q, 3, 1]
  const auto cosine = [&](int64_t side) {
    return at::bmm(gather(cache.normal.narrow(1, 3 * side, 3)), up);
  };
  at::Tensor product = cosine(0), back;  // [Q, k, 1]
  if (sides == 2) {
    const at::Tensor behind = cosine(1);
    back = behind > product;
    product = at::where(back, behind, product);
  }
  /// [Q, k, .] of the side that each query reads.
  const auto side_of = [&](const at::Tensor& of) {
    const at::Tensor both = gather(of);
    if (sides == 1) return both;
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
  const at::Tensor light = side_of(cache.light);
  at::Tensor mean = weighted(share, light);
  if (sides == 2) {
    const at::Tensor all = gather(cache.light).sum(1);
    const int64_t columns = light.size(2);
    const at::Tensor both = all.narrow(1, 0, columns) + all.narrow(1, columns, columns);
    mean = mean + (both - light.sum(1)).mul(weights.least).div(total);
  }
  const at::Tensor grey = light.narrow(2, 0, 3).mean(2, /*keepdim=*/true);  // [Q, k, 1]
  const at::Tensor middle = mean.narrow(1, 0, 3).mean(1).view({Q, 1, 1});
  const at::Tensor difference = grey.sub(middle);
  std::vector<at::Tensor> columns = {mean,
                                     weighted(share, difference.square()),
                                     total,
                                     facing.mean(1, /*keepdim=*/true),
                                     height.div(scale.sqrt()).mean(1, /*keepdim=*/true),
                                     grey.mean(1),
                                     scale};
  if (cache.error.defined())
    columns.push_back(weighted(share.square(), grey.mul(side_of(cache.error)).square()));
  return at::cat(columns, 1);
}

at::Tensor means(const LightCache& cache, const at::Tensor& position, const at::Tensor& normal) {
  const at::Tensor near =
      std::get<0>(ops::knn(position.to(at::kFloat).contiguous(), cache.position, kCacheNeighbours));
  if (position.device().is_cpu() && position.scalar_type() == at::kFloat)
    return ops::irradiance_cache_means(position, normal, cache.position, cache.normal, cache.light,
                                       cache.error, near, weights_of(cache));
  return composed_means(cache, position, normal, near);
}

LightReading reading(const at::Tensor& means, const at::Tensor& floor) {
  const auto column = [&](int64_t c) { return means.narrow(1, c, 1); };
  using Column = ops::CacheColumn;
  const at::Tensor light = means.narrow(1, Column::kLight, ops::kCacheLight),
                   irradiance = means.narrow(1, Column::kLight, 3);
  const at::Tensor grey = irradiance.mean(1, /*keepdim=*/true);
  const auto relative = [&](int64_t variance) {
    return column(variance).sqrt().div(grey.add(kCacheLeastMean));
  };
  std::vector<at::Tensor> features = {
      light.log1p(),
      relative(Column::kVariance).log1p(),
      column(Column::kWeight).log().div(kCacheLogScale),
      column(Column::kFacing),
      column(Column::kHeight),
      column(Column::kGrey).log1p().sub(grey.log1p()),
      column(Column::kDistance2).log().add(kCacheLogShift).div(kCacheLogScale)};
  if (means.size(1) > Column::kNoise) features.push_back(relative(Column::kNoise));
  return {irradiance.add(floor), at::cat(features, 1)};
}

/// [S, 6]: the normal of the front, and that of the back, shorter so that it counts for less.
at::Tensor normals_of_sides(const at::Tensor& normal) {
  return at::cat({normal, normal.mul(-kCacheBack)}, 1);
}

}  // namespace

LightReading LightCache::read(const at::Tensor& query, const at::Tensor& facing) const {
  const int64_t Q = query.size(0);
  if (position.size(0) == 0) {
    const int64_t columns = error.defined() ? kMostLightFeatures : kLightFeatures;
    return {at::ones_like(query), at::zeros({Q, columns}, query.options())};
  }
  if (Q <= kBlock) return reading(means(*this, query, facing), floor);
  at::Tensor all = at::empty({Q, ops::kCacheMeans + (error.defined() ? 1 : 0)}, query.options());
  for (int64_t begin = 0; begin < Q; begin += kBlock) {
    const int64_t count = std::min(kBlock, Q - begin);
    all.narrow(0, begin, count)
        .copy_(means(*this, query.narrow(0, begin, count), facing.narrow(0, begin, count)));
  }
  return reading(all, floor);
}

LightCache make_light_cache(const at::Tensor& position, const at::Tensor& normal,
                            const at::Tensor& emission, const at::Tensor& light,
                            const at::Tensor& error) {
  const at::Tensor rows = emission.amax(1).eq(0).nonzero().view({-1});
  LightCache cache;
  cache.position = position.index_select(0, rows).to(at::kFloat).contiguous();
  cache.normal = normal.index_select(0, rows);
  cache.light = light.index_select(0, rows);
  if (error.defined()) cache.error = error.index_select(0, rows);
  const bool apart = light.size(1) == 2 * ops::kCacheLight;
  if (apart) cache.normal = normals_of_sides(cache.normal);
  const at::Tensor front = cache.light.narrow(1, 0, 3);
  const at::Tensor indirect = apart ? front.add(cache.light.narrow(1, ops::kCacheLight, 3)) : front;
  cache.floor =
      rows.size(0) > 0 ? indirect.mean(0).mul(kCacheFloor) : at::zeros({3}, light.options());
  return cache;
}

}  // namespace lte::nn
