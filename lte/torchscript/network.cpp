#include "lte/torchscript/network.h"

#include <algorithm>

#include "lte/nn/constants.h"
#include "lte/ops/curve_codes.h"
#include "lte/torchscript/cache.h"
#include "lte/torchscript/decoder.h"
#include "lte/torchscript/radiance.h"
#include "lte/torchscript/rays.h"
#include "lte/torchscript/text.h"
#include "lte/torchscript/transformer.h"

namespace lte::torchscript {
namespace {

/// Rows of nn::NeighbourMax worked through at a time: keeps its pairs within some 20 MB.
constexpr int64_t kPairRows = 1024;

constexpr const char* kCommon = R"SCRIPT(
def gelu(self, x: Tensor) -> Tensor:
    return torch.gelu(x, approximate='{gelu_form}')

def norm(self, x: Tensor, weight: Tensor, bias: Tensor) -> Tensor:
    return torch.layer_norm(x, [x.size(-1)], weight, bias, {norm_epsilon})

def mlp(self, x: Tensor, w0: Tensor, b0: Tensor, w1: Tensor, b1: Tensor) -> Tensor:
    return torch.linear(self.gelu(torch.linear(x, w0, b0)), w1, b1)

def attributes(self, position: Tensor, normal: Tensor, albedo: Tensor) -> Tensor:
    p = torch.clamp(position, -{position_limit}, {position_limit}) * {position_gain}
    return torch.cat([p, normal, albedo], 1)

def neighbour_max(self, dense: Tensor, center: Tensor, neighbour: Tensor,
                  w0: Tensor, b0: Tensor, w1: Tensor, b1: Tensor) -> Tensor:
    width = dense.size(1)
    of_dense = torch.linear(dense, w0[:, :width])
    of_center = torch.linear(center, w0[:, width:] - w0[:, :width], b0)
    out: List[Tensor] = []
    begin = 0
    while begin < neighbour.size(0):
        end = begin + {rows}
        pair = of_dense[neighbour[begin:end]] + of_center[begin:end].unsqueeze(1)
        out.append(torch.amax(torch.linear(self.gelu(pair), w1, b1), [1]))
        begin = end
    return torch.cat(out)

def compressed(self, light: Tensor, radiance: Tensor) -> Tensor:
    scale = torch.where(radiance > 0.0, radiance, torch.ones_like(radiance))
    return torch.log1p(light.to(7) / scale).to(6)
)SCRIPT";

// Rows are ordered as by nn::in_canonical_order(), in which −0 comes before 0.
// The checks speak of columns, as the caller of the module knows no PointSet.
constexpr const char* kEncode = R"SCRIPT(
def in_order(self, points: Tensor) -> Tensor:
    keys = points.to(7)
    keys = torch.where((keys == 0.0) & torch.signbit(keys), torch.full_like(keys, -1e-60), keys)
    order = torch.arange(points.size(0), device=points.device)
    for i in range(points.size(1)):
        key = keys[:, points.size(1) - 1 - i][order]
        order = order[torch.argsort(key, stable=True, dim=0, descending=False)]
    return points[order]

def encode(self, points: Tensor) -> Dict[str, Tensor]:
    assert points.dim() == 2 and points.size(0) >= 1 and {accepted}, \
        'points must be [M, {columns}]: position, normal, albedo, emission, area{light}{unlit}'
    assert bool(torch.all(torch.isfinite(points))), 'points: a value is not finite'
    points = self.in_order(points)
{solve}    origin = torch.amin(points[:, 0:3], [0])
    position = ((points[:, 0:3] - origin) / {scale}).contiguous()
    assert float(torch.max(position)) <= {largest_position}, \
        'points: the scene is larger than the scale of the model, {scale} m'
    emission = points[:, 9:12].to(7)
    area = points[:, 12].to(7)
    radiance = torch.mean(emission, [0])
    if float(torch.sum(area)) > 0.0:
        radiance = torch.mv(torch.t(emission), area) / torch.sum(area)
    x = self.attributes(position, points[:, 3:6], points[:, 6:9])
    x = torch.cat([x, self.compressed(emission, radiance)], 1)
{irradiance}
    first_count = (position.size(0) + 1) // 2
    count = (first_count + 1) // 2
    picks, insertion = self.farthest_points(position, first_count)
    halved = position[picks]
    anchors = halved[:count].contiguous()
    spacing = 1.0
    i = count - 1
    while i >= 1:
        if float(insertion[i]) > 0.0:
            spacing = max(float(torch.sqrt(insertion[i].to(7))), {least_spacing})
            i = 0
        i -= 1
    x = self.mlp(
        x, self.nne_point_hidden_weight, self.nne_point_hidden_bias,
        self.nne_point_output_weight, self.nne_point_output_bias)
    y = self.neighbour_max(
        x, x[picks], self.nearest(halved, position, {k}),
        self.nne_first_hidden_weight, self.nne_first_hidden_bias,
        self.nne_first_output_weight, self.nne_first_output_bias)
    y = self.neighbour_max(
        y, y[:count], self.nearest(anchors, halved, {k}),
        self.nne_second_hidden_weight, self.nne_second_hidden_bias,
        self.nne_second_output_weight, self.nne_second_output_bias)
    grid = max({grid} * spacing, float(torch.max(anchors)) / {last_cell})
    cells = torch.clamp(torch.floor(anchors.to(7) / grid), 0.0, {last_cell}).to(3).contiguous()
    features = self.transformer(y, cells)
    embedding: Dict[str, Tensor] = {}
    embedding['position'] = anchors
    embedding['features'] = features
{normals}{tables}    embedding['origin'] = origin
    embedding['spacing'] = torch.tensor(spacing, dtype=7)
    embedding['radiance'] = radiance
{fill_cache}{make_surfels}    return embedding
)SCRIPT";

constexpr const char* kSolve = R"SCRIPT(    if points.size(1) == {unlit}:
        points = torch.cat([points[:, 0:{light}], self.solve_light(points), points[:, {light}:]], 1)
)SCRIPT";

constexpr const char* kReadGloss = R"SCRIPT(    gloss = points[:, {from}:{end}]
    assert bool(torch.all((gloss >= 0.0) & (gloss <= 1.0))), \
        'points: metallic or roughness is outside [0, 1]'
    metallic = points[:, {from}:{next}]
    x = torch.cat([x, metallic, metallic * (1.0 - points[:, {next}:{end}])], 1)
)SCRIPT";

constexpr const char* kForward = R"SCRIPT(
def forward(self, points: Tensor, queries: Tensor) -> Tensor:
    return self.decode(self.encode(points), queries)
)SCRIPT";

std::string common() {
  return fill(kCommon, {{"gelu_form", nn::kGeluForm},
                        {"norm_epsilon", number(nn::kNormEpsilon)},
                        {"position_limit", number(nn::kPositionLimit)},
                        {"position_gain", number(nn::kPositionGain)},
                        {"rows", std::to_string(kPairRows)}});
}

/// Joins the columns of F for gloss to x.
std::string read_gloss(const nn::ModelConfig& config) {
  if (!config.predicts_radiance()) return "";
  const int64_t from = kPointColumns + light_columns(config);
  return fill(kReadGloss, {{"from", std::to_string(from)},
                           {"next", std::to_string(from + 1)},
                           {"end", std::to_string(from + 2)}});
}

/// Lines of encode() that solve the light on points that come without.
std::string solve(const nn::ModelConfig& config, int64_t unlit) {
  if (!config.solves_light()) return "";
  return fill(kSolve, {{"unlit", std::to_string(unlit)}, {"light", std::to_string(kPointColumns)}});
}

std::string encode(const nn::ModelConfig& config) {
  constexpr int64_t kLastCell = (int64_t{1} << ops::kCurveBits) - 1;
  const int64_t gloss = config.predicts_radiance() ? nn::kGlossColumns : 0;
  const std::string columns = std::to_string(kPointColumns + light_columns(config) + gloss),
                    unlit = std::to_string(kPointColumns + gloss);
  const bool solves = config.solves_light();
  return fill(
      kEncode,
      {{"scale", number(config.scale)},
       {"largest_position", number(nn::kLargestPosition)},
       {"least_spacing", number(nn::kMinSpacing)},
       {"accepted", solves ? "(points.size(1) == {columns} or points.size(1) == " + unlit + ")"
                           : std::string("points.size(1) == {columns}")},
       {"columns", columns},
       {"unlit", solves ? "; or [M, " + unlit + "] without the light" : ""},
       {"solve", solve(config, kPointColumns + gloss)},
       {"light",
        light_column_names(config) + (config.predicts_radiance() ? ", metallic, roughness" : "")},
       {"irradiance", read_light_source(config) + read_gloss(config)},
       {"fill_cache", fill_cache_source(config)},
       {"make_surfels", make_surfels_source(config)},
       {"k", std::to_string(config.nne_neighbours)},
       {"grid", number(config.grid_per_spacing())},
       {"last_cell", number(kLastCell)},
       {"normals",
        config.reads_normals() ? "    embedding['normal'] = points[:, 3:6][picks[:count]]\n" : ""},
       {"tables", tables_source(config)}});
}

}  // namespace

std::string attribute_of(const std::string& parameter) {
  std::string name = parameter;
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
}

std::string network_source(const nn::ModelConfig& config) {
  return common() + transformer_source(config) + encode(config) + decoder_source(config) +
         rays_source(config) + radiance_source(config) + kForward;
}

}  // namespace lte::torchscript
