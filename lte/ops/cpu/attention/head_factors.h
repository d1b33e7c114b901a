// What a head of patch attention multiplies by, in float32 or in pairs of bfloat16.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "lte/ops/cpu/attention/attention_input.h"

namespace lte::ops {

/// Keys or values of a patch as the right factor of a product over their channels: [blocks of
/// slots, d, kBlock], or pairs of channels.
class ChannelFactor {
 public:
  ChannelFactor(const AttentionInput& input, bool bf16)
      : input_(input),
        d_(input.width()),
        depth_(bf16 ? (d_ + 1) / 2 : d_),
        rows_(static_cast<size_t>(d_ * kBlock)),
        block_(rows_.size()) {
    const auto size = static_cast<size_t>(blocks_of(input.length()) * kBlock * depth_);
    bf16 ? pairs_.resize(size) : single_.resize(size);
  }

  /// @param first  slot of the patch, @param part kKey or kValue
  void pack(int64_t first, int64_t part, int64_t head) {
    for (int64_t j = 0; j < input_.length(); j += kBlock) {
      const int64_t rows = std::min(kBlock, input_.length() - j);
      for (int64_t i = 0; i < rows; ++i)
        copy_row(input_.row(first + j + i, part, head), d_, rows_.data() + i * d_);
      float* to = pairs_.empty() ? single_.data() + j * d_ : block_.data();
      dense_kernels().transpose({rows_.data(), d_, rows, d_, to, kBlock}, 1);
      if (pairs_.empty()) continue;
      for (int64_t c = 0; c < d_; c += 2) {
        const float* even = to + c * kBlock;
        bf16_kernels().pair_rows(even, c + 1 < d_ ? even + kBlock : nullptr, kBlock,
                                 pairs_.data() + j * depth_ + c / 2 * kBlock);
      }
    }
  }

  /// out [rows, kPanel] = x · slots [j, j + kPanel) of the patch. @param x [rows, d], one panel
  void multiply(const float* x, int64_t rows, int64_t j, float* out) const {
    const int64_t blocks = blocks_of(std::min(kPanel, input_.length() - j));
    if (pairs_.empty()) {
      dense_kernels().multiply(
          {x, rows, d_, single_.data() + j * d_, kBlock, d_ * kBlock, nullptr, blocks, false, out});
    } else {
      bf16_kernels().multiply({x, rows, d_, pairs_.data() + j * depth_, kBlock, depth_ * kBlock,
                               nullptr, blocks, false, out});
    }
  }

 private:
  const AttentionInput& input_;
  int64_t d_, depth_;            ///< numbers or pairs of a slot
  std::vector<float> rows_;      ///< [kBlock, d] of the slots, which may lie anywhere
  std::vector<float> block_;     ///< [d, kBlock], on the way into pairs
  std::vector<float> single_;    ///< zero past the last slot of a patch
  std::vector<uint32_t> pairs_;  ///< empty in float32
};

/// The same as the right factor of a product over slots: [slots, d to whole blocks], or pairs of
/// slots.
class SlotFactor {
 public:
  SlotFactor(const AttentionInput& input, bool bf16)
      : input_(input), width_(blocks_of(input.width()) * kBlock) {
    const int64_t length = input.length();
    if (bf16) {
      pairs_.resize(static_cast<size_t>((length + 1) / 2 * width_));
    } else {
      single_.resize(static_cast<size_t>(length * width_));
    }
  }

  void pack(int64_t first, int64_t part, int64_t head) {
    const int64_t length = input_.length(), d = input_.width();
    if (pairs_.empty()) {
      for (int64_t j = 0; j < length; ++j)
        std::copy_n(input_.row(first + j, part, head), d, single_.data() + j * width_);
      return;
    }
    for (int64_t j = 0; j < length; j += 2) {
      const float* odd = j + 1 < length ? input_.row(first + j + 1, part, head) : nullptr;
      bf16_kernels().pair_rows(input_.row(first + j, part, head), odd, d,
                               pairs_.data() + j / 2 * width_);
    }
  }

  /// out [rows, d] (+)= x · slots [j, j + kPanel), j even. @param x, out  one panel each
  void multiply(const float* x, int64_t rows, int64_t j, bool add, float* out) const {
    const int64_t count = std::min(kPanel, input_.length() - j), blocks = width_ / kBlock;
    if (pairs_.empty()) {
      dense_kernels().multiply(
          {x, rows, count, single_.data() + j * width_, width_, kBlock, nullptr, blocks, add, out});
    } else {
      bf16_kernels().multiply({x, rows, count, pairs_.data() + j / 2 * width_, width_, kBlock,
                               nullptr, blocks, add, out});
    }
  }
  /// The same of an x in pairs of slots, with rows kPanel / 2 apart.
  void multiply_pairs(const uint32_t* x, int64_t rows, int64_t j, bool add, float* out) const {
    const int64_t pairs = (std::min(kPanel, input_.length() - j) + 1) / 2;
    bf16_kernels().multiply_pairs({x, rows, pairs, pairs_.data() + j / 2 * width_, width_, kBlock,
                                   nullptr, width_ / kBlock, add, out});
  }

 private:
  const AttentionInput& input_;
  int64_t width_;  ///< d, rounded up to whole blocks
  std::vector<float> single_;
  std::vector<uint32_t> pairs_;  ///< empty in float32
};

}  // namespace lte::ops
