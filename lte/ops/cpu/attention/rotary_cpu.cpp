#include "lte/ops/cpu/attention/rotary_cpu.h"

#include <algorithm>

#include "lte/tensor/functions.h"

namespace lte::ops {
namespace {

constexpr int64_t kRotaryGrain =
    64;  ///< points below which a second thread costs more than it gains

/// One head of one point: `pairs` pairs.
void rotate_head(const float* __restrict from, const float* __restrict cosine,
                 const float* __restrict sine, float direction, int64_t pairs,
                 float* __restrict to) {
  for (int64_t i = 0; i < pairs; ++i) {
    const float a = from[i], b = from[pairs + i], s = direction * sine[i];
    to[i] = a * cosine[i] - b * s;
    to[pairs + i] = a * s + b * cosine[i];
  }
}

}  // namespace

at::Tensor rotate_heads_cpu(const at::Tensor& any_qkv, const at::Tensor& any_cosine,
                            const at::Tensor& any_sine, int64_t heads, bool back) {
  const at::Tensor qkv = any_qkv.contiguous(), cosine = any_cosine.contiguous(),
                   sine = any_sine.contiguous();
  at::Tensor out = at::empty(qkv.sizes(), qkv.options());
  const int64_t n = qkv.size(0), row = qkv.size(1), pairs = cosine.size(1);
  const int64_t turned = 2 * heads * 2 * pairs;  // q and k; the rest of a row is v
  const auto* from = qkv.const_data_ptr<float>();
  const auto* c = cosine.const_data_ptr<float>();
  const auto* s = sine.const_data_ptr<float>();
  auto* to = out.data_ptr<float>();
  at::parallel_for(0, n, kRotaryGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) {
      for (int64_t at = i * row; at < i * row + turned; at += 2 * pairs) {
        rotate_head(from + at, c + i * pairs, s + i * pairs, back ? -1.0F : 1.0F, pairs, to + at);
      }
      std::copy(from + i * row + turned, from + (i + 1) * row, to + i * row + turned);
    }
  });
  return out;
}

}  // namespace lte::ops
