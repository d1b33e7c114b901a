#include "lte/torchscript/radiance.h"

#include <numbers>

#include "lte/torchscript/decoder.h"
#include "lte/torchscript/rays.h"
#include "lte/torchscript/text.h"

namespace lte::torchscript {
namespace {

/// Directions decoded at a time: keeps their lobes within some 30 MB.
constexpr int64_t kDirectionRows = int64_t{1} << 17;

constexpr const char* kDirections = R"SCRIPT(
def factor(self, features: Tensor, directions: Tensor, seen: List[Tensor]) -> Tensor:
    own = torch.linear(features, self.radiance_lobes_weight, self.radiance_lobes_bias)
    axis = torch.reshape(own[:, 0:3 * {k}], [-1, {k}, 3])
    offset = own[:, 3 * {k}:4 * {k}].unsqueeze(1)
    mixed = own[:, 4 * {k}:5 * {k}].unsqueeze(1)
    lobes = self.gelu(torch.baddbmm(offset, directions, torch.transpose(axis, 1, 2)))
    if len(seen) > 0:
        lobes = torch.cat([lobes, seen[0][:, :, 3:10]], 2)
    hidden = torch.linear(lobes, self.radiance_mix_weight, self.radiance_mix_bias) + mixed
    color = torch.linear(self.gelu(hidden), self.radiance_color_weight, self.radiance_color_bias)
    return torch.softplus(color)
)SCRIPT";

// octahedral_cells() of lte/nn/radiance_decoder.h is written out.
constexpr const char* kMap = R"SCRIPT(
def factor(self, features: Tensor, directions: Tensor, seen: List[Tensor]) -> Tensor:
    cells = torch.linear(features, self.radiance_map_weight, self.radiance_map_bias)
    cells = torch.softplus(cells).view([-1, {k} * {k}, 3])
    flat = directions / torch.sum(torch.abs(directions), [2], True)
    xy = flat[:, :, 0:2]
    side = torch.where(xy >= 0.0, torch.ones_like(xy), -torch.ones_like(xy))
    folded = (1.0 - torch.abs(torch.flip(xy, [2]))) * side
    place = (torch.where(flat[:, :, 2:3] >= 0.0, xy, folded) + 1.0) * (0.5 * {k})
    cell = torch.clamp(torch.floor(place).to(4), 0, {k} - 1)
    index = cell[:, :, 1] * {k} + cell[:, :, 0]
    index = index.unsqueeze(2).expand([index.size(0), index.size(1), 3])
    return torch.gather(cells, 1, index)
)SCRIPT";

constexpr const char* kGaussians = R"SCRIPT(
def factor(self, features: Tensor, directions: Tensor, seen: List[Tensor]) -> Tensor:
    own = torch.linear(features, self.radiance_gaussians_weight, self.radiance_gaussians_bias)
    axis = torch.reshape(own[:, 0:3 * {k}], [-1, {k}, 3])
    length = torch.sqrt(torch.sum(axis * axis, [2], True))
    axis = axis / torch.clamp_min(length, 1e-6)
    sharpness = torch.softplus(own[:, 3 * {k}:4 * {k}]).unsqueeze(1)
    amplitude = torch.reshape(torch.softplus(own[:, 4 * {k}:7 * {k}]), [-1, {k}, 3])
    cosine = torch.bmm(directions, torch.transpose(axis, 1, 2))
    return torch.bmm(torch.exp(sharpness * (cosine - 1.0)), amplitude)
)SCRIPT";

constexpr const char* kCast =
    R"SCRIPT(    position = (queries[:, 0:3] - embedding['origin']) / {scale}
    seen.append(self.seen(embedding, position, directions))
)SCRIPT";

constexpr const char* kLate =
    R"SCRIPT(    features, light = self.gather_radiance(embedding, queries)
    factor = self.factor(features, directions, seen)
    light = light.unsqueeze(1)
)SCRIPT";

// Each direction is a query of its own.
constexpr const char* kEarly = R"SCRIPT(    count = directions.size(1)
    told = torch.reshape(directions, [-1, 3])
    if len(seen) > 0:
        told = torch.cat([told, torch.reshape(seen[0][:, :, 3:10], [-1, 7])], 1)
    each = torch.repeat_interleave(queries, count, 0)
    factor, light = self.gather_radiance(embedding, each, told)
    factor = torch.reshape(factor, [-1, count, factor.size(1)])
    light = torch.reshape(light, [-1, count, 3])
)SCRIPT";

constexpr const char* kRadiance = R"SCRIPT(
def radiance_block(self, embedding: Dict[str, Tensor], queries: Tensor,
                   directions: Tensor) -> Tensor:
    seen: List[Tensor] = []
{cast}{factor}    answer = factor[:, :, 0:3] * light
    if len(seen) > 0:
        answer = answer + factor[:, :, 3:6] * seen[0][:, :, 0:3]
    return answer

def radiance(self, embedding: Dict[str, Tensor], queries: Tensor, directions: Tensor) -> Tensor:
    self.check_queries(queries)
    assert directions.dim() == 3 and directions.size(0) == queries.size(0) \
        and directions.size(2) == 3, 'directions must be [Q, N, 3], of as many queries'
    length = torch.sqrt(torch.sum(directions * directions, [2]))
    assert bool(torch.all(torch.abs(length - 1.0) <= 0.01)), \
        'directions: one is not a unit vector'
    cosine = torch.sum(directions * queries[:, 3:6].unsqueeze(1), [2])
    assert bool(torch.all(cosine >= -0.01)), 'directions: one points into the surface'
    rows = max(1, min({query_rows}, {direction_rows} // max(1, directions.size(1))))
    out: List[Tensor] = [
        torch.zeros([0, directions.size(1), 3], dtype=6, device=queries.device)]
    begin = 0
    while begin < queries.size(0):
        end = begin + rows
        out.append(self.radiance_block(embedding, queries[begin:end], directions[begin:end]))
        begin = end
    return torch.cat(out) * (embedding['radiance'] / {pi}).to(6)
)SCRIPT";

/// The method factor() of late directions.
const char* head_of(const nn::ModelConfig& config) {
  switch (config.radiance_head) {
    case nn::RadianceHead::Directions:
      return kDirections;
    case nn::RadianceHead::Map:
      return kMap;
    case nn::RadianceHead::Gaussians:
      return kGaussians;
    case nn::RadianceHead::Early:
      break;
  }
  return "";
}

}  // namespace

std::string radiance_source(const nn::ModelConfig& config) {
  if (!config.predicts_radiance()) return "";
  // Early directions are queries.
  const int64_t directions = config.enters_early() ? kQueryRows : kDirectionRows;
  return fill(head_of(config), {{"k", std::to_string(config.radiance_lobes)}}) +
         fill(kRadiance,
              {{"cast", config.casts_rays() ? fill(kCast, {{"scale", number(config.scale)}}) : ""},
               {"factor", config.enters_early() ? kEarly : kLate},
               {"query_rows", std::to_string(kQueryRows)},
               {"direction_rows", std::to_string(directions)},
               {"pi", number(std::numbers::pi)}});
}

}  // namespace lte::torchscript
