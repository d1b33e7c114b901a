#include "lte/torchscript/cache.h"

#include "lte/nn/constants.h"
#include "lte/torchscript/text.h"

namespace lte::torchscript {
namespace {

// The light on the front and on the back of a surface.
constexpr const char* kReadLight =
    R"SCRIPT(    {kind}_sides = [points[:, {both}:{both} + 3] - points[:, {back}:{back} + 3],
        points[:, {back}:{back} + 3]]
    for side in {kind}_sides:
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
    cache_normal = torch.cat([cache_normal, cache_normal * -{back}], 1)
    embedding['cache_position'] = position[dark].contiguous()
    embedding['cache_normal'] = cache_normal
    embedding['cache_light'] = light
{errors})SCRIPT";

constexpr const char* kNoise = R"SCRIPT(    error = embedding['cache_error'][index]
    error = torch.where(back, error[:, :, 1:2], error[:, :, 0:1]) * gray
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
    product = torch.bmm(normals[:, :, 0:3], up)
    behind = torch.bmm(normals[:, :, 3:6], up)
    back = behind > product
    product = torch.where(back, behind, product)
    whole = torch.sum(light, [1])
    light = torch.where(back, light[:, :, 6:12], light[:, :, 0:6])
    other = whole[:, 0:6] + whole[:, 6:12] - torch.sum(light, [1])
    facing = torch.clamp_min(product.squeeze(2), 0.0)
    distance2 = torch.sum(offset * offset, [2])
    height = torch.bmm(offset, up).squeeze(2)
    scale = torch.clamp_min(torch.mean(distance2, [1], True), {least_distance2})
    facing2 = facing * facing
    falloff = torch.exp(-({near} * distance2 + {plane} * height * height) / scale)
    weight = facing2 * facing2 * falloff + {least}
    total = torch.sum(weight, [1], True)
    share = weight / total
    mean = self.weighted(share, light) + other * {least} / total
    gray = torch.mean(light[:, :, 0:3], [2], True)
    grey_mean = torch.mean(mean[:, 0:3], [1], True)
    difference = gray - grey_mean.unsqueeze(1)
    variance = self.weighted(share, difference * difference)
    spread = torch.sqrt(variance) / (grey_mean + {least_mean})
    contrast = torch.log1p(torch.mean(gray, [1])) - torch.log1p(grey_mean)
    features = torch.cat([
        torch.log1p(mean),
        torch.log1p(spread),
        torch.log(total) / {log_scale},
        torch.mean(facing, [1], True),
        torch.mean(height / torch.sqrt(scale), [1], True),
        contrast,
        (torch.log(scale) + {log_shift}) / {log_scale}], 1)
{noise}    stored = embedding['cache_light']
    floor = {floor} * torch.mean(stored[:, 0:3] + stored[:, 6:9], [0])
    return mean[:, 0:3] + floor, features
)SCRIPT";

}  // namespace

int64_t light_columns(const nn::ModelConfig& config) {
  return (config.reads_light() ? 12 : 0) + (config.reads_estimates() ? 2 : 0);
}

std::string light_column_names(const nn::ModelConfig& config) {
  if (!config.reads_light()) return "";
  return std::string(
             ", direct irradiance, indirect irradiance, direct irradiance of the back, indirect "
             "irradiance of the back") +
         (config.reads_estimates() ? ", errors of front and back" : "");
}

std::string read_light_source(const nn::ModelConfig& config) {
  if (!config.reads_light()) return "";
  std::string lines;
  for (int64_t i = 0; i < 2; ++i) {
    lines += fill(kReadLight, {{"kind", i == 0 ? "direct" : "indirect"},
                               {"both", std::to_string(kPointColumns + 3 * i)},
                               {"back", std::to_string(kPointColumns + 3 * (2 + i))}});
  }
  if (config.reads_estimates())
    lines += fill(kErrors, {{"from", std::to_string(kPointColumns + 12)}});
  return lines;
}

std::string fill_cache_source(const nn::ModelConfig& config) {
  if (!config.reads_light()) return "";
  return fill(kFillCache, {{"back", number(nn::kPriorBack)},
                           {"errors", config.reads_estimates()
                                          ? fill("    embedding['cache_error'] = "
                                                 "points[:, {from}:{from} + 2][dark]\n",
                                                 {{"from", std::to_string(kPointColumns + 12)}})
                                          : ""}});
}

std::string read_cache_source(const nn::ModelConfig& config) {
  const ops::PriorWeights& weights = nn::kPriorWeights;
  const int64_t features = nn::kLightFeatures + (config.reads_estimates() ? 1 : 0);
  return fill(kReadCache,
              {{"features", std::to_string(features)},
               {"neighbours", std::to_string(nn::kPriorNeighbours)},
               {"noise", config.reads_estimates()
                             ? fill(kNoise, {{"least_mean", number(nn::kPriorScales.least_mean)}})
                             : ""},
               {"near", number(weights.near)},
               {"plane", number(weights.plane)},
               {"least", number(weights.least)},
               {"least_distance2", number(weights.least_distance2)},
               {"least_mean", number(nn::kPriorScales.least_mean)},
               {"log_scale", number(nn::kPriorScales.log)},
               {"log_shift", number(nn::kPriorScales.log_shift)},
               {"floor", number(nn::kPriorFloor)}});
}

}  // namespace lte::torchscript
