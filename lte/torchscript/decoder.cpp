#include "lte/torchscript/decoder.h"

#include "lte/nn/constants.h"
#include "lte/torchscript/cache.h"
#include "lte/torchscript/text.h"

namespace lte::torchscript {
namespace {

constexpr const char* kUseCache =
    R"SCRIPT(    light, features = self.cached(embedding, position, queries[:, 3:6])
    attributes = torch.cat([attributes, features], 1)
)SCRIPT";
constexpr const char* kNoCache = R"SCRIPT(    light = torch.ones_like(position)
)SCRIPT";

// Joined to the offset: the cosines of the normals with each other and with it.
constexpr const char* kNormals = R"SCRIPT(    here = queries[:, 3:6].unsqueeze(1)
    there = embedding['normal'][index]
    facing = torch.sum(here * there, [2], True)
    above = torch.sum(here * offset, [2], True)
    ahead = torch.sum(there * offset, [2], True)
    offset = torch.cat([offset, facing, above, ahead], 2)
)SCRIPT";

constexpr const char* kLayer =
    R"SCRIPT(    x = self.norm(g, self.{p}_norm1_weight, self.{p}_norm1_bias)
    q = torch.linear(x, self.{p}_query_weight, self.{p}_query_bias)
    attended = (q * s1[{l}] + s2[{l}]) / float(index.size(1))
    g = g + torch.linear(attended, self.{p}_output_weight, self.{p}_output_bias)
    x = self.norm(g, self.{p}_norm2_weight, self.{p}_norm2_bias)
    g = g + self.mlp(
        x, self.{p}_ffn_hidden_weight, self.{p}_ffn_hidden_bias,
        self.{p}_ffn_output_weight, self.{p}_ffn_output_bias)
)SCRIPT";

constexpr const char* kGather = R"SCRIPT(
def {name}(self, embedding: Dict[str, Tensor], queries: Tensor) -> Tuple[Tensor, Tensor]:
    anchors = embedding['position']
    position = (queries[:, 0:3] - embedding['origin']) / {scale}
    index = self.nearest(position, anchors, {neighbours})
    offset = (position.unsqueeze(1) - anchors[index]) * (1.0 / float(embedding['spacing']))
    offset = torch.clamp(offset, -{offset_limit}, {offset_limit})
{normals}    hidden = self.gelu(torch.linear(
        offset, self.{d}_gamma_hidden_weight, self.{d}_gamma_hidden_bias))
    s1, s2 = self.neighbour_sums(
        embedding['{table}'], hidden, self.{d}_gamma_output_weight,
        self.{d}_gamma_output_bias, index)
    attributes = self.attributes(position, queries[:, 3:6], queries[:, 6:9])
{use_cache}    g = self.mlp(
        attributes, self.{d}_point_hidden_weight, self.{d}_point_hidden_bias,
        self.{d}_point_output_weight, self.{d}_point_output_bias)
{layers}    g = self.norm(g, self.{d}_norm_weight, self.{d}_norm_bias)
    answer = torch.softplus(self.mlp(
        g, self.{d}_head_hidden_weight, self.{d}_head_hidden_bias,
        self.{d}_head_output_weight, self.{d}_head_output_bias))
    return answer, light
)SCRIPT";

constexpr const char* kDecode = R"SCRIPT(
def check_queries(self, queries: Tensor):
    assert queries.dim() == 2 and queries.size(1) == 9, \
        'queries must be [Q, 9]: position, normal, albedo'
    assert bool(torch.all(torch.isfinite(queries))), 'queries: a value is not finite'

def decode_normalized(self, embedding: Dict[str, Tensor], queries: Tensor) -> Tensor:
    out: List[Tensor] = [torch.zeros([0, 3], dtype=6, device=queries.device)]
    begin = 0
    while begin < queries.size(0):
        answer, light = self.gather_irradiance(embedding, queries[begin:begin + {rows}])
        out.append(answer * light)
        begin += {rows}
    return torch.cat(out)

def decode(self, embedding: Dict[str, Tensor], queries: Tensor) -> Tensor:
    self.check_queries(queries)
    return self.decode_normalized(embedding, queries) * embedding['radiance'].to(6)
)SCRIPT";

/// A query decoder: the method that says what it answers, and where its weights and its table are.
struct Decoder {
  const char *name, *parameters, *table;
};
constexpr Decoder kIrradiance = {"gather_irradiance", "decoder", "table"};
constexpr Decoder kRadiance = {"gather_radiance", "radiance_query", "radiance_table"};

std::string gather(const Decoder& decoder, const nn::ModelConfig& config) {
  std::string layers;
  for (int64_t l = 0; l < config.query_layers; ++l) {
    layers += fill(kLayer, {{"p", "{d}_layer" + std::to_string(l)}, {"l", std::to_string(l)}});
  }
  return fill(kGather, {{"scale", number(config.scale)},
                        {"neighbours", std::to_string(config.query_neighbours)},
                        {"offset_limit", number(nn::kOffsetLimit)},
                        {"normals", config.reads_normals() ? kNormals : ""},
                        {"use_cache", config.reads_light() ? kUseCache : kNoCache},
                        {"layers", layers},
                        {"name", decoder.name},
                        {"d", decoder.parameters},
                        {"table", decoder.table}});
}

std::string table(const Decoder& decoder, const nn::ModelConfig& config) {
  std::string keys, values;
  for (int64_t l = 0; l < config.query_layers; ++l) {
    const auto product = [&](const char* of) {
      return fill(
          "        torch.linear(features, self.{p}_{of}_weight, self.{p}_{of}_bias),\n",
          {{"p", std::string(decoder.parameters) + "_layer" + std::to_string(l)}, {"of", of}});
    };
    keys += product("key");
    values += product("value");
  }
  return fill(
      "    keys = torch.stack([\n{keys}    ])\n"
      "    values = torch.stack([\n{values}    ])\n"
      "    embedding['{table}'] = self.neighbour_table(keys, values)\n",
      {{"keys", keys}, {"values", values}, {"table", decoder.table}});
}

}  // namespace

std::string decoder_source(const nn::ModelConfig& config) {
  return (config.reads_light() ? read_cache_source(config) : "") + gather(kIrradiance, config) +
         (config.predicts_radiance() ? gather(kRadiance, config) : "") +
         fill(kDecode, {{"rows", std::to_string(kQueryRows)}});
}

std::string tables_source(const nn::ModelConfig& config) {
  return table(kIrradiance, config) + (config.predicts_radiance() ? table(kRadiance, config) : "");
}

}  // namespace lte::torchscript
