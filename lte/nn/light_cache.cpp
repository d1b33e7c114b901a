#include "lte/nn/light_cache.h"

#include <algorithm>

#include <ATen/ATen.h>

#include "lte/ops/knn.h"

namespace lte::nn {
namespace {

// Found on homes by search: more neighbours blur, fewer let noise through.
constexpr int64_t kNeighbours = 32;
constexpr double kNear = 2, kPlane = 64;  ///< of distances from the query, and from its plane
constexpr double kLeastWeight = 1e-4;     ///< where no neighbour faces the query's way
constexpr double kLeastDistance = 1e-16;
constexpr double kFloor = 0.02;   ///< of the mean irradiance
constexpr int64_t kBlock = 4096;  ///< queries whose pairs stay in cache

/// Means over the neighbours, [Q, ...] of [Q, k, ...].
at::Tensor weighted(const at::Tensor& weight, const at::Tensor& values) {
  return at::bmm(weight.unsqueeze(1), values).squeeze(1);
}

LightReading read_block(const LightCache& cache, const at::Tensor& position,
                        const at::Tensor& normal) {
  const at::Tensor near =
      std::get<0>(ops::knn(position.to(at::kFloat).contiguous(), cache.position, kNeighbours));
  const int64_t Q = near.size(0), k = near.size(1);
  const at::Tensor rows = near.reshape({-1});
  const auto gather = [&](const at::Tensor& of) {
    return of.index_select(0, rows).view({Q, k, of.size(1)});
  };
  const at::Tensor offset = gather(cache.position).sub(position.unsqueeze(1));
  const at::Tensor up = normal.unsqueeze(2);  // [Q, 3, 1]
  const at::Tensor facing = at::bmm(gather(cache.normal), up).squeeze(2).clamp_min(0);
  const at::Tensor distance2 = offset.square().sum(2);
  const at::Tensor height = at::bmm(offset, up).squeeze(2);
  const at::Tensor scale = distance2.mean(1, /*keepdim=*/true).clamp_min(kLeastDistance);
  const at::Tensor exponent = distance2.mul(-kNear).sub(height.square(), kPlane).div(scale);
  const at::Tensor weight = facing.square().square().mul(exponent.exp()).add(kLeastWeight);
  const at::Tensor total = weight.sum(1, /*keepdim=*/true), share = weight.div(total);
  const at::Tensor light = gather(cache.light);
  const at::Tensor mean = weighted(share, light);
  const at::Tensor grey = light.narrow(2, 0, 3).mean(2, /*keepdim=*/true);  // [Q, k, 1]
  const at::Tensor grey_mean = weighted(share, grey);                       // [Q, 1]
  const at::Tensor variance =
      weighted(share, grey.sub(grey_mean.unsqueeze(1)).square()).sqrt().div(grey_mean.add(1e-3));
  const at::Tensor contrast = grey.mean(1).log1p().sub(grey_mean.log1p());
  return {
      mean.narrow(1, 0, 3).add(cache.floor),
      at::cat(
          {mean.log1p(), variance.log1p(), total.log().div(4), facing.mean(1, /*keepdim=*/true),
           height.div(scale.sqrt()).mean(1, /*keepdim=*/true), contrast, scale.log().add(8).div(4)},
          1)};
}

}  // namespace

LightReading LightCache::read(const at::Tensor& query, const at::Tensor& facing) const {
  const int64_t Q = query.size(0);
  if (position.size(0) == 0) {
    return {at::ones_like(query), at::zeros({Q, kLightFeatures}, query.options())};
  }
  if (Q <= kBlock) return read_block(*this, query, facing);
  LightReading out{at::empty_like(query), at::empty({Q, kLightFeatures}, query.options())};
  for (int64_t begin = 0; begin < Q; begin += kBlock) {
    const int64_t count = std::min(kBlock, Q - begin);
    const LightReading block =
        read_block(*this, query.narrow(0, begin, count), facing.narrow(0, begin, count));
    out.irradiance.narrow(0, begin, count).copy_(block.irradiance);
    out.features.narrow(0, begin, count).copy_(block.features);
  }
  return out;
}

LightCache make_light_cache(const at::Tensor& position, const at::Tensor& normal,
                            const at::Tensor& emission, const at::Tensor& light) {
  const at::Tensor rows = emission.amax(1).eq(0).nonzero().view({-1});
  LightCache cache;
  cache.position = position.index_select(0, rows).to(at::kFloat).contiguous();
  cache.normal = normal.index_select(0, rows);
  cache.light = light.index_select(0, rows);
  cache.floor = rows.size(0) > 0 ? cache.light.narrow(1, 0, 3).mean(0).mul(kFloor)
                                 : at::zeros({3}, light.options());
  return cache;
}

}  // namespace lte::nn
