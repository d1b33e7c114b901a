#include "lte/torchscript/transformer.h"

#include <algorithm>

#include "lte/nn/constants.h"
#include "lte/ops/curve_codes.h"
#include "lte/torchscript/text.h"

namespace lte::torchscript {
namespace {

constexpr const char* kTransformer = R"SCRIPT(
def patches(self, cells: Tensor, bits: int, curves: int, patch_size: int) -> List[Tensor]:
    maps: List[Tensor] = []
    n = cells.size(0)
    if n > patch_size:
        padded = (n + patch_size - 1) // patch_size * patch_size
        for curve in range(curves):
            codes = self.curve_codes(cells, curve, max(bits, 1))
            _, order = torch.sort(codes, stable=True, dim=0, descending=False)
            slots = torch.arange(n, device=cells.device)
            maps.append(torch.cat([order, order[n - patch_size:padded - patch_size]]))
            maps.append(torch.scatter(torch.zeros_like(order), 0, order, slots))
    return maps

def pool_cells(self, cells: Tensor, bits: int) -> Tuple[Tensor, Tensor]:
    if bits <= 0:
        return cells, torch.arange(cells.size(0), device=cells.device)
    code = self.curve_codes(cells, 0, bits) >> 3
    ordered, order = torch.sort(code, stable=True, dim=0, descending=False)
    _, inverse, counts = torch.unique_consecutive(ordered, True, True)
    cluster = torch.scatter(torch.zeros_like(inverse), 0, order, inverse)
    first = order[torch.cumsum(counts, 0) - counts]
    return (cells[first] >> 1).contiguous(), cluster

def attention(self, x: Tensor, maps: List[Tensor], turns: List[Tensor], block: int, heads: int,
              patch_size: int, w0: Tensor, b0: Tensor, w1: Tensor, b1: Tensor) -> Tensor:
    qkv = torch.linear(x, w0, b0)
    if len(turns) > 0:
        qkv = self.rotated(qkv, turns[0], turns[1], heads)
    length = x.size(0)
    curve = 0
    if len(maps) > 0:
        curve = block % (len(maps) // 2)
        qkv = qkv[maps[2 * curve]]
        length = patch_size
    qkv = torch.permute(qkv.view([-1, length, 3, heads, x.size(1) // heads]), [2, 0, 3, 1, 4])
    y = torch.scaled_dot_product_attention(qkv[0], qkv[1], qkv[2])
    y = torch.reshape(torch.transpose(y, 1, 2), [-1, x.size(1)])
    if len(maps) > 0:
        y = y[maps[2 * curve + 1]]
    return torch.linear(y, w1, b1)

def rotated(self, qkv: Tensor, cosine: Tensor, sine: Tensor, heads: int) -> Tensor:
    n = qkv.size(0)
    parts = qkv.view([n, 3, heads, 2, cosine.size(1)])
    a = parts[:, 0:2, :, 0]
    b = parts[:, 0:2, :, 1]
    c = cosine.view([n, 1, 1, -1])
    s = sine.view([n, 1, 1, -1])
    turned = torch.stack([a * c - b * s, a * s + b * c], 3)
    return torch.cat([turned, parts[:, 2:3]], 1).view([n, -1])

def turns(self, cells: Tensor, pairs: int) -> List[Tensor]:
    of_axis = pairs // 3
    turn = torch.pow(2.0, torch.arange(of_axis, dtype=7, device=cells.device)) * {rotary_turn}
    angle = torch.flatten(cells.to(7).unsqueeze(2) * turn, 1)
    angle = torch.constant_pad_nd(angle, [0, pairs - 3 * of_axis], 0)
    return [torch.cos(angle).to(6), torch.sin(angle).to(6)]

def point_norm(self, x: Tensor, share: Optional[Tensor], weight: Tensor, bias: Tensor) -> Tensor:
    if share is not None:
        x = x - torch.mean(x, [0], True) * share
    return self.norm(x, weight, bias)

def cluster_max(self, x: Tensor, cluster: Tensor, clusters: int) -> Tensor:
    target = cluster.unsqueeze(1).expand([x.size(0), x.size(1)])
    lowest = torch.full([clusters, x.size(1)], float('-inf'), dtype=x.dtype, device=x.device)
    return torch.scatter_reduce(lowest, 0, target, x, 'amax')
)SCRIPT";

constexpr const char* kBlock = R"SCRIPT(
def {p}(self, x: Tensor, pairs: Tensor, tap_begin: Tensor, maps: List[Tensor],
        turns: List[Tensor]) -> Tensor:
    y = self.submanifold_conv(x, self.{p}_conv_weight, self.{p}_conv_bias, pairs, tap_begin)
    y = torch.linear(y, self.{p}_conv_linear_weight, self.{p}_conv_linear_bias)
    x = x + self.point_norm(y, {conv_share}, self.{p}_conv_norm_weight, self.{p}_conv_norm_bias)
    y = self.norm(x, self.{p}_norm1_weight, self.{p}_norm1_bias)
    x = x + self.attention(
        y, maps, turns, {block}, {heads}, {patch},
        self.{p}_attention_qkv_weight, self.{p}_attention_qkv_bias,
        self.{p}_attention_proj_weight, self.{p}_attention_proj_bias)
    y = self.norm(x, self.{p}_norm2_weight, self.{p}_norm2_bias)
    return x + self.mlp(
        y, self.{p}_mlp_hidden_weight, self.{p}_mlp_hidden_bias,
        self.{p}_mlp_output_weight, self.{p}_mlp_output_bias)
)SCRIPT";

constexpr const char* kPool = R"SCRIPT(
    fine = torch.linear(x{from}, self.{p}_linear_weight, self.{p}_linear_bias)
    pooled = self.cluster_max(fine, cluster{s}, cells{s}.size(0))
    pooled = self.point_norm(pooled, {share}, self.{p}_norm_weight, self.{p}_norm_bias)
    x{s} = self.gelu(pooled)
)SCRIPT";

constexpr const char* kUnpool = R"SCRIPT(
    up = torch.linear(y, self.{p}_coarse_weight, self.{p}_coarse_bias)
    up = self.gelu(self.point_norm(
        up, {coarse_share}, self.{p}_coarse_norm_weight, self.{p}_coarse_norm_bias))
    across = torch.linear(x{s}, self.{p}_skip_weight, self.{p}_skip_bias)
    across = self.gelu(self.point_norm(
        across, {skip_share}, self.{p}_skip_norm_weight, self.{p}_skip_norm_bias))
    y = up[cluster{below}] + across
)SCRIPT";

/// The learnt share of a PointNorm's mean, or nothing.
std::string share_of(const nn::ModelConfig& config, const std::string& norm) {
  return config.centers_norms() ? "self." + norm + "_share" : "None";
}

std::string blocks_of(const nn::ModelConfig& config, const std::string& stage, int64_t depth,
                      int64_t width) {
  std::string methods;
  for (int64_t i = 0; i < depth; ++i) {
    const std::string block = "encoder_" + stage + "_" + std::to_string(i);
    methods +=
        fill(kBlock, {{"p", block},
                      {"conv_share", share_of(config, block + "_conv_norm")},
                      {"block", std::to_string(i)},
                      {"heads", std::to_string(std::max<int64_t>(1, width / config.head_width))},
                      {"patch", std::to_string(config.patch_size)}});
  }
  return methods;
}

std::string block_calls(const std::string& stage, const std::string& variable, size_t plan,
                        int64_t depth) {
  std::string lines;
  const std::string s = std::to_string(plan);
  for (int64_t i = 0; i < depth; ++i) {
    lines += fill("    {x} = self.encoder_{stage}_{i}({x}, pairs{s}, taps{s}, maps{s}, turns{s})\n",
                  {{"x", variable}, {"stage", stage}, {"i", std::to_string(i)}, {"s", s}});
  }
  return lines;
}

/// Cells, clusters, pairs and patch maps of every stage.
std::string plan_lines(const nn::ModelConfig& config) {
  std::string lines;
  for (size_t s = 0; s < config.encoder_depths.size(); ++s) {
    const int64_t bits = ops::kCurveBits - static_cast<int64_t>(s);
    const bool also_up = s < config.decoder_depths.size();
    const int64_t depth = also_up ? std::max(config.encoder_depths[s], config.decoder_depths[s])
                                  : config.encoder_depths[s];
    const std::string above = s > 0 ? std::to_string(s - 1) : "";
    if (s > 0) {
      lines +=
          fill("    cells{s}, cluster{s} = self.pool_cells(cells{above}, {bits})\n",
               {{"s", std::to_string(s)}, {"above", above}, {"bits", std::to_string(bits + 1)}});
    }
    lines += fill(
        "    pairs{s}, taps{s} = self.convolution_pairs(cells{s}, {kernel})\n"
        "    maps{s} = self.patches(cells{s}, {bits}, {curves}, {patch})\n",
        {{"s", std::to_string(s)},
         {"bits", std::to_string(bits)},
         {"kernel", std::to_string(nn::kBlockKernel)},
         {"curves", std::to_string(std::min(nn::kCurves, depth))},
         {"patch", std::to_string(config.patch_size)}});
    lines +=
        config.rotates_attention()
            ? fill("    turns{s} = self.turns(cells{s}, {pairs})\n",
                   {{"s", std::to_string(s)}, {"pairs", std::to_string(config.head_width / 2)}})
            : fill("    turns{s}: List[Tensor] = []\n", {{"s", std::to_string(s)}});
  }
  return lines;
}

}  // namespace

std::string transformer_source(const nn::ModelConfig& config) {
  const size_t stages = config.encoder_depths.size();
  std::string methods;
  std::string body = "\ndef transformer(self, x: Tensor, cells0: Tensor) -> Tensor:\n";
  body += plan_lines(config);
  body += fill(
      "    stem_pairs, stem_taps = self.convolution_pairs(cells0, {k})\n"
      "    stem = self.submanifold_conv(x, self.encoder_stem_weight, None, stem_pairs, "
      "stem_taps)\n",
      {{"k", std::to_string(config.stem_kernel())}});
  body += fill(
      "    x0 = self.gelu(self.point_norm(\n"
      "        stem, {share}, self.encoder_stem_norm_weight, self.encoder_stem_norm_bias))\n",
      {{"share", share_of(config, "encoder_stem_norm")}});
  for (size_t s = 0; s < stages; ++s) {
    const std::string stage = numbered("down", s);
    if (s > 0) {
      const std::string name = numbered("encoder_pool", s);
      body += fill(kPool, {{"p", name},
                           {"share", share_of(config, name + "_norm")},
                           {"s", std::to_string(s)},
                           {"from", std::to_string(s - 1)}});
    }
    body += block_calls(stage, numbered("x", s), s, config.encoder_depths[s]);
    methods += blocks_of(config, stage, config.encoder_depths[s],
                         config.encoder_widths[s] * config.channels);
  }
  body += "    y = " + numbered("x", stages - 1) + "\n";
  for (size_t s = stages - 1; s-- > 0;) {
    const std::string stage = numbered("up", s);
    const std::string name = numbered("encoder_unpool", s);
    body += fill(kUnpool, {{"p", name},
                           {"coarse_share", share_of(config, name + "_coarse_norm")},
                           {"skip_share", share_of(config, name + "_skip_norm")},
                           {"s", std::to_string(s)},
                           {"below", std::to_string(s + 1)}});
    body += block_calls(stage, "y", s, config.decoder_depths[s]);
    methods += blocks_of(config, stage, config.decoder_depths[s],
                         config.decoder_widths[s] * config.channels);
  }
  return fill(kTransformer, {{"rotary_turn", number(nn::kRotaryTurn)}}) + methods + body +
         "    return self.norm(y, self.encoder_norm_weight, self.encoder_norm_bias)\n";
}

}  // namespace lte::torchscript
