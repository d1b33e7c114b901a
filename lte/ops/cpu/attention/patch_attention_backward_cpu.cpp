// The gradient of patch attention on the CPU. Nothing of the size of queries × keys is kept: a
// thread takes a head of a patch and makes its weights again, a tile of queries and a panel of keys
// at a time, from the scores and the logarithms of their sums that the forward pass left (Dao et
// al. 2022, "FlashAttention", appendix B). While tile and panel are in the caches they give their
// part of all three gradients.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "lte/ops/cpu/attention/attention_input.h"
#include "lte/ops/cpu/attention/head_factors.h"
#include "lte/ops/cpu/dense/packed_linear.h"
#include "lte/ops/patch_attention_args.h"
#include "lte/tensor/functions.h"
#include "lte/tensor/library.h"

namespace lte::ops {
namespace {

constexpr int64_t kGradientTile = 48;  ///< queries at a time
constexpr int64_t kQuery = AttentionInput::kQuery, kKey = AttentionInput::kKey,
                  kValue = AttentionInput::kValue;

struct GradientWork {
  const AttentionInput& input;
  bool bf16;
  const float* grad;     ///< [n, C]
  const float* out;      ///< [n, C]
  const float* log_sum;  ///< [slots, heads]
  float* by_slot;        ///< [slots, 3C]
};

float dot(const float* a, const float* b, int64_t count) {
  float lanes[kBlock] = {}, sum = 0;
  int64_t c = 0;
  for (; c + kBlock <= count; c += kBlock) {
    for (int64_t lane = 0; lane < kBlock; ++lane) lanes[lane] += a[c + lane] * b[c + lane];
  }
  for (; c < count; ++c) sum += a[c] * b[c];
  for (const float lane : lanes) sum += lane;
  return sum;
}

/// Gradients by keys or values: sums over queries of scores times rows, for one head of a patch.
/// They are kept as [panels of keys, d, kPanel], as scores are then the right factor, where they
/// lie.
class SumsByKey {
 public:
  SumsByKey(const AttentionInput& input, bool bf16)
      : d_(input.width()),
        length_(input.length()),
        turned_(bf16 ? 0 : static_cast<size_t>(d_ * kPanel)),
        pairs_(bf16 ? static_cast<size_t>(kGradientTile / 2 * kPanel) : 0),
        turned_pairs_(bf16 ? static_cast<size_t>(d_ * kPanel / 2) : 0),
        sums_(static_cast<size_t>(panels_of(length_) * d_ * kPanel)) {}

  /// The left factor of the sums to come. @param tile [rows, d], one panel
  void take(const float* tile, int64_t rows) {
    rows_ = rows;
    if (pairs_.empty()) {
      for (int64_t r = 0; r < rows; r += kBlock) {
        dense_kernels().transpose(
            {tile + r * kPanel, kPanel, std::min(kBlock, rows - r), d_, turned_.data() + r, kPanel},
            1);
      }
      return;
    }
    const int64_t pairs = (rows + 1) / 2;
    pair_up_rows(tile, rows, blocks_of(d_), pairs_.data());
    for (int64_t r = 0; r < pairs; r += kBlock) {
      bf16_kernels().transpose({pairs_.data() + r * kPanel, kPanel, std::min(kBlock, pairs - r), d_,
                                turned_pairs_.data() + r, kPanel / 2});
    }
  }

  /// Sums of keys [j, j + kPanel) (+)= the tile, transposed, times scores [rows, kPanel].
  void add(const float* scores, int64_t j, bool add) {
    dense_kernels().multiply({turned_.data(), d_, rows_, scores, kPanel, kBlock, nullptr,
                              blocks_from(j), add, sums_.data() + j * d_});
  }
  /// The same of scores in pairs of queries.
  void add_pairs(const uint32_t* scores, int64_t j, bool add) {
    bf16_kernels().multiply_pairs({turned_pairs_.data(), d_, (rows_ + 1) / 2, scores, kPanel,
                                   kBlock, nullptr, blocks_from(j), add, sums_.data() + j * d_});
  }

  /// factor · the sums of keys [j, j + kBlock), as rows of d. @param out room for [kBlock, blocks]
  void rows(int64_t j, float factor, float* out) const {
    const float* from = sums_.data() + j / kPanel * kPanel * d_ + j % kPanel;
    for (int64_t c = 0; c < d_; c += kBlock) {
      dense_kernels().transpose(
          {from + c * kPanel, kPanel, std::min(kBlock, d_ - c), kBlock, out + c, kPanel}, factor);
    }
  }

 private:
  int64_t blocks_from(int64_t j) const { return blocks_of(std::min(kPanel, length_ - j)); }

  int64_t d_, length_;
  int64_t rows_ = 0;
  std::vector<float> turned_;           ///< [d, kPanel], a column a query
  std::vector<uint32_t> pairs_;         ///< [kGradientTile / 2, kPanel], in bfloat16
  std::vector<uint32_t> turned_pairs_;  ///< [d, kPanel / 2], in bfloat16
  std::vector<float> sums_;
};

/// One thread's working memory.
class HeadGradient {
 public:
  explicit HeadGradient(const GradientWork& work)
      : work_(work),
        of_(work.input),
        d_(of_.width()),
        length_(of_.length()),
        keys_(of_, work.bf16),
        values_(of_, work.bf16),
        key_slots_(of_, work.bf16),
        log_sum_(kGradientTile),
        mean_(kGradientTile),
        query_(kGradientTile, kPanel),
        grad_(kGradientTile, kPanel),
        weights_(kGradientTile, kPanel),
        by_scores_(kGradientTile, kPanel),
        by_query_(kGradientTile, kPanel),
        by_key_(of_, work.bf16),
        by_value_(of_, work.bf16),
        weight_pairs_(work.bf16 ? static_cast<size_t>(kGradientTile / 2 * kPanel) : 0),
        by_score_pairs_(weight_pairs_.size()),
        by_key_pairs_(weight_pairs_.size()) {}

  void run(int64_t patch, int64_t head) {
    first_ = patch * length_;
    head_ = head;
    keys_.pack(first_, kKey, head);
    values_.pack(first_, kValue, head);
    key_slots_.pack(first_, kKey, head);
    for (int64_t q = 0; q < length_; q += kGradientTile) {
      const int64_t rows = std::min(kGradientTile, length_ - q);
      take_queries(q, rows);
      for (int64_t j = 0; j < length_; j += kPanel) add_panel(q, rows, j);
      // The scores' gradient is in units of e, so that of a query has the plain factor.
      const float factor = 1 / std::sqrt(static_cast<float>(d_));
      for (int64_t i = 0; i < rows; ++i)
        scale_row(by_query_.panel(0) + i * kPanel, d_, factor, gradient_at(q + i, kQuery));
    }
    put_sums(by_key_, kKey, std::numbers::ln2_v<float>);  // of scaled queries
    put_sums(by_value_, kValue, 1);
  }

 private:
  /// Queries [q, q + rows) and what comes back to them; nothing does to slots without a say.
  void take_queries(int64_t q, int64_t rows) {
    of_.scaled_queries(first_, q, rows, head_, query_.panel(0));
    for (int64_t i = 0; i < rows; ++i) {
      const int64_t slot = first_ + q + i;
      const bool answers = of_.answers(slot);
      const int64_t at = of_.point(slot) * of_.channels() + head_ * d_;
      float* grad = grad_.panel(0) + i * kPanel;
      std::fill_n(grad, d_, 0.0f);
      mean_[static_cast<size_t>(i)] = 0;
      if (answers) {
        copy_row(work_.grad + at, d_, grad);
        mean_[static_cast<size_t>(i)] = dot(grad, work_.out + at, d_);
      }
      log_sum_[static_cast<size_t>(i)] = work_.log_sum[slot * of_.heads() + head_];
    }
    by_key_.take(query_.panel(0), rows);
    by_value_.take(grad_.panel(0), rows);
  }

  /// Keys and values [j, j + kPanel) against the tile's queries.
  void add_panel(int64_t q, int64_t rows, int64_t j) {
    float *weights = weights_.panel(0), *by_scores = by_scores_.panel(0);
    keys_.multiply(query_.panel(0), rows, j, weights);
    values_.multiply(grad_.panel(0), rows, j, by_scores);
    const int64_t count = std::min(kPanel, length_ - j);
    const AttentionGradient panel{weights,          by_scores,       rows,
                                  blocks_of(count), log_sum_.data(), mean_.data()};
    if (!work_.bf16) {
      gradient_kernels().attention_gradient(panel);
      key_slots_.multiply(by_scores, rows, j, j > 0, by_query_.panel(0));
      by_key_.add(by_scores, j, q > 0);
      by_value_.add(weights, j, q > 0);
      return;
    }
    bf16_kernels().attention_gradient(
        panel, {weight_pairs_.data(), by_score_pairs_.data(), by_key_pairs_.data(), count});
    key_slots_.multiply_pairs(by_key_pairs_.data(), rows, j, j > 0, by_query_.panel(0));
    by_key_.add_pairs(by_score_pairs_.data(), j, q > 0);
    by_value_.add_pairs(weight_pairs_.data(), j, q > 0);
  }

  /// The gradient of a slot's query, key or value.
  float* gradient_at(int64_t slot, int64_t part) {
    return work_.by_slot + ((first_ + slot) * 3 + part) * of_.channels() + head_ * d_;
  }

  void put_sums(const SumsByKey& sums, int64_t part, float factor) {
    for (int64_t j = 0; j < length_; j += kBlock) {
      sums.rows(j, factor, weights_.panel(0));
      for (int64_t i = 0; i < std::min(kBlock, length_ - j); ++i)
        copy_row(weights_.panel(0) + i * kPanel, d_, gradient_at(j + i, part));
    }
  }

  const GradientWork& work_;
  const AttentionInput& of_;
  int64_t d_, length_;
  int64_t first_ = 0, head_ = 0;
  ChannelFactor keys_, values_;
  SlotFactor key_slots_;
  std::vector<float> log_sum_, mean_;
  Tile query_, grad_, weights_, by_scores_, by_query_;
  SumsByKey by_key_, by_value_;
  std::vector<uint32_t> weight_pairs_, by_score_pairs_, by_key_pairs_;  ///< see AttentionPairs
};

/// Sums what the slots of each point have: its own first, then those that repeat it.
at::Tensor by_point(const AttentionInput& input, const at::Tensor& by_slot) {
  if (input.in_one_patch()) return by_slot;
  const int64_t n = input.points(), columns = by_slot.size(1);
  at::Tensor out = at::empty({n, columns}, by_slot.options());
  const auto* from = by_slot.const_data_ptr<float>();
  auto* to = out.data_ptr<float>();
  at::parallel_for(0, n, 64, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i)
      std::copy_n(from + input.slot_of(i) * columns, columns, to + i * columns);
  });
  for (int64_t slot = 0; slot < input.slots(); ++slot) {
    if (!input.answers(slot)) {
      dense_kernels().accumulate(from + slot * columns, columns, to + input.point(slot) * columns);
    }
  }
  return out;
}

at::Tensor patch_attention_backward_cpu(const at::Tensor& any_grad, const at::Tensor& qkv,
                                        const at::Tensor& out, const at::Tensor& log_sum,
                                        const std::optional<at::Tensor>& gather,
                                        const std::optional<at::Tensor>& inverse, int64_t heads,
                                        int64_t patch, bool bf16) {
  check_patch_attention_args("patch_attention_backward", qkv, gather, inverse, heads, patch);
  const AttentionInput input(qkv, gather, inverse, heads, patch);
  if (input.points() == 0) return at::zeros_like(qkv);
  const at::Tensor grad = any_grad.contiguous();
  check_patch_attention_backward_args(grad, out, log_sum, input.slots(), qkv, heads);
  at::Tensor by_slot = at::empty({input.slots(), qkv.size(1)}, qkv.options());
  const GradientWork work{input,
                          bf16,
                          grad.const_data_ptr<float>(),
                          out.const_data_ptr<float>(),
                          log_sum.const_data_ptr<float>(),
                          by_slot.data_ptr<float>()};
  at::parallel_for(0, input.patches() * heads, 1, [&](int64_t begin, int64_t end) {
    HeadGradient head(work);
    for (int64_t i = begin; i < end; ++i) head.run(i / heads, i % heads);
  });
  return by_point(input, by_slot);
}

}  // namespace
}  // namespace lte::ops

TORCH_LIBRARY_IMPL(lte, CPU, m) {
  m.impl("patch_attention_backward", lte::ops::patch_attention_backward_cpu);
}
