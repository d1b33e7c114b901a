#include "lte/nn/files/tensor_io.h"

#include <cstddef>
#include <vector>

#include "lte/base/check.h"
#include "lte/tensor/functions.h"

namespace lte::nn {
namespace {

DType dtype_for(const std::string& name, at::ScalarType type) {
  switch (type) {
    case at::kFloat:
      return DType::F32;
    case at::kDouble:
      return DType::F64;
    case at::kLong:
      return DType::I64;
    case at::kInt:
      return DType::I32;
    case at::kBFloat16:
      return DType::BF16;
    case at::kByte:
      return DType::U8;
    default:
      throw Error(concat("tensor ", name, ": type ", c10::toString(type), " cannot be saved"));
  }
}

std::string shape_text(at::IntArrayRef shape) {
  std::string text = "[";
  for (size_t i = 0; i < shape.size(); ++i) text += concat(i == 0 ? "" : ", ", shape[i]);
  return text + "]";
}

at::Tensor borrowed(const TensorView& view, at::ScalarType type) {
  return at::from_blob(const_cast<std::byte*>(view.data), view.shape, at::TensorOptions(type));
}

}  // namespace

void add_tensors(const std::map<std::string, at::Tensor>& tensors,
                 std::map<std::string, at::Tensor>* storage, SafetensorsWriter* writer) {
  for (const auto& [name, tensor] : tensors) {
    const at::Tensor& kept = (*storage)[name] = tensor.detach().cpu().contiguous();
    writer->add(name, TensorView{dtype_for(name, kept.scalar_type()), kept.sizes().vec(),
                                 static_cast<const std::byte*>(kept.const_data_ptr())});
  }
}

at::Tensor float_values(const TensorView& view) {
  LTE_CHECK(view.dtype == DType::F32 || view.dtype == DType::BF16, "expected F32 or BF16, got ",
            dtype_name(view.dtype));
  return borrowed(view, view.dtype == DType::BF16 ? at::kBFloat16 : at::kFloat).to(at::kFloat);
}

void read_tensor(const SafetensorsFile& file, const std::string& name, const at::Tensor& out) {
  const TensorView& view = file.at(name);
  const bool rounded = view.dtype == DType::BF16 && out.scalar_type() == at::kFloat;
  LTE_CHECK((rounded || view.dtype == dtype_for(name, out.scalar_type())) &&
                at::IntArrayRef(view.shape) == out.sizes(),
            file.path().string(), ": tensor ", name, ": expected ", shape_text(out.sizes()), " of ",
            c10::toString(out.scalar_type()), ", got ", shape_text(view.shape), " of ",
            dtype_name(view.dtype));
  out.copy_(borrowed(view, rounded ? at::kBFloat16 : out.scalar_type()));
}

}  // namespace lte::nn
