// Makers of tensors, and what moves numbers between them.
#include "lte/tensor/own/functions.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "lte/base/random.h"
#include "lte/tensor/own/strided.h"

namespace lte::tensor {
namespace {

/// Calls use(row of t, index[i]) ... for whole slices along an axis.
template <typename Use>
void over_slices(const Tensor& index, const Use& use) {
  const Tensor rows = index.contiguous();
  const auto* at = rows.const_data_ptr<int64_t>();
  for (int64_t i = 0; i < rows.numel(); ++i) use(i, at[i]);
}

thread_local Rng random_numbers(0);

void check_index(int64_t index, int64_t size) {
  TORCH_CHECK(index >= 0 && index < size, "index ", index, " of an axis of ", size);
}

}  // namespace

Tensor empty(IntArrayRef sizes, const TensorOptions& options) { return {sizes, options.type}; }

Tensor empty_strided(IntArrayRef sizes, IntArrayRef strides, const TensorOptions& options) {
  int64_t last = 0;
  for (size_t i = 0; i < sizes.size(); ++i) last += std::max<int64_t>(0, sizes[i] - 1) * strides[i];
  const Tensor memory({last + 1}, options.type);
  return {std::shared_ptr<std::byte>(std::make_shared<Tensor>(memory), memory.bytes()), sizes,
          strides, options.type};
}

Tensor empty_like(const Tensor& like) { return {like.sizes(), like.scalar_type()}; }

Tensor full(IntArrayRef sizes, const Scalar& value, const TensorOptions& options) {
  const Tensor out(sizes, options.type);
  out.fill_(value);
  return out;
}

Tensor arange(int64_t begin, int64_t end, const TensorOptions& options) {
  const Tensor out({end - begin}, kLong);
  std::iota(out.data_ptr<int64_t>(), out.data_ptr<int64_t>() + out.numel(), begin);
  return out.to(options);
}

Tensor from_blob(void* data, IntArrayRef sizes, const TensorOptions& options) {
  return from_blob(data, sizes, Tensor(sizes, kBool).strides(), options);
}
Tensor from_blob(void* data, IntArrayRef sizes, IntArrayRef strides, const TensorOptions& options) {
  return {std::shared_ptr<std::byte>(std::shared_ptr<void>(), static_cast<std::byte*>(data)), sizes,
          strides, options.type};
}

void manual_seed(uint64_t seed) { random_numbers = Rng(seed); }

const Tensor& Tensor::uniform_(double low, double high) const {
  TORCH_CHECK(is_contiguous(), "random numbers with gaps");
  auto* values = data_ptr<float>();
  for (int64_t i = 0; i < numel(); ++i)
    values[i] = random_numbers.uniform(static_cast<float>(low), static_cast<float>(high));
  return *this;
}

const Tensor& Tensor::normal_(double mean, double deviation) const {
  TORCH_CHECK(is_contiguous(), "random numbers with gaps");
  auto* values = data_ptr<float>();
  const double scale = deviation * std::sqrt(3.0) / 65536;
  for (int64_t i = 0; i < numel(); ++i) {
    const uint64_t bits = random_numbers.next_u64();
    const auto sum = static_cast<double>((bits & 0xffff) + (bits >> 16 & 0xffff) +
                                         (bits >> 32 & 0xffff) + (bits >> 48));
    values[i] = static_cast<float>(mean + (sum - 131070) * scale);
  }
  return *this;
}

Tensor cat(TensorList tensors, int64_t axis) {
  TORCH_CHECK(!tensors.empty(), "cat of no tensors");
  if (tensors.size() == 1) return tensors[0].clone();
  std::vector<int64_t> shape = tensors[0].sizes().vec();
  const auto at = static_cast<size_t>(axis < 0 ? axis + tensors[0].dim() : axis);
  shape[at] = 0;
  for (const Tensor& t : tensors) shape[at] += t.size(axis);
  const Tensor out(shape, tensors[0].scalar_type());
  int64_t begin = 0;
  for (const Tensor& t : tensors) {
    TORCH_CHECK(t.scalar_type() == out.scalar_type(), "cat of ", out.scalar_type(), " and ",
                t.scalar_type());
    const Tensor part = out.narrow(axis, begin, t.size(axis));
    TORCH_CHECK(part.sizes() == t.sizes(), "cat of shapes ", tensors[0].sizes(), " and ",
                t.sizes());
    part.copy_(t);
    begin += t.size(axis);
  }
  return out;
}

Tensor stack(TensorList tensors, int64_t axis) {
  std::vector<Tensor> wide;
  for (const Tensor& t : tensors) wide.push_back(t.unsqueeze(axis));
  return cat(wide, axis);
}

Tensor constant_pad_nd(const Tensor& t, IntArrayRef pad) {
  std::vector<int64_t> shape = t.sizes().vec();
  for (size_t i = 0; i < pad.size() / 2; ++i)
    shape[shape.size() - 1 - i] += pad[2 * i] + pad[2 * i + 1];
  const Tensor out = zeros(shape, t.options());
  Tensor middle = out;
  for (size_t i = 0; i < pad.size() / 2; ++i) {
    const auto axis = static_cast<int64_t>(shape.size() - 1 - i);
    middle = middle.narrow(axis, pad[2 * i], t.size(axis));
  }
  middle.copy_(t);
  return out;
}

Tensor repeat_interleave(const Tensor& times) {
  std::vector<int64_t> out;
  over_slices(times, [&](int64_t i, int64_t count) {
    out.insert(out.end(), static_cast<size_t>(count), i);
  });
  return tensor(out, kLong);
}

Tensor Tensor::repeat(IntArrayRef times) const {
  TORCH_CHECK(times.size() == 1 && dim() == 1, "repeat of ", sizes());
  return cat(std::vector<Tensor>(static_cast<size_t>(times[0]), *this));
}

Tensor Tensor::index_select(int64_t axis, const Tensor& rows) const {
  TORCH_CHECK(rows.dim() == 1, "index_select: indices must be in a row, got ", rows.sizes());
  std::vector<int64_t> shape = sizes().vec();
  shape[index_of(axis)] = rows.size(0);
  const Tensor out(shape, scalar_type());
  if (out.numel() == 0) return out;
  if (axis == 0 && is_contiguous()) {
    const size_t bytes = nbytes() / static_cast<size_t>(size(0));
    over_slices(rows, [&](int64_t i, int64_t row) {
      check_index(row, size(0));
      std::copy_n(data_.get() + static_cast<size_t>(row) * bytes, bytes,
                  out.bytes() + static_cast<size_t>(i) * bytes);
    });
  } else {
    over_slices(rows,
                [&](int64_t i, int64_t row) { out.select(axis, i).copy_(select(axis, row)); });
  }
  return out;
}

Tensor Tensor::gather(int64_t axis, const Tensor& index) const {
  const Tensor out(index.sizes(), scalar_type());
  const int64_t step = stride(axis);
  Tensor first = *this;  // of the shape of `index`, all at the start of the axis
  for (int64_t i = 0; i < dim(); ++i) first = first.narrow(i, 0, i == axis ? 1 : index.size(i));
  first = first.expand(index.sizes());
  visit_type(scalar_type(), [&](auto type) {
    using T = decltype(type);
    over_runs<3>(out.sizes(), {&out, &first, &index},
                 [&](const auto& at, const auto& steps, int64_t count) {
                   for (int64_t i = 0; i < count; ++i) {
                     const int64_t row = reinterpret_cast<const int64_t*>(at[2])[i * steps[2]];
                     check_index(row, size(axis));
                     reinterpret_cast<T*>(at[0])[i * steps[0]] =
                         reinterpret_cast<const T*>(at[1])[i * steps[1] + row * step];
                   }
                 });
  });
  return out;
}

const Tensor& Tensor::scatter_(int64_t axis, const Tensor& index, const Tensor& from) const {
  TORCH_CHECK(dim() == 1 && axis == 0, "scatter_ into ", sizes());
  return index_copy_(0, index, from);
}

const Tensor& Tensor::index_copy_(int64_t axis, const Tensor& rows, const Tensor& from) const {
  if (numel() == 0) return *this;
  const bool dense =
      axis == 0 && is_contiguous() && from.is_contiguous() && scalar_type() == from.scalar_type();
  const size_t bytes = nbytes() / static_cast<size_t>(size(axis));
  over_slices(rows, [&](int64_t i, int64_t row) {
    check_index(row, size(axis));
    if (dense) {
      std::copy_n(from.bytes() + static_cast<size_t>(i) * bytes, bytes,
                  data_.get() + static_cast<size_t>(row) * bytes);
    } else {
      select(axis, row).copy_(from.select(axis, i));
    }
  });
  return *this;
}

const Tensor& Tensor::index_add_(int64_t axis, const Tensor& rows, const Tensor& from) const {
  over_slices(rows, [&](int64_t i, int64_t row) {
    const Tensor to = select(axis, row);
    to.copy_(to + from.select(axis, i));
  });
  return *this;
}

Tensor Tensor::scatter_reduce(int64_t axis, const Tensor& index, const Tensor& from,
                              const char* reduce) const {
  const bool greatest = std::string_view(reduce) == "amax";
  TORCH_CHECK(axis == 0 && dim() == 2 && (greatest || std::string_view(reduce) == "amin"),
              "scatter_reduce ", reduce, " into ", sizes());
  const Tensor out = clone();
  const int64_t columns = size(1);
  visit_type(scalar_type(), [&](auto type) {
    using T = decltype(type);
    auto* to = out.data_ptr<T>();
    for (int64_t i = 0; i < index.size(0); ++i) {
      const Tensor rows = index.select(0, i), values = from.select(0, i);
      const auto* row = rows.const_data_ptr<int64_t>();
      const auto* value = values.const_data_ptr<T>();
      const int64_t row_step = rows.stride(0), step = values.stride(0);
      for (int64_t c = 0; c < columns; ++c) {
        T& best = to[row[c * row_step] * columns + c];
        const T& v = value[c * step];
        if ((greatest ? v > best : v < best) || v != v) best = v;
      }
    }
  });
  return out;
}

}  // namespace lte::tensor
