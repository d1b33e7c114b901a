// Tensors in safetensors files.
#pragma once

#include <map>
#include <string>

#include "lte/base/safetensors.h"
#include "lte/tensor/tensor.h"

namespace lte::nn {

/// Copies to the CPU where needed; the views borrow from `storage`, which must outlive the writer.
/// @throws lte::Error naming a tensor whose type the format lacks.
void add_tensors(const std::map<std::string, at::Tensor>& tensors,
                 std::map<std::string, at::Tensor>* storage, SafetensorsWriter* writer);

/// The values of a tensor of F32, borrowed, or of BF16, copied, in float32 on the CPU.
/// @throws lte::Error for another type.
at::Tensor float_values(const TensorView& view);

/// Copies tensor `name` of `file` into `out`, whose device, type and shape stay. BF16 becomes
/// float32.
/// @throws lte::Error naming file and tensor if it is missing or differs in type or shape.
void read_tensor(const SafetensorsFile& file, const std::string& name, const at::Tensor& out);

}  // namespace lte::nn
