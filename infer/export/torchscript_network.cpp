#include "infer/export/torchscript_network.h"

#include <algorithm>

#include "infer/export/torchscript_text.h"
#include "infer/export/torchscript_transformer.h"

namespace lte::infer {
namespace {

constexpr const char* kCommon = R"SCRIPT(
def norm(self, x: Tensor, weight: Tensor, bias: Tensor) -> Tensor:
    return torch.layer_norm(x, [x.size(-1)], weight, bias)

def mlp(self, x: Tensor, w0: Tensor, b0: Tensor, w1: Tensor, b1: Tensor) -> Tensor:
    return torch.linear(torch.gelu(torch.linear(x, w0, b0)), w1, b1)

def attributes(self, position: Tensor, normal: Tensor, albedo: Tensor) -> Tensor:
    return torch.cat([torch.clamp(position, -4.0, 4.0) * 4.0, normal, albedo], 1)

def neighbour_max(self, dense: Tensor, center: Tensor, neighbour: Tensor, w0: Tensor, b0: Tensor, w1: Tensor, b1: Tensor) -> Tensor:
    width = dense.size(1)
    of_dense = torch.linear(dense, w0[:, :width])
    of_center = torch.linear(center, w0[:, width:] - w0[:, :width], b0)
    out: List[Tensor] = []
    begin = 0
    while begin < neighbour.size(0):
        pair = of_dense[neighbour[begin:begin + 1024]] + of_center[begin:begin + 1024].unsqueeze(1)
        out.append(torch.amax(torch.linear(torch.gelu(pair), w1, b1), [1]))
        begin += 1024
    return torch.cat(out)
)SCRIPT";

constexpr const char* kQueryLayer = R"SCRIPT(
    q = torch.linear(self.norm(g, self.{p}_norm1_weight, self.{p}_norm1_bias), self.{p}_query_weight, self.{p}_query_bias)
    g = g + torch.linear({attended}, self.{p}_output_weight, self.{p}_output_bias)
    g = g + self.mlp(self.norm(g, self.{p}_norm2_weight, self.{p}_norm2_bias), self.{p}_ffn_hidden_weight, self.{p}_ffn_hidden_bias, self.{p}_ffn_output_weight, self.{p}_ffn_output_bias)
)SCRIPT";

constexpr const char* kEncode = R"SCRIPT(
def compressed(self, light: Tensor, radiance: Tensor) -> Tensor:
    return torch.log1p(light.to(7) / torch.where(radiance > 0.0, radiance, torch.ones_like(radiance))).to(6)

def encode(self, points: Tensor) -> Dict[str, Tensor]:
    assert points.dim() == 2 and points.size(0) >= 1 and points.size(1) == {columns}, 'points must be [M, {columns}]: position, normal, albedo, emission, area{light}'
    assert bool(torch.all(torch.isfinite(points))), 'points: a value is not finite'
    origin = torch.amin(points[:, 0:3], [0])
    position = ((points[:, 0:3] - origin) / {scale}).contiguous()
    assert float(torch.max(position)) <= 1.001, 'points: the scene is larger than the scale of the model, {scale} m'
    emission = points[:, 9:12].to(7)
    area = points[:, 12].to(7)
    radiance = torch.mean(emission, [0])
    if float(torch.sum(area)) > 0.0:
        radiance = torch.mv(torch.t(emission), area) / torch.sum(area)
    x = torch.cat([self.attributes(position, points[:, 3:6], points[:, 6:9]), self.compressed(emission, radiance)], 1)
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
            spacing = max(float(torch.sqrt(insertion[i].to(7))), 1e-6)
            i = 0
        i -= 1
    x = self.mlp(x, self.nne_point_hidden_weight, self.nne_point_hidden_bias, self.nne_point_output_weight, self.nne_point_output_bias)
    y = self.neighbour_max(x, x[picks], self.nearest(halved, position, {k}), self.nne_first_hidden_weight, self.nne_first_hidden_bias, self.nne_first_output_weight, self.nne_first_output_bias)
    y = self.neighbour_max(y, y[:count], self.nearest(anchors, halved, {k}), self.nne_second_hidden_weight, self.nne_second_hidden_bias, self.nne_second_output_weight, self.nne_second_output_bias)
    grid = max({grid} * spacing, float(torch.max(anchors)) / 65535.0)
    cells = torch.clamp(torch.floor(anchors.to(7) / grid), 0.0, 65535.0).to(3).contiguous()
    features = self.transformer(y, cells)
    keys: List[Tensor] = []
    values: List[Tensor] = []
{tables}    embedding: Dict[str, Tensor] = {}
    embedding['position'] = anchors
    embedding['features'] = features
    embedding['table'] = {table}
    embedding['origin'] = origin
    embedding['spacing'] = torch.tensor(spacing, dtype=7)
    embedding['radiance'] = radiance
{cache}    return embedding
)SCRIPT";

/// nn::LightCache.
constexpr const char* kFillCache =
    R"SCRIPT(    dark = torch.nonzero(torch.amax(points[:, 9:12], [1]) == 0.0).view([-1])
    scaled = torch.where(radiance > 0.0, radiance, torch.ones_like(radiance)).to(6)
    embedding['cache_position'] = position[dark].contiguous()
    embedding['cache_normal'] = points[:, 3:6][dark]
    embedding['cache_light'] = torch.cat([points[:, 16:19] / scaled, points[:, 13:16] / scaled], 1)[dark]
)SCRIPT";

constexpr const char* kUseCache =
    R"SCRIPT(    light, features = self.cached(embedding, position, queries[:, 3:6])
    attributes = torch.cat([attributes, features], 1)
)SCRIPT";

constexpr const char* kReadCache = R"SCRIPT(
def weighted(self, weight: Tensor, values: Tensor) -> Tensor:
    return torch.bmm(weight.unsqueeze(1), values).squeeze(1)

def cached(self, embedding: Dict[str, Tensor], position: Tensor, normal: Tensor) -> Tuple[Tensor, Tensor]:
    points = embedding['cache_position']
    if points.size(0) == 0:
        return torch.ones_like(position), torch.zeros([position.size(0), {features}], dtype=6, device=position.device)
    index = self.nearest(position, points, 32)
    offset = points[index] - position.unsqueeze(1)
    up = normal.unsqueeze(2)
    facing = torch.clamp_min(torch.bmm(embedding['cache_normal'][index], up).squeeze(2), 0.0)
    distance2 = torch.sum(offset * offset, [2])
    height = torch.bmm(offset, up).squeeze(2)
    scale = torch.clamp_min(torch.mean(distance2, [1], True), 1e-16)
    facing2 = facing * facing
    weight = facing2 * facing2 * torch.exp(-(2.0 * distance2 + 64.0 * height * height) / scale) + 1e-4
    total = torch.sum(weight, [1], True)
    share = weight / total
    light = embedding['cache_light'][index]
    mean = self.weighted(share, light)
    grey = torch.mean(light[:, :, 0:3], [2], True)
    grey_mean = self.weighted(share, grey)
    difference = grey - grey_mean.unsqueeze(1)
    spread = torch.sqrt(self.weighted(share, difference * difference)) / (grey_mean + 1e-3)
    contrast = torch.log1p(torch.mean(grey, [1])) - torch.log1p(grey_mean)
    features = torch.cat([torch.log1p(mean), torch.log1p(spread), torch.log(total) / 4.0, torch.mean(facing, [1], True), torch.mean(height / torch.sqrt(scale), [1], True), contrast, (torch.log(scale) + 8.0) / 4.0], 1)
    return mean[:, 0:3] + 0.02 * torch.mean(embedding['cache_light'][:, 0:3], [0]), features
)SCRIPT";

/// nn::QueryDecoder's two attentions.
constexpr const char* kSums =
    R"SCRIPT(    s1, s2 = self.neighbour_sums(embedding['table'], hidden, self.decoder_gamma_output_weight, self.decoder_gamma_output_bias, index))SCRIPT";
constexpr const char* kPlaces =
    R"SCRIPT(    place = torch.linear(hidden, self.decoder_gamma_output_weight, self.decoder_gamma_output_bias))SCRIPT";

constexpr const char* kSoftmax = R"SCRIPT(
def softmax_attention(self, q: Tensor, keys: Tensor, values: Tensor, place: Tensor, index: Tensor, w0: Tensor, b0: Tensor, w1: Tensor, b1: Tensor) -> Tensor:
    weight = torch.softmax(self.mlp(q.unsqueeze(1) - keys[index] + place, w0, b0, w1, b1), 1)
    return torch.sum(weight * (values[index] + place), [1])
)SCRIPT";

constexpr const char* kDecode = R"SCRIPT(
def decode_block(self, embedding: Dict[str, Tensor], queries: Tensor) -> Tensor:
    anchors = embedding['position']
    position = (queries[:, 0:3] - embedding['origin']) / {scale}
    index = self.nearest(position, anchors, {k})
    offset = torch.clamp((position.unsqueeze(1) - anchors[index]) * (1.0 / float(embedding['spacing'])), -64.0, 64.0)
    hidden = torch.gelu(torch.linear(offset, self.decoder_gamma_hidden_weight, self.decoder_gamma_hidden_bias))
{gather}
    attributes = self.attributes(position, queries[:, 3:6], queries[:, 6:9])
{cache}    g = self.mlp(attributes, self.decoder_point_hidden_weight, self.decoder_point_hidden_bias, self.decoder_point_output_weight, self.decoder_point_output_bias)
{layers}    g = self.norm(g, self.decoder_norm_weight, self.decoder_norm_bias)
    answer = torch.softplus(self.mlp(g, self.decoder_head_hidden_weight, self.decoder_head_hidden_bias, self.decoder_head_output_weight, self.decoder_head_output_bias))
    return {answer}

def decode(self, embedding: Dict[str, Tensor], queries: Tensor) -> Tensor:
    assert queries.dim() == 2 and queries.size(1) == 9, 'queries must be [Q, 9]: position, normal, albedo'
    assert bool(torch.all(torch.isfinite(queries))), 'queries: a value is not finite'
    out: List[Tensor] = [torch.zeros([0, 3], dtype=6, device=queries.device)]
    begin = 0
    while begin < queries.size(0):
        out.append(self.decode_block(embedding, queries[begin:begin + 4096]))
        begin += 4096
    return torch.cat(out) * embedding['radiance'].to(6)

def forward(self, points: Tensor, queries: Tensor) -> Tensor:
    return self.decode(self.encode(points), queries)
)SCRIPT";

std::string encode_and_decode(const nn::ModelConfig& config) {
  const bool softmax = config.normalizes_attention();
  std::string tables, layers;
  for (int64_t l = 0; l < config.query_layers; ++l) {
    const std::string layer = "decoder_layer" + std::to_string(l);
    tables += fill(
        "    keys.append(torch.linear(features, self.{p}_key_weight, self.{p}_key_bias))\n"
        "    values.append(torch.linear(features, self.{p}_value_weight, self.{p}_value_bias))\n",
        {{"p", layer}});
    layers +=
        fill(kQueryLayer,
             {{"attended",
               softmax ? "self.softmax_attention(q, embedding['table'][0][{l}], "
                         "embedding['table'][1][{l}], place, index, self.{p}_weight_hidden_weight, "
                         "self.{p}_weight_hidden_bias, self.{p}_weight_output_weight, "
                         "self.{p}_weight_output_bias)"
                       : "(q * s1[{l}] + s2[{l}]) / float(index.size(1))"},
              {"p", layer},
              {"l", std::to_string(l)}});
  }
  // Columns of irradiance behind the area.
  const int64_t lights = (config.reads_direct() ? 1 : 0) + (config.reads_indirect() ? 1 : 0);
  std::string irradiance;
  for (int64_t i = 0; i < lights; ++i) {
    irradiance +=
        fill("    x = torch.cat([x, self.compressed(points[:, {from}:{to}], radiance)], 1)\n",
             {{"from", std::to_string(13 + 3 * i)}, {"to", std::to_string(16 + 3 * i)}});
  }
  return fill(kEncode,
              {{"scale", number(config.scale)},
               {"columns", std::to_string(13 + 3 * lights)},
               {"light", std::string(lights > 0 ? ", direct irradiance" : "") +
                             (lights > 1 ? ", indirect irradiance" : "")},
               {"irradiance", irradiance},
               {"cache", config.reads_indirect() ? kFillCache : ""},
               {"k", std::to_string(config.nne_neighbours)},
               {"grid", number(config.grid_per_spacing)},
               {"table", softmax ? "torch.stack([torch.stack(keys), torch.stack(values)])"
                                 : "self.neighbour_table(torch.stack(keys), torch.stack(values))"},
               {"tables", tables}}) +
         (softmax ? kSoftmax : "") +
         (config.reads_indirect()
              ? fill(kReadCache, {{"features", std::to_string(nn::kLightFeatures)}})
              : "") +
         fill(kDecode, {{"scale", number(config.scale)},
                        {"cache", config.reads_indirect() ? kUseCache : ""},
                        {"answer", config.reads_indirect() ? "answer * light" : "answer"},
                        {"k", std::to_string(config.query_neighbours)},
                        {"gather", softmax ? kPlaces : kSums},
                        {"layers", layers.substr(1)}});
}

}  // namespace

std::string torchscript_attribute(const std::string& parameter) {
  std::string name = parameter;
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
}

std::string torchscript_network(const nn::ModelConfig& config) {
  return kCommon + torchscript_transformer(config) + encode_and_decode(config);
}

}  // namespace lte::infer
