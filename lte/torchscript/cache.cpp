#include "lte/torchscript/cache.h"

#include "lte/nn/constants.h"
#include "lte/torchscript/text.h"

namespace lte::torchscript {
namespace {

// Sides of a surface as F and the cache read them: their sum, or front and back.
constexpr const char* kSum = R"SCRIPT(    {kind}_sides = [points[:, {both}:{both} + 3]]
)SCRIPT";
constexpr const char* kApart =
    R"SCRIPT(    {kind}_sides = [points[:, {both}:{both} + 3] - points[:, {back}:{back} + 3],
        points[:, {back}:{back} + 3]]
)SCRIPT";
constexpr const char* kCompress = R"SCRIPT(    for side in {kind}_sides:
        x = torch.cat([x, self.compressed(side, radiance)], 1)
)SCRIPT";
constexpr const char* kErrors = R"SCRIPT(    x = torch.cat([x, points[:, {from}:{from} + 2]], 1)
)SCRIPT";

// Points that emit carry no estimate. Irradiance of a channel without emission stays as it is.
constexpr const char* kFillCache =
    R"SCRIPT(    dark = torch.nonzero(torch.amax(points[:, 9:12], [1]) == 0.0).view([-1])
    scale = torch.where(radiance > 0.0, radiance, torch.ones_like(radiance)).to(6)
    lights: List[Tensor] = []
    for i in range(len(direct_sides)):
        lights.append(indirect_sides[i] / scale)
        lights.append(direct_sides[i] / scale)
    light = torch.cat(lights, 1)[dark]
    cache_normal = points[:, 3:6][dark]
{sides}    embedding['cache_position'] = position[dark].contiguous()
    embedding['cache_normal'] = cache_normal
    embedding['cache_light'] = light
{errors})SCRIPT";

constexpr const char* kNormalsOfSides =
    R"SCRIPT(    cache_normal = torch.cat([cache_normal, cache_normal * -{back}], 1)
)SCRIPT";

// Columns of the side that each query reads; sides are joined along the last axis.
constexpr const char* kOneSide = R"SCRIPT(    product = torch.bmm(normals, up)
)SCRIPT";
constexpr const char* kTwoSides = R"SCRIPT(    product = torch.bmm(normals[:, :, 0:3], up)
    behind = torch.bmm(normals[:, :, 3:6], up)
    back = behind > product
    product = torch.where(back, behind, product)
    whole = torch.sum(light, [1])
    light = torch.where(back, light[:, :, 6:12], light[:, :, 0:6])
    other = whole[:, 0:6] + whole[:, 6:12] - torch.sum(light, [1])
)SCRIPT";
constexpr const char* kNoise = R"SCRIPT(    error = embedding['cache_error'][index]
    error = torch.where(back, error[:, :, 1:2], error[:, :, 0:1]) * grey
    noise = torch.sqrt(self.weighted(share * share, error * error)) / (grey_mean + {least_mean})
    features = torch.cat([features, noise], 1)
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
    normals = embedding['cache_normal'][index]
    light = embedding['cache_light'][index]
{sides}    facing = torch.clamp_min(product.squeeze(2), 0.0)
    distance2 = torch.sum(offset * offset, [2])
    height = torch.bmm(offset, up).squeeze(2)
    scale = torch.clamp_min(torch.mean(distance2, [1], True), {least_distance2})
    facing2 = facing * facing
    falloff = torch.exp(-({near} * distance2 + {plane} * height * height) / scale)
    weight = facing2 * facing2 * falloff + {least}
    total = torch.sum(weight, [1], True)
    share = weight / total
    mean = self.weighted(share, light)
{other}    grey = torch.mean(light[:, :, 0:3], [2], True)
    grey_mean = torch.mean(mean[:, 0:3], [1], True)
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
{noise}    stored = embedding['cache_light']
    floor = {floor} * torch.mean({stored}, [0])
    return mean[:, 0:3] + floor, features
)SCRIPT";

}  // namespace

int64_t light_columns(const nn::ModelConfig& config) {
  const int64_t kinds = (config.reads_direct() ? 1 : 0) + (config.reads_indirect() ? 1 : 0);
  return 3 * kinds * config.light_columns() + (config.light_variance ? 2 : 0);
}

std::string light_column_names(const nn::ModelConfig& config) {
  std::string names;
  for (const char* side : {"", " of the back"}) {
    if (*side != 0 && !config.parts_sides()) continue;
    if (config.reads_direct()) names += std::string(", direct irradiance") + side;
    if (config.reads_indirect()) names += std::string(", indirect irradiance") + side;
  }
  return names + (config.light_variance ? ", errors of front and back" : "");
}

std::string read_light_source(const nn::ModelConfig& config) {
  const int64_t kinds = (config.reads_direct() ? 1 : 0) + (config.reads_indirect() ? 1 : 0);
  std::string lines;
  for (int64_t i = 0; i < kinds; ++i) {
    lines += fill(std::string(config.parts_sides() ? kApart : kSum) + kCompress,
                  {{"kind", i == 0 ? "direct" : "indirect"},
                   {"both", std::to_string(kPointColumns + 3 * i)},
                   {"back", std::to_string(kPointColumns + 3 * (kinds + i))}});
  }
  if (config.light_variance)
    lines += fill(kErrors, {{"from", std::to_string(kPointColumns + light_columns(config) - 2)}});
  return lines;
}

std::string fill_cache_source(const nn::ModelConfig& config) {
  if (!config.reads_indirect()) return "";
  const int64_t errors = kPointColumns + light_columns(config) - 2;
  return fill(
      kFillCache,
      {{"sides",
        config.parts_sides() ? fill(kNormalsOfSides, {{"back", number(nn::kCacheBack)}}) : ""},
       {"errors", config.light_variance ? fill("    embedding['cache_error'] = "
                                               "points[:, {from}:{from} + 2][dark]\n",
                                               {{"from", std::to_string(errors)}})
                                        : ""}});
}

std::string read_cache_source(const nn::ModelConfig& config) {
  const ops::CacheWeights& weights = config.parts_sides() ? nn::kApartWeights : nn::kCacheWeights;
  const int64_t features = nn::kLightFeatures + (config.light_variance ? 1 : 0);
  return fill(
      kReadCache,
      {{"features", std::to_string(features)},
       {"neighbours", std::to_string(nn::kCacheNeighbours)},
       {"sides", config.parts_sides() ? kTwoSides : kOneSide},
       {"other", config.parts_sides() ? fill("    mean = mean + other * {least} / total\n",
                                             {{"least", number(weights.least)}})
                                      : ""},
       {"noise",
        config.light_variance ? fill(kNoise, {{"least_mean", number(nn::kCacheLeastMean)}}) : ""},
       {"stored", config.parts_sides() ? "stored[:, 0:3] + stored[:, 6:9]" : "stored[:, 0:3]"},
       {"near", number(weights.near)},
       {"plane", number(weights.plane)},
       {"least", number(weights.least)},
       {"least_distance2", number(weights.least_distance2)},
       {"least_mean", number(nn::kCacheLeastMean)},
       {"log_scale", number(nn::kCacheLogScale)},
       {"log_shift", number(nn::kCacheLogShift)},
       {"floor", number(nn::kCacheFloor)}});
}

}  // namespace lte::torchscript
