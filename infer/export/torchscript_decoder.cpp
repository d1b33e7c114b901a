#include "infer/export/torchscript_decoder.h"

#include "infer/export/torchscript_cache.h"
#include "infer/export/torchscript_text.h"
#include "lte/nn/constants.h"

namespace lte::infer {
namespace {

/// Queries decoded at a time: keeps the pairs with their neighbours within some 100 MB.
constexpr int64_t kQueryRows = 4096;

constexpr const char* kUseCache =
    R"SCRIPT(    light, features = self.cached(embedding, position, queries[:, 3:6])
    attributes = torch.cat([attributes, features], 1)
)SCRIPT";

// What comes of a query's neighbours before the layers: for the sum over them S1 and S2 of all
// layers at once, for the softmax the encoded offsets, which each layer reads anew.
constexpr const char* kSums = R"SCRIPT(    s1, s2 = self.neighbour_sums(
        embedding['table'], hidden, self.decoder_gamma_output_weight,
        self.decoder_gamma_output_bias, index))SCRIPT";
constexpr const char* kPlaces = R"SCRIPT(    place = torch.linear(
        hidden, self.decoder_gamma_output_weight, self.decoder_gamma_output_bias))SCRIPT";

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
    "        q, embedding['table'][0][{l}], embedding['table'][1][{l}], place, index,\n"
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

constexpr const char* kDecode = R"SCRIPT(
def decode_block(self, embedding: Dict[str, Tensor], queries: Tensor) -> Tensor:
    anchors = embedding['position']
    position = (queries[:, 0:3] - embedding['origin']) / {scale}
    index = self.nearest(position, anchors, {neighbours})
    offset = (position.unsqueeze(1) - anchors[index]) * (1.0 / float(embedding['spacing']))
    offset = torch.clamp(offset, -{offset_limit}, {offset_limit})
{normals}    hidden = self.gelu(torch.linear(
        offset, self.decoder_gamma_hidden_weight, self.decoder_gamma_hidden_bias))
{gather}
    attributes = self.attributes(position, queries[:, 3:6], queries[:, 6:9])
{use_cache}    g = self.mlp(
        attributes, self.decoder_point_hidden_weight, self.decoder_point_hidden_bias,
        self.decoder_point_output_weight, self.decoder_point_output_bias)
{layers}    g = self.norm(g, self.decoder_norm_weight, self.decoder_norm_bias)
    answer = torch.softplus(self.mlp(
        g, self.decoder_head_hidden_weight, self.decoder_head_hidden_bias,
        self.decoder_head_output_weight, self.decoder_head_output_bias))
    return {answer}

def decode(self, embedding: Dict[str, Tensor], queries: Tensor) -> Tensor:
    assert queries.dim() == 2 and queries.size(1) == 9, \
        'queries must be [Q, 9]: position, normal, albedo'
    assert bool(torch.all(torch.isfinite(queries))), 'queries: a value is not finite'
    out: List[Tensor] = [torch.zeros([0, 3], dtype=6, device=queries.device)]
    begin = 0
    while begin < queries.size(0):
        out.append(self.decode_block(embedding, queries[begin:begin + {rows}]))
        begin += {rows}
    return torch.cat(out) * embedding['radiance'].to(6)
)SCRIPT";

}  // namespace

std::string torchscript_decoder(const nn::ModelConfig& config) {
  const bool softmax = config.normalizes_attention(), cached = config.reads_indirect();
  std::string layers;
  for (int64_t l = 0; l < config.query_layers; ++l) {
    layers += fill(kLayer, {{"attention", softmax ? kSoftmaxAttention : kSumAttention},
                            {"p", "decoder_layer" + std::to_string(l)},
                            {"l", std::to_string(l)}});
  }
  return (softmax ? kSoftmax : "") + (cached ? torchscript_read_cache(config) : "") +
         fill(kDecode, {{"scale", number(config.scale)},
                        {"neighbours", std::to_string(config.query_neighbours)},
                        {"offset_limit", number(nn::kOffsetLimit)},
                        {"normals", config.reads_normals() ? kNormals : ""},
                        {"gather", softmax ? kPlaces : kSums},
                        {"use_cache", cached ? kUseCache : ""},
                        {"layers", layers},
                        {"answer", cached ? "answer * light" : "answer"},
                        {"rows", std::to_string(kQueryRows)}});
}

}  // namespace lte::infer
