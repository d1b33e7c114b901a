// Products of matrices, plainly: what costs anything runs in the kernels of lte/ops.
#include <cmath>

#include "lte/tensor/own/functions.h"

namespace lte::tensor {

Tensor bmm(const Tensor& a, const Tensor& b) {
  const int64_t B = a.size(0), n = a.size(1), k = a.size(2), m = b.size(2);
  TORCH_CHECK(b.size(0) == B && b.size(1) == k && a.scalar_type() == b.scalar_type(), "bmm of ",
              a.sizes(), " and ", b.sizes());
  const Tensor left = a.contiguous(), right = b.contiguous(), out = zeros({B, n, m}, a.options());
  AT_DISPATCH_FLOATING_TYPES(a.scalar_type(), "bmm", [&] {
    const auto* x = left.const_data_ptr<scalar_t>();
    const auto* y = right.const_data_ptr<scalar_t>();
    auto* to = out.data_ptr<scalar_t>();
    for (int64_t row = 0; row < B * n; ++row) {
      for (int64_t i = 0; i < k; ++i) {
        const scalar_t factor = x[row * k + i];
        const scalar_t* from = y + (row / n * k + i) * m;
        for (int64_t c = 0; c < m; ++c) to[row * m + c] += factor * from[c];
      }
    }
  });
  return out;
}

Tensor baddbmm(const Tensor& sum, const Tensor& a, const Tensor& b) { return sum + bmm(a, b); }

Tensor mv(const Tensor& a, const Tensor& x) {
  return bmm(a.unsqueeze(0), x.unsqueeze(1).unsqueeze(0)).view({-1});
}

void mm_out(const Tensor& out, const Tensor& a, const Tensor& b) {
  out.copy_(bmm(a.unsqueeze(0), b.unsqueeze(0)).squeeze(0));
}

void addmm_out(const Tensor& out, const Tensor& sum, const Tensor& a, const Tensor& b) {
  out.copy_(sum + bmm(a.unsqueeze(0), b.unsqueeze(0)).squeeze(0));
}

Tensor linear(const Tensor& x, const Tensor& weight, const std::optional<Tensor>& bias) {
  const Tensor rows = x.reshape({1, -1, weight.size(1)});
  std::vector<int64_t> shape = x.sizes().vec();
  shape.back() = weight.size(0);
  const Tensor out = bmm(rows, weight.t().unsqueeze(0)).view(shape);
  return bias && bias->defined() ? out + *bias : out;
}

Tensor scaled_dot_product_attention(const Tensor& query, const Tensor& key, const Tensor& value) {
  const double scale = 1 / std::sqrt(static_cast<double>(query.size(-1)));
  const auto matrices = [](const Tensor& t) { return t.reshape({-1, t.size(-2), t.size(-1)}); };
  const Tensor scores = bmm(matrices(query), matrices(key).transpose(1, 2)).mul(scale);
  return bmm(softmax(scores, 2), matrices(value)).view(query.sizes());
}

}  // namespace lte::tensor
