// Patch attention on the CPU: a thread takes a head of a patch, packs its keys and values, and
// walks tiles of queries.
//
// Scores are made in units of log 2, so that a weight is 2^score. Where no query and key of a tile
// can have a score beyond kSafeScore, by the lengths of the longest ones, no largest score is
// subtracted: a panel of keys goes through all three steps (scores, powers, weighted sum of values)
// while it is in the first-level cache, and the answer is divided by the sum of the weights in the
// end. Elsewhere a row of scores is made as a whole, 192 KiB a tile at patches of 1,024, and the
// softmax is the plain one of two passes. Flash attention's running maximum is needed in neither.
// Products run over panels of keys: keys are packed by blocks of 16 for the scores, values by rows
// for the answer, and the scores themselves are then the left factor of the second product, where
// they lie. In bfloat16 both are packed in pairs, of channels for the scores and of keys for the
// answer, as those are what the two products sum over.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include <ATen/Parallel.h>
#include <ATen/ops/empty.h>
#include <torch/library.h>

#include "lte/ops/cpu/packed_linear.h"
#include "lte/ops/patch_attention_args.h"

namespace lte::ops {
namespace {

constexpr int64_t kTile = 48;  ///< queries at a time, whose scores of a panel are 24 KiB
/// Scores whose powers of two add up without overflow or underflow.
constexpr float kSafeScore = 30;
static_assert(kWidestHead <= kPanel);

struct Work {
  const float* qkv;
  const int64_t *gather, *inverse;  ///< nullptr: one patch of all points
  int64_t C, d, length;
  bool bf16;
  float* out;
};

/// One thread's working memory.
class HeadAttention {
 public:
  explicit HeadAttention(const Work& work)
      : work_(work),
        width_(blocks_of(work.d) * kBlock),
        query_(kTile, kPanel),
        scores_(kTile, work.length),
        answer_(kTile, kPanel),
        inverse_sum_(kTile),
        sum_(kTile * kBlock) {
    const int64_t keys = blocks_of(work.length) * kBlock;
    if (work.bf16) {
      key_pairs_.resize(static_cast<size_t>(keys * half(work.d)));
      value_pairs_.resize(static_cast<size_t>(half(work.length) * width_));
      keys_.resize(static_cast<size_t>(work.d * kBlock));  // one block, on the way into pairs
    } else {
      keys_.resize(static_cast<size_t>(keys * work.d));
      values_.resize(static_cast<size_t>(work.length * width_));
    }
  }

  void run(int64_t patch, int64_t head) {
    const int64_t first = patch * work_.length;
    pack(first, head);
    longest_key_ = 0;
    for (int64_t j = 0; j < work_.length; ++j) {
      const float square =
          dense_kernels().largest_square(channels(first + j, 1, head), 1, 0, work_.d);
      if (!(square <= longest_key_)) longest_key_ = square;  // and stays what is not a number
      if (std::isnan(square)) break;
    }
    for (int64_t q = 0; q < work_.length; q += kTile) {
      attend(first, q, std::min(kTile, work_.length - q), head);
    }
  }

 private:
  int64_t point(int64_t slot) const { return work_.gather != nullptr ? work_.gather[slot] : slot; }

  const float* channels(int64_t slot, int64_t part, int64_t head) const {
    return work_.qkv + (point(slot) * 3 + part) * work_.C + head * work_.d;
  }

  static int64_t half(int64_t n) { return (n + 1) / 2; }

  /// Keys as [blocks of keys, d, kBlock], values as [keys, d], padded to whole blocks.
  void pack(int64_t first, int64_t head) {
    if (work_.bf16) {
      pack_in_pairs(first, head);
      return;
    }
    const int64_t d = work_.d;
    for (int64_t j = 0; j < work_.length; ++j) {
      const float* key = channels(first + j, 1, head);
      float* to = keys_.data() + j / kBlock * d * kBlock + j % kBlock;
      for (int64_t c = 0; c < d; ++c) to[c * kBlock] = key[c];
      std::copy_n(channels(first + j, 2, head), d, values_.data() + j * width_);
    }
  }

  /// Keys as [blocks of keys, ⌈d / 2⌉, kBlock] pairs of channels, values as [⌈keys / 2⌉, d] pairs
  /// of keys.
  void pack_in_pairs(int64_t first, int64_t head) {
    const int64_t d = work_.d, length = work_.length;
    for (int64_t j = 0; j < length; j += kBlock) {
      float* block = keys_.data();
      for (int64_t i = 0; i < std::min(kBlock, length - j); ++i) {
        const float* key = channels(first + j + i, 1, head);
        for (int64_t c = 0; c < d; ++c) block[c * kBlock + i] = key[c];
      }
      uint32_t* to = key_pairs_.data() + j * half(d);
      for (int64_t c = 0; c < d; c += 2) {
        const float* even = block + c * kBlock;
        bf16_kernels().pair_rows(even, c + 1 < d ? even + kBlock : nullptr, kBlock,
                                 to + c / 2 * kBlock);
      }
    }
    for (int64_t j = 0; j < length; j += 2) {
      const float* odd = j + 1 < length ? channels(first + j + 1, 2, head) : nullptr;
      bf16_kernels().pair_rows(channels(first + j, 2, head), odd, d,
                               value_pairs_.data() + j / 2 * width_);
    }
  }

  /// scores (rows × keys [j, j + kPanel)) = query · keys.
  void score(int64_t rows, int64_t j, float* out) {
    const int64_t d = work_.d, blocks = blocks_of(std::min(kPanel, work_.length - j));
    if (work_.bf16) {
      bf16_kernels().multiply({query_.panel(0), rows, d, key_pairs_.data() + j * half(d), kBlock,
                               half(d) * kBlock, nullptr, blocks, false, out});
    } else {
      dense_kernels().multiply({query_.panel(0), rows, d, keys_.data() + j * d, kBlock, d * kBlock,
                                nullptr, blocks, false, out});
    }
  }

  /// answer += weights of keys [j, j + kPanel) · values.
  void weigh(int64_t rows, int64_t j, const float* weights) {
    const int64_t count = std::min(kPanel, work_.length - j), blocks = width_ / kBlock;
    if (work_.bf16) {
      bf16_kernels().multiply({weights, rows, count, value_pairs_.data() + j / 2 * width_, width_,
                               kBlock, nullptr, blocks, j > 0, answer_.panel(0)});
    } else {
      dense_kernels().multiply({weights, rows, count, values_.data() + j * width_, width_, kBlock,
                                nullptr, blocks, j > 0, answer_.panel(0)});
    }
  }

  /// Queries [q, q + rows) of the patch that begins at slot `first`.
  void attend(int64_t first, int64_t q, int64_t rows, int64_t head) {
    const int64_t d = work_.d;
    const float scale = std::numbers::log2e_v<float> / std::sqrt(static_cast<float>(d));
    for (int64_t i = 0; i < rows; ++i) {
      const float* from = channels(first + q + i, 0, head);
      for (int64_t c = 0; c < d; ++c) query_.panel(0)[i * kPanel + c] = from[c] * scale;
    }
    const float longest_query = dense_kernels().largest_square(query_.panel(0), rows, kPanel, d);
    if (longest_query * longest_key_ <= kSafeScore * kSafeScore) {
      weigh_panels(rows);
    } else {
      weigh_rows(rows);
    }
    for (int64_t i = 0; i < rows; ++i) {
      const int64_t slot = first + q + i, row = point(slot);
      if (work_.inverse != nullptr && work_.inverse[row] != slot) continue;
      float* to = work_.out + row * work_.C + head * d;
      for (int64_t c = 0; c < d; ++c) to[c] = answer_.panel(0)[i * kPanel + c] * inverse_sum_[i];
    }
  }

  /// The tile's answers and sums of weights, panel by panel; no score is beyond kSafeScore.
  void weigh_panels(int64_t rows) {
    std::fill_n(sum_.begin(), rows * kBlock, 0.0f);
    for (int64_t j = 0; j < work_.length; j += kPanel) {
      score(rows, j, scores_.panel(0));
      dense_kernels().raise(scores_.panel(0), rows, std::min(kPanel, work_.length - j),
                            sum_.data());
      weigh(rows, j, scores_.panel(0));
    }
    for (int64_t i = 0; i < rows; ++i) {
      float sum = 0;
      for (int64_t lane = 0; lane < kBlock; ++lane) sum += sum_[i * kBlock + lane];
      inverse_sum_[i] = 1 / sum;
    }
  }

  /// The same with scores of any size, row by row.
  void weigh_rows(int64_t rows) {
    for (int64_t j = 0; j < work_.length; j += kPanel) score(rows, j, scores_.panel(j / kPanel));
    dense_kernels().exponentiate(scores_.panel(0), rows, scores_.panel_stride(), work_.length,
                                 inverse_sum_.data());
    for (int64_t j = 0; j < work_.length; j += kPanel) weigh(rows, j, scores_.panel(j / kPanel));
  }

  const Work& work_;
  int64_t width_;  ///< d, rounded up to whole blocks
  std::vector<float> keys_, values_;
  std::vector<uint32_t> key_pairs_, value_pairs_;  ///< in bfloat16, instead
  Tile query_, scores_, answer_;
  std::vector<float> inverse_sum_;
  std::vector<float> sum_;  ///< [kTile, kBlock], parts of the sums of weights
  float longest_key_ = 0;   ///< the largest square of a key's length
};

at::Tensor patch_attention_inference_cpu(const at::Tensor& any_qkv,
                                         const std::optional<at::Tensor>& gather,
                                         const std::optional<at::Tensor>& inverse, int64_t heads,
                                         int64_t patch, bool bf16) {
  check_patch_attention_args(any_qkv, gather, inverse, heads, patch);
  const at::Tensor qkv = any_qkv.contiguous();
  const int64_t n = qkv.size(0), C = qkv.size(1) / 3, d = C / heads;
  at::Tensor slots, of_point;
  if (gather.has_value()) {
    slots = gather->contiguous();
    of_point = inverse->contiguous();
  }
  at::Tensor out = at::empty({n, C}, qkv.options());
  if (n == 0) return out;
  const bool one_patch = !slots.defined();
  const Work work{qkv.const_data_ptr<float>(),
                  one_patch ? nullptr : slots.const_data_ptr<int64_t>(),
                  one_patch ? nullptr : of_point.const_data_ptr<int64_t>(),
                  C,
                  d,
                  one_patch ? n : patch,
                  bf16,
                  out.data_ptr<float>()};
  const int64_t patches = one_patch ? 1 : slots.numel() / patch;
  at::parallel_for(0, patches * heads, 1, [&](int64_t begin, int64_t end) {
    HeadAttention attention(work);
    for (int64_t i = begin; i < end; ++i) attention.run(i / heads, i % heads);
  });
  return out;
}

}  // namespace
}  // namespace lte::ops

TORCH_LIBRARY_IMPL(lte, CPU, m) {
  m.impl("patch_attention_inference", lte::ops::patch_attention_inference_cpu);
}
