#include "lte/ops/cpu/dense/packed_linear.h"

#include <cstring>

#include "lte/tensor/tensor.h"

namespace lte::ops {

void pack_pairs(const at::Tensor& w, int64_t begin, int64_t end, uint32_t* out) {
  const int64_t outputs = w.size(0), inputs = w.size(1), stride = (inputs + 1) / 2 * kBlock;
  const auto* from = w.const_data_ptr<at::BFloat16>();
  std::vector<uint32_t> rows(static_cast<size_t>(stride));
  for (int64_t block = begin; block < end; ++block, out += stride) {
    // Two numbers of a row are a pair where they lie; an odd last one is alone.
    const int64_t count = std::min(kBlock, outputs - block * kBlock);
    for (int64_t o = 0; o < count; ++o) {
      std::memcpy(rows.data() + o * (stride / kBlock), from + (block * kBlock + o) * inputs,
                  static_cast<size_t>(inputs) * sizeof(at::BFloat16));
    }
    bf16_kernels().transpose({rows.data(), stride / kBlock, count, stride / kBlock, out, kBlock});
  }
}

PackedLinear::PackedLinear(const at::Tensor& w, const at::Tensor& b)
    : inputs(w.size(1)),
      outputs(w.size(0)),
      blocks(blocks_of(outputs)),
      bias(static_cast<size_t>(blocks * kBlock)) {
  const at::Tensor rows = w.contiguous();
  if (b.defined()) {
    const at::Tensor offsets = b.contiguous();
    std::copy_n(offsets.const_data_ptr<float>(), outputs, bias.begin());
  }
  if (w.scalar_type() == at::kBFloat16) {
    pairs.resize(static_cast<size_t>(blocks * input_pairs() * kBlock));
    const int64_t block = input_pairs() * kBlock;
    at::parallel_for(0, blocks, 4, [&](int64_t begin, int64_t end) {
      pack_pairs(rows, begin, end, pairs.data() + begin * block);
    });
    return;
  }
  weight.resize(static_cast<size_t>(blocks * inputs * kBlock));
  const auto* from = rows.const_data_ptr<float>();
  at::parallel_for(
      0, blocks, 4096 / std::max<int64_t>(1, inputs) + 1, [&](int64_t begin, int64_t end) {
        for (int64_t block = begin; block < end; ++block) {
          const int64_t count = std::min(kBlock, outputs - block * kBlock);
          dense_kernels().transpose({from + block * kBlock * inputs, inputs, count, inputs,
                                     weight.data() + block * inputs * kBlock, kBlock},
                                    1);
        }
      });
}

PackedLinear PackedLinear::transposed(const at::Tensor& w) {
  PackedLinear out;
  out.inputs = w.size(0);
  out.outputs = w.size(1);
  out.blocks = blocks_of(out.outputs);
  out.bias.resize(static_cast<size_t>(out.blocks * kBlock));
  const at::Tensor rows = w.contiguous();
  if (rows.scalar_type() == at::kBFloat16) {
    out.pairs.resize(static_cast<size_t>(out.blocks * out.input_pairs() * kBlock));
    const auto* from = rows.const_data_ptr<at::BFloat16>();
    uint32_t* to = out.pairs.data();
    for (int64_t b = 0; b < out.blocks; ++b) {
      const int64_t count = std::min(kBlock, out.outputs - b * kBlock);
      for (int64_t i = 0; i < out.inputs; i += 2, to += kBlock) {
        const at::BFloat16* even = from + i * out.outputs + b * kBlock;
        pair_halves(even, i + 1 < out.inputs ? even + out.outputs : nullptr, count, to);
      }
    }
    return out;
  }
  out.weight.resize(static_cast<size_t>(out.blocks * out.inputs * kBlock));
  const auto* from = rows.const_data_ptr<float>();
  float* to = out.weight.data();
  for (int64_t b = 0; b < out.blocks; ++b) {
    const int64_t count = std::min(kBlock, out.outputs - b * kBlock);
    for (int64_t i = 0; i < out.inputs; ++i, to += kBlock) {
      std::copy_n(from + i * out.outputs + b * kBlock, count, to);
    }
  }
  return out;
}

void PackedLinear::multiply(const float* x, int64_t rows, int64_t k, int64_t count,
                            int64_t first_block, int64_t count_blocks, bool with_bias, bool add,
                            float* out) const {
  const float* offset = with_bias ? bias.data() + first_block * kBlock : nullptr;
  if (in_bf16()) {
    const uint32_t* from = pairs.data() + (first_block * input_pairs() + k / 2) * kBlock;
    bf16_kernels().multiply(
        {x, rows, count, from, kBlock, input_pairs() * kBlock, offset, count_blocks, add, out});
  } else {
    const float* from = weight.data() + (first_block * inputs + k) * kBlock;
    dense_kernels().multiply(
        {x, rows, count, from, kBlock, inputs * kBlock, offset, count_blocks, add, out});
  }
}

void perceptron(const PackedLinear& first, const PackedLinear& second, const Tile& x, int64_t rows,
                bool add, Tile& hidden, Tile& out) {
  for (int64_t h = 0; h < panels_of(first.outputs); ++h) {
    dense_panel(first, x, rows, h, false, hidden.panel(0));
    const int64_t inputs = std::min(kPanel, second.inputs - h * kPanel);
    const auto activate = second.in_bf16() ? bf16_kernels().activate : dense_kernels().activate;
    activate(hidden.panel(0), rows, blocks_of(inputs));
    for (int64_t p = 0; p < panels_of(second.outputs); ++p) {
      const int64_t block = p * (kPanel / kBlock);
      second.multiply(hidden.panel(0), rows, h * kPanel, inputs, block,
                      std::min(second.blocks - block, kPanel / kBlock), h == 0, add || h > 0,
                      out.panel(p));
    }
  }
}

}  // namespace lte::ops
