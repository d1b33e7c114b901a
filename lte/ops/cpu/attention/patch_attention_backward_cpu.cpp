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

#include <ATen/Parallel.h>
#include <ATen/ops/empty.h>
#include <ATen/ops/zeros_like.h>
#include <torch/library.h>

#include "lte/ops/cpu/attention/attention_input.h"
#include "lte/ops/cpu/attention/head_factors.h"
#include "lte/ops/cpu/dense/packed_linear.h"
#include "lte/ops/patch_attention_args.h"

namespace lte::ops {
namespace {

constexpr int64_t kTile = 48;  ///< queries at a time
constexpr int64_t kQuery = AttentionInput::kQuery, kKey = AttentionInput::kKey,
                  kValue = AttentionInput::kValue;

struct Work {
  const AttentionInput& input;
  bool bf16;
  const float* grad;     ///< [n, C]
  const float* out;      ///< [n, C]
  const float* log_sum;  ///< [slots, heads]
  float* by_slot;        ///< [slots, 3C]
};

/// Gradients by keys or values: sums over queries of scores times rows, for one head of a patch.
/// They are kept as [panels of keys, d, kPanel], as scores are then the right factor, where they
/// lie: in bfloat16 their rows become pairs at once.
class SumsByKey {
 public:
  SumsByKey(const AttentionInput& input, bool bf16)
      : d_(input.width()),
        length_(input.length()),
        bf16_(bf16),
        turned_(static_cast<size_t>(d_ * kPanel)),
        pairs_(bf16 ? static_cast<size_t>(kTile / 2 * kPanel) : 0),
        sums_(static_cast<size_t>(panels_of(length_) * d_ * kPanel)) {}

  /// The left factor of the sums to come. @param tile [rows, d], one panel
  void take(const float* tile, int64_t rows) {
    rows_ = rows;
    for (int64_t r = 0; r < rows; ++r) {
      for (int64_t c = 0; c < d_; ++c) turned_[c * kPanel + r] = tile[r * kPanel + c];
    }
  }

  /// Sums of keys [j, j + kPanel) (+)= the tile, transposed, times scores [rows, kPanel].
  void add(const float* scores, int64_t j, bool add) {
    const int64_t blocks = blocks_of(std::min(kPanel, length_ - j));
    float* to = sums_.data() + j * d_;
    if (!bf16_) {
      dense_kernels().multiply(
          {turned_.data(), d_, rows_, scores, kPanel, kBlock, nullptr, blocks, add, to});
      return;
    }
    pair_up_rows(scores, rows_, blocks, pairs_.data());
    bf16_kernels().multiply(
        {turned_.data(), d_, rows_, pairs_.data(), kPanel, kBlock, nullptr, blocks, add, to});
  }

  float at(int64_t key, int64_t channel) const {
    return sums_[(key / kPanel * d_ + channel) * kPanel + key % kPanel];
  }

 private:
  int64_t d_, length_;
  bool bf16_;
  int64_t rows_ = 0;
  std::vector<float> turned_;    ///< [d, kPanel], a column a query
  std::vector<uint32_t> pairs_;  ///< [kTile / 2, kPanel]
  std::vector<float> sums_;
};

/// One thread's working memory.
class HeadGradient {
 public:
  explicit HeadGradient(const Work& work)
      : work_(work),
        of_(work.input),
        d_(of_.width()),
        length_(of_.length()),
        keys_(of_, work.bf16),
        values_(of_, work.bf16),
        key_slots_(of_, work.bf16),
        log_sum_(kTile),
        mean_(kTile),
        query_(kTile, kPanel),
        grad_(kTile, kPanel),
        weights_(kTile, kPanel),
        by_scores_(kTile, kPanel),
        by_query_(kTile, kPanel),
        by_key_(of_, work.bf16),
        by_value_(of_, work.bf16) {}

  void run(int64_t patch, int64_t head) {
    first_ = patch * length_;
    head_ = head;
    keys_.pack(first_, kKey, head);
    values_.pack(first_, kValue, head);
    key_slots_.pack(first_, kKey, head);
    for (int64_t q = 0; q < length_; q += kTile) {
      const int64_t rows = std::min(kTile, length_ - q);
      take_queries(q, rows);
      for (int64_t j = 0; j < length_; j += kPanel) add_panel(q, rows, j);
      // The scores' gradient is in units of e, so that of a query has the plain factor.
      put(q, rows, kQuery, 1 / std::sqrt(static_cast<float>(d_)),
          [&](int64_t i, int64_t c) { return by_query_.panel(0)[i * kPanel + c]; });
    }
    put(0, length_, kKey, std::numbers::ln2_v<float>,  // of scaled queries
        [&](int64_t i, int64_t c) { return by_key_.at(i, c); });
    put(0, length_, kValue, 1, [&](int64_t i, int64_t c) { return by_value_.at(i, c); });
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
      float mean = 0;
      for (int64_t c = 0; c < d_; ++c) {
        grad[c] = answers ? work_.grad[at + c] : 0;
        mean += answers ? work_.grad[at + c] * work_.out[at + c] : 0;
      }
      mean_[static_cast<size_t>(i)] = mean;
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
    gradient_kernels().attention_gradient({weights, by_scores, rows,
                                           blocks_of(std::min(kPanel, length_ - j)),
                                           log_sum_.data(), mean_.data()});
    key_slots_.multiply(by_scores, rows, j, j > 0, by_query_.panel(0));
    by_key_.add(by_scores, j, q > 0);
    by_value_.add(weights, j, q > 0);
  }

  /// of(row, channel) times `factor` as the gradient of slots [q, q + rows).
  template <typename Of>
  void put(int64_t q, int64_t rows, int64_t part, float factor, const Of& of) {
    for (int64_t i = 0; i < rows; ++i) {
      float* to = work_.by_slot + ((first_ + q + i) * 3 + part) * of_.channels() + head_ * d_;
      for (int64_t c = 0; c < d_; ++c) to[c] = of(i, c) * factor;
    }
  }

  const Work& work_;
  const AttentionInput& of_;
  int64_t d_, length_;
  int64_t first_ = 0, head_ = 0;
  ChannelFactor keys_, values_;
  SlotFactor key_slots_;
  std::vector<float> log_sum_, mean_;
  Tile query_, grad_, weights_, by_scores_, by_query_;
  SumsByKey by_key_, by_value_;
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
  const Work work{input,
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
