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

// Of directions that enter before the attention, with what their rays see.
constexpr const char* kTold = R"SCRIPT(    attributes = torch.cat([attributes, told], 1)
)SCRIPT";

// What comes of a query's neighbours before the layers: for the sum over them S1 and S2 of all
// layers at once, for the softmax the encoded offsets, which each layer reads anew.
constexpr const char* kSums = R"SCRIPT(    s1, s2 = self.neighbour_sums(
        embedding['{table}'], hidden, self.{d}_gamma_output_weight,
        self.{d}_gamma_output_bias, index))SCRIPT";
constexpr const char* kPlaces = R"SCRIPT(    place = torch.linear(
        hidden, self.{d}_gamma_output_weight, self.{d}_gamma_output_bias))SCRIPT";

// Joined to the offset: the cosines of the normals with each other and with it.
constexpr const char* kNormals = R"SCRIPT(    here = queries[:, 3:6].unsqueeze(1)
    there = embedding['normal'][index]
    facing = torch.sum(here * there, [2], True)
    above = torch.sum(here * offset, [2], True)
    ahead = torch.sum(there * offset, [2], True)
    offset = torch.cat([offset, facing, above, ahead], 2)
)SCRIPT";

constexpr const char* kSumAttention = "(q * s1[{l}] + s2[{l}]) / float(index.size(1))";
constexpr const char* kSoftmaxAttention =
    "self.softmax_attention(\n"
    "        q, embedding['{table}'][0][{l}], embedding['{table}'][1][{l}], place, index,\n"
    "        self.{p}_weight_hidden_weight, self.{p}_weight_hidden_bias,\n"
    "        self.{p}_weight_output_weight, self.{p}_weight_output_bias)";

constexpr const char* kSoftmax = R"SCRIPT(
def softmax_attention(self, q: Tensor, keys: Tensor, values: Tensor, place: Tensor, index: Tensor,
                      w0: Tensor, b0: Tensor, w1: Tensor, b1: Tensor) -> Tensor:
    weight = torch.softmax(self.mlp(q.unsqueeze(1) - keys[index] + place, w0, b0, w1, b1), 1)
    return torch.sum(weight * (values[index] + place), [1])
)SCRIPT";

constexpr const char* kLayer =
    R"SCRIPT(    x = self.norm(g, self.{p}_norm1_weight, self.{p}_norm1_bias)
    q = torch.linear(x, self.{p}_query_weight, self.{p}_query_bias)
    attended = {attention}
    g = g + torch.linear(attended, self.{p}_output_weight, self.{p}_output_bias)
    x = self.norm(g, self.{p}_norm2_weight, self.{p}_norm2_bias)
    g = g + self.mlp(
        x, self.{p}_ffn_hidden_weight, self.{p}_ffn_hidden_bias,
        self.{p}_ffn_output_weight, self.{p}_ffn_output_bias)
)SCRIPT";

constexpr const char* kGather = R"SCRIPT(
def {name}(self, embedding: Dict[str, Tensor], queries: Tensor{argument}) -> Tuple[Tensor, Tensor]:
    anchors = embedding['position']
    position = (queries[:, 0:3] - embedding['origin']) / {scale}
    index = self.nearest(position, anchors, {neighbours})
    offset = (position.unsqueeze(1) - anchors[index]) * (1.0 / float(embedding['spacing']))
    offset = torch.clamp(offset, -{offset_limit}, {offset_limit})
{normals}    hidden = self.gelu(torch.linear(
        offset, self.{d}_gamma_hidden_weight, self.{d}_gamma_hidden_bias))
{gather}
    attributes = self.attributes(position, queries[:, 3:6], queries[:, 6:9])
{use_cache}{told}    g = self.mlp(
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

/// @param told  whether queries are told more than what they are
std::string gather(const Decoder& decoder, const nn::ModelConfig& config, bool told = false) {
  const bool softmax = config.normalizes_attention();
  std::string layers;
  for (int64_t l = 0; l < config.query_layers; ++l) {
    layers += fill(kLayer, {{"attention", softmax ? kSoftmaxAttention : kSumAttention},
                            {"p", "{d}_layer" + std::to_string(l)},
                            {"l", std::to_string(l)}});
  }
  return fill(kGather, {{"scale", number(config.scale)},
                        {"neighbours", std::to_string(config.query_neighbours)},
                        {"offset_limit", number(nn::kOffsetLimit)},
                        {"normals", config.reads_normals() ? kNormals : ""},
                        {"gather", softmax ? kPlaces : kSums},
                        {"use_cache", config.reads_indirect() ? kUseCache : kNoCache},
                        {"argument", told ? ", told: Tensor" : ""},
                        {"told", told ? kTold : ""},
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
      "    embedding['{table}'] = {joined}\n",
      {{"keys", keys},
       {"values", values},
       {"table", decoder.table},
       {"joined", config.normalizes_attention() ? "torch.stack([keys, values])"
                                                : "self.neighbour_table(keys, values)"}});
}

}  // namespace

std::string decoder_source(const nn::ModelConfig& config) {
  return (config.normalizes_attention() ? kSoftmax : "") +
         (config.reads_indirect() ? read_cache_source(config) : "") + gather(kIrradiance, config) +
         (config.predicts_radiance() ? gather(kRadiance, config, config.enters_early()) : "") +
         fill(kDecode, {{"rows", std::to_string(kQueryRows)}});
}

std::string tables_source(const nn::ModelConfig& config) {
  return table(kIrradiance, config) + (config.predicts_radiance() ? table(kRadiance, config) : "");
}

}  // namespace lte::torchscript
