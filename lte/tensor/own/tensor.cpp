#include "lte/tensor/own/tensor.h"

#include <new>
#include <numeric>

#include "lte/tensor/own/functions.h"
#include "lte/tensor/own/strided.h"

namespace lte::tensor {
namespace {

constexpr std::align_val_t kAlignment{64};

int64_t product(IntArrayRef sizes) {
  return std::accumulate(sizes.begin(), sizes.end(), int64_t{1}, std::multiplies<>());
}

std::shared_ptr<std::byte> allocated(size_t bytes) {
  if (bytes == 0) bytes = 1;
  return {static_cast<std::byte*>(::operator new(bytes, kAlignment)),
          [](std::byte* data) { ::operator delete(data, kAlignment); }};
}

}  // namespace

Tensor::Tensor(std::shared_ptr<std::byte> data, IntArrayRef sizes, IntArrayRef strides,
               ScalarType type)
    : data_(std::move(data)) {
  TORCH_CHECK(sizes.size() <= kMaxDims, "more than ", kMaxDims, " axes: ", sizes);
  Shape shape{type, sizes.size()};
  std::copy(sizes.begin(), sizes.end(), shape.sizes.begin());
  std::copy(strides.begin(), strides.end(), shape.strides.begin());
  shape_ = std::make_shared<const Shape>(shape);
}

Tensor::Tensor(IntArrayRef sizes, ScalarType type) {
  TORCH_CHECK(sizes.size() <= kMaxDims, "more than ", kMaxDims, " axes: ", sizes);
  std::array<int64_t, kMaxDims> strides{};
  int64_t step = 1;
  for (size_t i = sizes.size(); i-- > 0; step *= std::max<int64_t>(1, sizes[i])) strides[i] = step;
  *this = Tensor(allocated(static_cast<size_t>(product(sizes)) * size_of(type)), sizes,
                 {strides.data(), sizes.size()}, type);
}

size_t Tensor::index_of(int64_t axis) const {
  const int64_t index = axis < 0 ? axis + dim() : axis;
  TORCH_CHECK(index >= 0 && index < dim(), "axis ", axis, " of a tensor of shape ", sizes());
  return static_cast<size_t>(index);
}

Tensor Tensor::view_at(int64_t offset, const Shape& shape) const {
  Tensor out;
  const auto bytes = offset * static_cast<int64_t>(element_size());
  out.data_ = {data_, data_.get() + bytes};
  out.shape_ = std::make_shared<const Shape>(shape);
  return out;
}

int64_t Tensor::numel() const { return product(sizes()); }

bool Tensor::is_contiguous() const {
  int64_t step = 1;
  for (size_t i = shape_->dims; i-- > 0;) {
    if (shape_->sizes[i] == 0) return true;
    if (shape_->sizes[i] != 1 && shape_->strides[i] != step) return false;
    step *= shape_->sizes[i];
  }
  return true;
}

Tensor Tensor::select(int64_t axis, int64_t index) const {
  const size_t at = index_of(axis);
  TORCH_CHECK(index >= 0 && index < size(axis), "index ", index, " of axis ", axis, " of shape ",
              sizes());
  Shape shape = *shape_;
  const auto i = static_cast<ptrdiff_t>(at);
  std::copy(shape.sizes.begin() + i + 1, shape.sizes.end(), shape.sizes.begin() + i);
  std::copy(shape.strides.begin() + i + 1, shape.strides.end(), shape.strides.begin() + i);
  --shape.dims;
  return view_at(index * stride(axis), shape);
}

Tensor Tensor::narrow(int64_t axis, int64_t begin, int64_t count) const {
  TORCH_CHECK(begin >= 0 && count >= 0 && begin + count <= size(axis), "[", begin, ", ",
              begin + count, ") of axis ", axis, " of shape ", sizes());
  Shape shape = *shape_;
  shape.sizes[index_of(axis)] = count;
  return view_at(begin * stride(axis), shape);
}

Tensor Tensor::view(IntArrayRef wanted) const {
  std::vector<int64_t> shape = wanted.vec();
  const auto rest = std::find(shape.begin(), shape.end(), -1);
  if (rest != shape.end()) {
    *rest = 1;
    const int64_t others = product(shape);
    *rest = others > 0 ? numel() / others : 0;
  }
  TORCH_CHECK(product(shape) == numel(), "shape ", sizes(), " is no view of ", wanted);
  // The axes of this that are walked through evenly, joined, and then taken apart.
  std::vector<int64_t> strides(shape.size());
  size_t next = shape.size();
  for (size_t last = shape_->dims; numel() > 0 && last > 0;) {
    int64_t count = shape_->sizes[--last];
    int64_t step = shape_->strides[last];
    while (last > 0 && (shape_->sizes[last - 1] == 1 || count == 1 ||
                        shape_->strides[last - 1] == step * count)) {
      --last;
      if (count == 1) step = shape_->strides[last];
      count *= shape_->sizes[last];
    }
    int64_t left = count;
    while (next > 0 && (left > 1 || shape[next - 1] == 1)) {
      TORCH_CHECK(left % shape[next - 1] == 0, "shape ", sizes(), " with strides ", this->strides(),
                  " cannot be seen as ", wanted);
      left /= shape[--next];
      strides[next] = step;
      step *= shape[next];
    }
  }
  return {data_, shape, strides, scalar_type()};
}

Tensor Tensor::permute(IntArrayRef axes) const {
  Shape shape = *shape_;
  for (size_t i = 0; i < axes.size(); ++i) {
    shape.sizes[i] = size(axes[i]);
    shape.strides[i] = stride(axes[i]);
  }
  return view_at(0, shape);
}

Tensor Tensor::transpose(int64_t a, int64_t b) const {
  Shape shape = *shape_;
  std::swap(shape.sizes[index_of(a)], shape.sizes[index_of(b)]);
  std::swap(shape.strides[index_of(a)], shape.strides[index_of(b)]);
  return view_at(0, shape);
}

Tensor Tensor::unsqueeze(int64_t axis) const {
  Shape shape = *shape_;
  TORCH_CHECK(shape.dims < kMaxDims, "more than ", kMaxDims, " axes");
  const auto at = static_cast<ptrdiff_t>(axis < 0 ? axis + dim() + 1 : axis);
  std::copy_backward(shape.sizes.begin() + at, shape.sizes.end() - 1, shape.sizes.end());
  std::copy_backward(shape.strides.begin() + at, shape.strides.end() - 1, shape.strides.end());
  shape.sizes[static_cast<size_t>(at)] = 1;
  shape.strides[static_cast<size_t>(at)] = 1;
  ++shape.dims;
  return view_at(0, shape);
}

Tensor Tensor::squeeze(int64_t axis) const { return size(axis) == 1 ? select(axis, 0) : *this; }

Tensor Tensor::expand(IntArrayRef wanted) const {
  if (wanted == sizes()) return *this;
  TORCH_CHECK(wanted.size() >= shape_->dims && wanted.size() <= kMaxDims, "shape ", sizes(),
              " expanded to ", wanted);
  Shape shape{scalar_type(), wanted.size()};
  const size_t added = wanted.size() - shape_->dims;
  for (size_t i = 0; i < wanted.size(); ++i) {
    const bool own = i >= added && shape_->sizes[i - added] == wanted[i];
    TORCH_CHECK(own || i < added || shape_->sizes[i - added] == 1, "shape ", sizes(),
                " expanded to ", wanted);
    shape.sizes[i] = wanted[i];
    shape.strides[i] = own ? shape_->strides[i - added] : 0;
  }
  return view_at(0, shape);
}

std::vector<Tensor> Tensor::unbind(int64_t axis) const {
  std::vector<Tensor> parts;
  for (int64_t i = 0; i < size(axis); ++i) parts.push_back(select(axis, i));
  return parts;
}

std::vector<Tensor> Tensor::split_with_sizes(IntArrayRef counts, int64_t axis) const {
  TORCH_CHECK(std::accumulate(counts.begin(), counts.end(), int64_t{0}) == size(axis), "parts of ",
              counts, " of shape ", sizes());
  std::vector<Tensor> parts;
  int64_t begin = 0;
  for (const int64_t count : counts) {
    parts.push_back(narrow(axis, begin, count));
    begin += count;
  }
  return parts;
}

std::vector<Tensor> Tensor::chunk(int64_t chunks, int64_t axis) const {
  TORCH_CHECK(size(axis) % chunks == 0, chunks, " chunks of shape ", sizes());
  return split_with_sizes(std::vector<int64_t>(static_cast<size_t>(chunks), size(axis) / chunks),
                          axis);
}

Tensor Tensor::reshape(IntArrayRef wanted) const { return contiguous().view(wanted); }

Tensor Tensor::flatten(int64_t first) const {
  std::vector<int64_t> shape(sizes().begin(), sizes().begin() + first);
  shape.push_back(product({sizes().begin() + first, static_cast<size_t>(dim() - first)}));
  return reshape(shape);
}

Tensor Tensor::to(ScalarType type) const {
  if (type == scalar_type()) return *this;
  const Tensor out(sizes(), type);
  out.copy_(*this);
  return out;
}

Tensor Tensor::to(const Device& device) const {
  TORCH_CHECK(device.is_cpu(), "this build computes on the CPU alone");
  return *this;
}

Tensor Tensor::clone() const {
  const Tensor out(sizes(), scalar_type());
  out.copy_(*this);
  return out;
}

const Tensor& Tensor::copy_(const Tensor& from) const {
  const Tensor wide = from.expand(sizes());
  visit_type(scalar_type(), [&](auto to) {
    visit_type(wide.scalar_type(), [&](auto of) {
      using To = decltype(to);
      using Of = decltype(of);
      map_into<Of, To>(*this, wide, [](Of value) {
        if constexpr (std::is_same_v<To, BFloat16>)
          return BFloat16(static_cast<float>(value));
        else
          return static_cast<To>(value);
      });
    });
  });
  return *this;
}

const Tensor& Tensor::fill_(const Scalar& value) const {
  visit_type(scalar_type(), [&](auto type) {
    using T = decltype(type);
    const T number = value.to<T>();
    map_into<T, T>(*this, *this, [number](const T&) { return number; });
  });
  return *this;
}

}  // namespace lte::tensor
