#include "infer/export/torchscript_cache.h"

#include "infer/export/torchscript_text.h"
#include "lte/nn/config.h"
#include "lte/nn/constants.h"

namespace lte::infer {
namespace {

// Points that emit carry no estimate. Irradiance of a channel without emission stays as it is.
constexpr const char* kFillCache =
    R"SCRIPT(    dark = torch.nonzero(torch.amax(points[:, 9:12], [1]) == 0.0).view([-1])
    scale = torch.where(radiance > 0.0, radiance, torch.ones_like(radiance)).to(6)
    light = torch.cat([points[:, 16:19] / scale, points[:, 13:16] / scale], 1)
    embedding['cache_position'] = position[dark].contiguous()
    embedding['cache_normal'] = points[:, 3:6][dark]
    embedding['cache_light'] = light[dark]
)SCRIPT";

constexpr const char* kReadCache = R"SCRIPT(
def weighted(self, weight: Tensor, values: Tensor) -> Tensor:
    return torch.bmm(weight.unsqueeze(1), values).squeeze(1)

def cached(self, embedding: Dict[str, Tensor], position: Tensor,
           normal: Tensor) -> Tuple[Tensor, Tensor]:
    points = embedding['cache_position']
    if points.size(0) == 0:
        nothing = torch.zeros([position.size(0), {features}], dtype=6, device=position.device)
        return torch.ones_like(position), nothing
    index = self.nearest(position, points, {neighbours})
    offset = points[index] - position.unsqueeze(1)
    up = normal.unsqueeze(2)
    facing = torch.clamp_min(torch.bmm(embedding['cache_normal'][index], up).squeeze(2), 0.0)
    distance2 = torch.sum(offset * offset, [2])
    height = torch.bmm(offset, up).squeeze(2)
    scale = torch.clamp_min(torch.mean(distance2, [1], True), {least_distance2})
    facing2 = facing * facing
    falloff = torch.exp(-({near} * distance2 + {plane} * height * height) / scale)
    weight = facing2 * facing2 * falloff + {least}
    total = torch.sum(weight, [1], True)
    share = weight / total
    light = embedding['cache_light'][index]
    mean = self.weighted(share, light)
    grey = torch.mean(light[:, :, 0:3], [2], True)
    grey_mean = self.weighted(share, grey)
    difference = grey - grey_mean.unsqueeze(1)
    variance = self.weighted(share, difference * difference)
    spread = torch.sqrt(variance) / (grey_mean + {least_mean})
    contrast = torch.log1p(torch.mean(grey, [1])) - torch.log1p(grey_mean)
    features = torch.cat([
        torch.log1p(mean),
        torch.log1p(spread),
        torch.log(total) / {log_scale},
        torch.mean(facing, [1], True),
        torch.mean(height / torch.sqrt(scale), [1], True),
        contrast,
        (torch.log(scale) + {log_shift}) / {log_scale}], 1)
    floor = {floor} * torch.mean(embedding['cache_light'][:, 0:3], [0])
    return mean[:, 0:3] + floor, features
)SCRIPT";

}  // namespace

std::string torchscript_fill_cache() { return kFillCache; }

std::string torchscript_read_cache() {
  return fill(kReadCache, {{"features", std::to_string(nn::kLightFeatures)},
                           {"neighbours", std::to_string(nn::kCacheNeighbours)},
                           {"near", number(nn::kCacheWeights.near)},
                           {"plane", number(nn::kCacheWeights.plane)},
                           {"least", number(nn::kCacheWeights.least)},
                           {"least_distance2", number(nn::kCacheWeights.least_distance2)},
                           {"least_mean", number(nn::kCacheLeastMean)},
                           {"log_scale", number(nn::kCacheLogScale)},
                           {"log_shift", number(nn::kCacheLogShift)},
                           {"floor", number(nn::kCacheFloor)}});
}

}  // namespace lte::infer
