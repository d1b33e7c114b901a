// Sums, extremes and orders.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "lte/tensor/own/functions.h"
#include "lte/tensor/own/strided.h"

namespace lte::tensor {
namespace {

/// The axis last, the others in their order.
Tensor with_last(const Tensor& t, int64_t axis) {
  std::vector<int64_t> axes;
  const int64_t last = axis < 0 ? axis + t.dim() : axis;
  for (int64_t i = 0; i < t.dim(); ++i)
    if (i != last) axes.push_back(i);
  axes.push_back(last);
  return t.permute(axes);
}

/// of(numbers, step, count) of each row along an axis, which is gone from the result.
template <typename T, typename Out, typename Of>
Tensor reduced(const Tensor& t, int64_t axis, const Of& of) {
  const Tensor rows = with_last(t, axis);
  const int64_t count = rows.size(-1), step = rows.stride(-1);
  TORCH_CHECK(count > 0, "nothing along axis ", axis, " of shape ", t.sizes());
  const Tensor first = rows.select(-1, 0), out(first.sizes(), type_of<Out>());
  over_runs<2>(out.sizes(), {&out, &first}, [&](const auto& at, const auto& steps, int64_t n) {
    for (int64_t i = 0; i < n; ++i)
      reinterpret_cast<Out*>(at[0])[i * steps[0]] =
          of(reinterpret_cast<const T*>(at[1]) + i * steps[1], step, count);
  });
  return out;
}

Tensor with_axis(const Tensor& t, int64_t axis, bool keepdim) {
  return keepdim ? t.unsqueeze(axis) : t;
}

Tensor all_in_a_row(const Tensor& t) { return t.reshape({-1}); }

/// What is not a number is the extreme.
template <typename Better>
std::tuple<Tensor, Tensor> extreme(const Tensor& t, int64_t axis, const Better& better) {
  return visit_type(t.scalar_type(), [&](auto type) {
    using T = decltype(type);
    const Tensor index =
        reduced<T, int64_t>(t, axis, [&](const T* row, int64_t step, int64_t count) {
          int64_t best = 0;
          for (int64_t i = 1; i < count && row[best * step] == row[best * step]; ++i) {
            const T& value = row[i * step];
            if (better(value, row[best * step]) || value != value) best = i;
          }
          return best;
        });
    const Tensor values = t.gather(axis, index.unsqueeze(axis)).squeeze(axis);
    return std::tuple{values, index};
  });
}

template <typename T>
Tensor indices_in_order(const Tensor& t) {
  const auto* values = t.const_data_ptr<T>();
  const Tensor order = arange(t.size(0));
  auto* first = order.data_ptr<int64_t>();
  std::stable_sort(first, first + t.size(0),
                   [&](int64_t a, int64_t b) { return values[a] < values[b]; });
  return order;
}

}  // namespace

Tensor Tensor::sum(int64_t axis, bool keepdim) const {
  return visit_type(scalar_type(), [&](auto type) {
    using T = decltype(type);
    using Sum = std::conditional_t<std::is_floating_point_v<T>, double, int64_t>;
    using Out = std::conditional_t<std::is_floating_point_v<T>, T, int64_t>;
    const Tensor out = reduced<T, Out>(*this, axis, [](const T* row, int64_t step, int64_t count) {
      Sum sum = 0;
      for (int64_t i = 0; i < count; ++i) sum += static_cast<Sum>(row[i * step]);
      return static_cast<Out>(sum);
    });
    return with_axis(out, axis, keepdim);
  });
}
Tensor Tensor::mean(int64_t axis, bool keepdim) const {
  const auto count = static_cast<double>(size(axis));
  return sum(axis, keepdim).div(count);
}
Tensor Tensor::sum() const { return all_in_a_row(*this).sum(0); }
Tensor Tensor::mean() const { return all_in_a_row(*this).mean(0); }

std::tuple<Tensor, Tensor> Tensor::max(int64_t axis) const {
  return extreme(*this, axis, [](const auto& a, const auto& b) { return a > b; });
}
std::tuple<Tensor, Tensor> Tensor::min(int64_t axis) const {
  return extreme(*this, axis, [](const auto& a, const auto& b) { return a < b; });
}
Tensor Tensor::max() const { return std::get<0>(all_in_a_row(*this).max(0)); }
Tensor Tensor::min() const { return std::get<0>(all_in_a_row(*this).min(0)); }

Tensor Tensor::any(int64_t axis) const {
  return reduced<bool, bool>(*this, axis, [](const bool* row, int64_t step, int64_t count) {
    for (int64_t i = 0; i < count; ++i)
      if (row[i * step]) return true;
    return false;
  });
}
Tensor Tensor::any() const {
  return numel() == 0 ? full({}, 0, kBool) : all_in_a_row(*this).any(0);
}
Tensor Tensor::all() const { return logical_not().any().logical_not(); }

Tensor Tensor::cumsum(int64_t axis) const {
  TORCH_CHECK(dim() == 1 && axis == 0 && scalar_type() == kLong, "cumsum of ", sizes(), " ",
              scalar_type());
  const Tensor out = clone();
  auto* values = out.data_ptr<int64_t>();
  std::partial_sum(values, values + numel(), values);
  return out;
}

Tensor Tensor::nonzero() const {
  const Tensor dense = (scalar_type() == kBool ? *this : ne(0)).contiguous();
  const auto* values = dense.const_data_ptr<bool>();
  const int64_t count = std::count(values, values + numel(), true), axes = dim();
  const Tensor out({count, axes}, kLong);
  auto* to = out.data_ptr<int64_t>();
  for (int64_t i = 0; i < numel(); ++i) {
    if (!values[i]) continue;
    for (int64_t axis = axes, rest = i; axis-- > 0; rest /= size(axis))
      to[axis] = rest % size(axis);
    to += axes;
  }
  return out;
}

std::tuple<Tensor, Tensor> sort(const Tensor& t, bool stable, int64_t axis, bool descending) {
  TORCH_CHECK(stable && axis == 0 && !descending && t.dim() == 1, "a sort of another kind");
  const Tensor values = t.contiguous();
  const Tensor order = visit_type(
      t.scalar_type(), [&](auto type) { return indices_in_order<decltype(type)>(values); });
  return {values.index_select(0, order), order};
}

std::tuple<Tensor, Tensor, Tensor> unique_consecutive(const Tensor& sorted, bool, bool) {
  const Tensor inverse = empty_like(sorted);
  const auto* values = sorted.const_data_ptr<int64_t>();
  auto* run = inverse.data_ptr<int64_t>();
  std::vector<int64_t> unique, counts;
  for (int64_t i = 0; i < sorted.size(0); ++i) {
    if (unique.empty() || unique.back() != values[i]) {
      unique.push_back(values[i]);
      counts.push_back(0);
    }
    ++counts.back();
    run[i] = static_cast<int64_t>(unique.size()) - 1;
  }
  return {tensor(unique, kLong), inverse, tensor(counts, kLong)};
}

Tensor bincount(const Tensor& t, const Tensor& /*weights*/, int64_t least) {
  const Tensor dense = t.contiguous();
  const auto* values = dense.const_data_ptr<int64_t>();
  std::vector<int64_t> counts(static_cast<size_t>(least));
  for (int64_t i = 0; i < t.size(0); ++i) {
    const auto value = static_cast<size_t>(values[i]);
    if (value >= counts.size()) counts.resize(value + 1);
    ++counts[value];
  }
  return tensor(counts, kLong);
}

Tensor layer_norm(const Tensor& x, IntArrayRef shape, const Tensor& gain, const Tensor& bias,
                  double epsilon) {
  TORCH_CHECK(shape.size() == 1 && shape[0] == x.size(-1), "layer_norm: of ", shape);
  const Tensor wide = x.to(kDouble);
  const Tensor centered = wide - wide.mean(-1, true);
  const Tensor deviation = centered.square().mean(-1, true).add(epsilon).sqrt();
  return centered.div(deviation).to(x.scalar_type()) * gain + bias;
}

Tensor log_softmax(const Tensor& t, int64_t axis) {
  const Tensor less = t - std::get<0>(t.max(axis)).unsqueeze(axis);
  return less - less.exp().sum(axis, true).log();
}
Tensor softmax(const Tensor& t, int64_t axis) { return log_softmax(t, axis).exp(); }

}  // namespace lte::tensor
