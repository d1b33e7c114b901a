#include "lte/torchscript/radiance.h"

#include <numbers>

#include "lte/torchscript/decoder.h"
#include "lte/torchscript/rays.h"
#include "lte/torchscript/text.h"

namespace lte::torchscript {
namespace {

/// Directions decoded at a time: keeps their lobes within some 30 MB.
constexpr int64_t kDirectionRows = int64_t{1} << 17;

constexpr const char* kFactor = R"SCRIPT(
def factor(self, features: Tensor, directions: Tensor, seen: Tensor) -> Tensor:
    own = torch.linear(features, self.radiance_lobes_weight, self.radiance_lobes_bias)
    axis = torch.reshape(own[:, 0:3 * {k}], [-1, {k}, 3])
    offset = own[:, 3 * {k}:4 * {k}].unsqueeze(1)
    mixed = own[:, 4 * {k}:5 * {k}].unsqueeze(1)
    lobes = self.gelu(torch.baddbmm(offset, directions, torch.transpose(axis, 1, 2)))
    lobes = torch.cat([lobes, seen[:, :, 3:10]], 2)
    hidden = torch.linear(lobes, self.radiance_mix_weight, self.radiance_mix_bias) + mixed
    color = torch.linear(self.gelu(hidden), self.radiance_color_weight, self.radiance_color_bias)
    return torch.softplus(color)
)SCRIPT";

constexpr const char* kRadiance = R"SCRIPT(
def radiance_block(self, embedding: Dict[str, Tensor], queries: Tensor,
                   directions: Tensor) -> Tensor:
    position = (queries[:, 0:3] - embedding['origin']) / {scale}
    seen = self.seen(embedding, position, directions)
    features, light = self.gather_radiance(embedding, queries)
    factor = self.factor(features, directions, seen)
    return factor[:, :, 0:3] * light.unsqueeze(1) + factor[:, :, 3:6] * seen[:, :, 0:3]

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

}  // namespace

std::string radiance_source(const nn::ModelConfig& config) {
  if (!config.predicts_radiance()) return "";
  return fill(std::string(kFactor) + kRadiance, {{"k", std::to_string(config.radiance_lobes)},
                                                 {"scale", number(config.scale)},
                                                 {"query_rows", std::to_string(kQueryRows)},
                                                 {"direction_rows", std::to_string(kDirectionRows)},
                                                 {"pi", number(std::numbers::pi)}});
}

}  // namespace lte::torchscript
