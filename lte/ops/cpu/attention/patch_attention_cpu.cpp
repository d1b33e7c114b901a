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
#include <optional>
#include <tuple>
#include <vector>

#include "lte/ops/cpu/attention/attention_input.h"
#include "lte/ops/cpu/attention/head_factors.h"
#include "lte/ops/cpu/dense/packed_linear.h"
#include "lte/ops/patch_attention_args.h"
#include "lte/tensor/functions.h"
#include "lte/tensor/library.h"

namespace lte::ops {
namespace {

constexpr int64_t kTile = 48;  ///< queries at a time, whose scores of a panel are 24 KiB
/// Scores whose powers of two add up without overflow or underflow.
constexpr float kSafeScore = 30;
static_assert(kWidestHead <= kPanel);

struct AttentionWork {
  const AttentionInput& input;
  bool bf16;
  float* out;
  float* log_sum;  ///< [slots, heads], or null
};

/// One thread's working memory.
class HeadAttention {
 public:
  explicit HeadAttention(const AttentionWork& work)
      : work_(work),
        of_(work.input),
        d_(of_.width()),
        length_(of_.length()),
        keys_(of_, work.bf16),
        values_(of_, work.bf16),
        query_(kTile, kPanel),
        scores_(kTile, length_),
        answer_(kTile, kPanel),
        inverse_sum_(kTile),
        largest_(kTile),
        sum_(kTile * kBlock) {}

  void run(int64_t patch, int64_t head) {
    const int64_t first = patch * length_;
    keys_.pack(first, AttentionInput::kKey, head);
    values_.pack(first, AttentionInput::kValue, head);
    longest_key_ = 0;
    for (int64_t j = 0; j < length_; ++j) {
      const float square =
          dense_kernels().largest_square(of_.row(first + j, AttentionInput::kKey, head), 1, 0, d_);
      if (!(square <= longest_key_)) longest_key_ = square;  // and stays what is not a number
      if (std::isnan(square)) break;
    }
    for (int64_t q = 0; q < length_; q += kTile) {
      attend(first, q, std::min(kTile, length_ - q), head);
    }
  }

 private:
  /// Queries [q, q + rows) of the patch that begins at slot `first`.
  void attend(int64_t first, int64_t q, int64_t rows, int64_t head) {
    of_.scaled_queries(first, q, rows, head, query_.panel(0));
    const float longest_query = dense_kernels().largest_square(query_.panel(0), rows, kPanel, d_);
    if (longest_query * longest_key_ <= kSafeScore * kSafeScore) {
      weigh_panels(rows);
    } else {
      weigh_rows(rows);
    }
    for (int64_t i = 0; i < rows; ++i) {
      const int64_t slot = first + q + i;
      if (work_.log_sum != nullptr)
        work_.log_sum[slot * of_.heads() + head] = largest_[i] - std::log2(inverse_sum_[i]);
      if (!of_.answers(slot)) continue;
      float* to = work_.out + of_.point(slot) * of_.channels() + head * d_;
      for (int64_t c = 0; c < d_; ++c) to[c] = answer_.panel(0)[i * kPanel + c] * inverse_sum_[i];
    }
  }

  /// The tile's answers and sums of weights, panel by panel; no score is beyond kSafeScore.
  void weigh_panels(int64_t rows) {
    std::fill_n(sum_.begin(), rows * kBlock, 0.0f);
    for (int64_t j = 0; j < length_; j += kPanel) {
      keys_.multiply(query_.panel(0), rows, j, scores_.panel(0));
      dense_kernels().raise(scores_.panel(0), rows, std::min(kPanel, length_ - j), sum_.data());
      values_.multiply(scores_.panel(0), rows, j, j > 0, answer_.panel(0));
    }
    for (int64_t i = 0; i < rows; ++i) {
      float sum = 0;
      for (int64_t lane = 0; lane < kBlock; ++lane) sum += sum_[i * kBlock + lane];
      inverse_sum_[i] = 1 / sum;
      largest_[i] = 0;
    }
  }

  /// The same with scores of any size, row by row.
  void weigh_rows(int64_t rows) {
    for (int64_t j = 0; j < length_; j += kPanel)
      keys_.multiply(query_.panel(0), rows, j, scores_.panel(j / kPanel));
    dense_kernels().exponentiate(scores_.panel(0), rows, scores_.panel_stride(), length_,
                                 inverse_sum_.data(), largest_.data());
    for (int64_t j = 0; j < length_; j += kPanel)
      values_.multiply(scores_.panel(j / kPanel), rows, j, j > 0, answer_.panel(0));
  }

  const AttentionWork& work_;
  const AttentionInput& of_;
  int64_t d_, length_;
  ChannelFactor keys_;
  SlotFactor values_;
  Tile query_, scores_, answer_;
  std::vector<float> inverse_sum_, largest_;  ///< by query: of weights 2^(score - largest)
  std::vector<float> sum_;                    ///< [kTile, kBlock], parts of the sums of weights
  float longest_key_ = 0;                     ///< the largest square of a key's length
};

/// @param log_sum  see AttentionWork
at::Tensor attend(const AttentionInput& input, bool bf16, const at::Tensor& qkv, float* log_sum) {
  at::Tensor out = at::empty({input.points(), input.channels()}, qkv.options());
  if (input.points() == 0) return out;
  const AttentionWork work{input, bf16, out.data_ptr<float>(), log_sum};
  const int64_t heads = input.heads();
  at::parallel_for(0, input.patches() * heads, 1, [&](int64_t begin, int64_t end) {
    HeadAttention attention(work);
    for (int64_t i = begin; i < end; ++i) attention.run(i / heads, i % heads);
  });
  return out;
}

at::Tensor patch_attention_inference_cpu(const at::Tensor& qkv,
                                         const std::optional<at::Tensor>& gather,
                                         const std::optional<at::Tensor>& inverse, int64_t heads,
                                         int64_t patch, bool bf16) {
  check_patch_attention_args("patch_attention_inference", qkv, gather, inverse, heads, patch);
  return attend({qkv, gather, inverse, heads, patch}, bf16, qkv, nullptr);
}

std::tuple<at::Tensor, at::Tensor> patch_attention_cpu(const at::Tensor& qkv,
                                                       const std::optional<at::Tensor>& gather,
                                                       const std::optional<at::Tensor>& inverse,
                                                       int64_t heads, int64_t patch, bool bf16) {
  check_patch_attention_args("patch_attention", qkv, gather, inverse, heads, patch);
  const AttentionInput input(qkv, gather, inverse, heads, patch);
  at::Tensor log_sum = at::empty({input.slots(), heads}, qkv.options());
  at::Tensor out = attend(input, bf16, qkv, log_sum.data_ptr<float>());
  return {out, log_sum};
}

}  // namespace
}  // namespace lte::ops

TORCH_LIBRARY_IMPL(lte, CPU, m) {
  m.impl("patch_attention_inference", lte::ops::patch_attention_inference_cpu);
  m.impl("patch_attention", lte::ops::patch_attention_cpu);
}
