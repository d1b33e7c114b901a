#include "lte/c_api/arguments.h"

#include <cmath>
#include <cstdint>
#include <limits>

#include <ATen/ops/from_blob.h>
#include <ATen/ops/ne.h>
#include <ATen/ops/ones.h>

#include "lte/nn/model.h"
#include "lte/runtime/device.h"

namespace lte::c_api {
namespace {

constexpr int64_t kFloat = sizeof(float), kTriple = 3 * kFloat;

void check_pointer(const void* data, size_t alignment, const char* name) {
  require(data != nullptr, name, " is null");
  require(reinterpret_cast<std::uintptr_t>(data) % alignment == 0, name,
          " is not aligned to its elements of ", alignment, " bytes");
}

void check_span(int64_t count, int64_t stride, const char* name) {
  require(count <= std::numeric_limits<int64_t>::max() / stride, name, ": ", count,
          " entries of stride ", stride, " are more than there are addresses");
}

}  // namespace

c10::Device device_of(int32_t number) {
  if (number == LTE_DEVICE_CPU) return c10::kCPU;
  require(number >= 0, "device is ", number, ", expected LTE_DEVICE_CPU or a CUDA device's number");
  return runtime::cuda_device(number);
}

at::Tensor borrow_output(float* data, int64_t stride, int64_t count, at::Device device,
                         const char* name) {
  check_pointer(data, alignof(float), name);
  const int64_t bytes = stride == 0 ? kTriple : stride;
  require(bytes >= kTriple && bytes % kFloat == 0, name, ": stride is ", stride,
          " bytes, expected 0 or a multiple of 4 that is at least 12");
  check_span(count, bytes, name);
  return at::from_blob(data, {count, 3}, {bytes / kFloat, 1},
                       at::TensorOptions(at::kFloat).device(device));
}

at::Tensor borrow_triples(const lte_float3_view& view, int64_t count, at::Device device,
                          const char* name) {
  return borrow_output(const_cast<float*>(view.data), view.stride, count, device, name);
}

at::Tensor borrow_floats(const float* data, int64_t count, at::Device device, const char* name) {
  check_pointer(data, alignof(float), name);
  check_span(count, kFloat, name);
  return at::from_blob(const_cast<float*>(data), {count},
                       at::TensorOptions(at::kFloat).device(device));
}

nn::PointSet borrow_points(const lte_scene_points& p, at::Device memory) {
  const int64_t M = p.count;
  require(M >= 1, "scene points: count is ", M, ", expected at least 1");
  require(M < std::numeric_limits<int32_t>::max(), "scene points: count is ", M,
          ", more than 2^31 - 2");
  nn::PointSet points;
  points.position = borrow_triples(p.position, M, memory, "scene points: position");
  points.normal = borrow_triples(p.normal, M, memory, "scene points: normal");
  points.albedo = borrow_triples(p.albedo, M, memory, "scene points: albedo");
  points.emission = borrow_triples(p.emission, M, memory, "scene points: emission");
  const auto borrow_light = [&](const lte_float3_view& view, const char* name) {
    return view.data == nullptr ? at::Tensor() : borrow_triples(view, M, memory, name);
  };
  points.direct = borrow_light(p.direct, "scene points: direct");
  points.indirect = borrow_light(p.indirect, "scene points: indirect");
  points.direct_back = borrow_light(p.direct_back, "scene points: direct_back");
  points.indirect_back = borrow_light(p.indirect_back, "scene points: indirect_back");
  const auto borrow_pairs = [&](const float* data, const char* name) {
    return data == nullptr ? at::Tensor() : borrow_floats(data, 2 * M, memory, name).view({M, 2});
  };
  points.indirect_error = borrow_pairs(p.indirect_error, "scene points: indirect_error");
  points.gloss = borrow_pairs(p.gloss, "scene points: gloss");
  points.area = p.area == nullptr ? at::ones({M}, points.position.options())
                                  : borrow_floats(p.area, M, memory, "scene points: area");
  return points;
}

nn::QuerySet borrow_queries(const lte_queries& q, at::Device memory) {
  return {borrow_triples(q.position, q.count, memory, "queries: position"),
          borrow_triples(q.normal, q.count, memory, "queries: normal"),
          borrow_triples(q.albedo, q.count, memory, "queries: albedo")};
}

at::Tensor read_mask(const uint8_t* mask, int64_t stride, int64_t count, at::Device device) {
  check_pointer(mask, 1, "mask");
  const int64_t bytes = stride == 0 ? 1 : stride;
  require(bytes >= 1, "mask: stride is ", stride, " bytes, expected 0 or more");
  check_span(count, bytes, "mask");
  return at::from_blob(const_cast<uint8_t*>(mask), {count}, {bytes},
                       at::TensorOptions(at::kByte).device(device))
      .ne(0);
}

void check_finite_triple(const float* values, const char* name) {
  check_pointer(values, alignof(float), name);
  for (int i = 0; i < 3; ++i) {
    require(std::isfinite(values[i]), name, "[", i, "] is not finite: ", values[i]);
  }
}

}  // namespace lte::c_api
