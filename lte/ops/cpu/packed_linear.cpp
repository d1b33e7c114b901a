#include "lte/ops/cpu/packed_linear.h"

namespace lte::ops {

PackedLinear::PackedLinear(const at::Tensor& w, const at::Tensor& b)
    : inputs(w.size(1)),
      outputs(w.size(0)),
      blocks(blocks_of(outputs)),
      weight(static_cast<size_t>(blocks * inputs * kBlock)),
      bias(static_cast<size_t>(blocks * kBlock)) {
  const at::Tensor rows = w.contiguous(), offsets = b.contiguous();
  const auto* from = rows.const_data_ptr<float>();
  std::copy_n(offsets.const_data_ptr<float>(), outputs, bias.begin());
  for (int64_t o = 0; o < outputs; ++o) {
    float* to = weight.data() + o / kBlock * inputs * kBlock + o % kBlock;
    for (int64_t i = 0; i < inputs; ++i) to[i * kBlock] = from[o * inputs + i];
  }
}

void perceptron(const PackedLinear& first, const PackedLinear& second, const Tile& x, int64_t rows,
                bool add, Tile& hidden, Tile& out) {
  for (int64_t h = 0; h < panels_of(first.outputs); ++h) {
    dense_panel(first, x, rows, h, false, hidden.panel(0));
    const int64_t inputs = std::min(kPanel, second.inputs - h * kPanel);
    dense_kernels().activate(hidden.panel(0), rows, blocks_of(inputs));
    for (int64_t p = 0; p < panels_of(second.outputs); ++p) {
      const int64_t block = p * (kPanel / kBlock);
      dense_kernels().multiply(
          hidden.panel(0), rows, inputs,
          second.weight.data() + (block * second.inputs + h * kPanel) * kBlock, kBlock,
          second.inputs * kBlock, h == 0 ? second.bias.data() + block * kBlock : nullptr,
          std::min(second.blocks - block, kPanel / kBlock), add || h > 0, out.panel(p));
    }
  }
}

}  // namespace lte::ops
