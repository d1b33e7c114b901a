#include "lte/c_api/arguments.h"

#include <cmath>
#include <cstdint>
#include <limits>

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

/// @return  the bytes from one triple to the next
int64_t check_triples(const float* data, int64_t stride, int64_t count, const char* name) {
  check_pointer(data, alignof(float), name);
  const int64_t bytes = stride == 0 ? kTriple : stride;
  require(bytes >= kTriple && bytes % kFloat == 0, name, ": stride is ", stride,
          " bytes, expected 0 or a multiple of 4 that is at least 12");
  check_span(count, bytes, name);
  return bytes;
}

/// Without gaps. Null stays null.
const float* read_floats(const float* data, int64_t count, const char* name) {
  if (data == nullptr) return nullptr;
  check_pointer(data, alignof(float), name);
  check_span(count, kFloat, name);
  return data;
}

}  // namespace

runtime::Device device_of(int32_t number) {
  if (number == LTE_DEVICE_CPU) return {};
  require(number >= 0, "device is ", number, ", expected LTE_DEVICE_CPU or a CUDA device's number");
  return runtime::cuda_device(number);
}

runtime::TriplesIn read_triples(const lte_float3_view& view, int64_t count, const char* name) {
  return {view.data, check_triples(view.data, view.stride, count, name)};
}

runtime::TriplesOut read_output(float* data, int64_t stride, int64_t count, const char* name) {
  return {data, check_triples(data, stride, count, name)};
}

runtime::ScenePointsIn read_points(const lte_scene_points& p, runtime::Device memory) {
  const int64_t M = p.count;
  require(M >= 1, "scene points: count is ", M, ", expected at least 1");
  require(M < std::numeric_limits<int32_t>::max(), "scene points: count is ", M,
          ", more than 2^31 - 2");
  runtime::ScenePointsIn points = {.memory = memory, .count = M};
  points.position = read_triples(p.position, M, "scene points: position");
  points.normal = read_triples(p.normal, M, "scene points: normal");
  points.albedo = read_triples(p.albedo, M, "scene points: albedo");
  points.emission = read_triples(p.emission, M, "scene points: emission");
  points.area = read_floats(p.area, M, "scene points: area");
  const auto light = [&](const lte_float3_view& view, const char* name) {
    return view.data == nullptr ? runtime::TriplesIn() : read_triples(view, M, name);
  };
  points.direct = light(p.direct, "scene points: direct");
  points.indirect = light(p.indirect, "scene points: indirect");
  points.direct_back = light(p.direct_back, "scene points: direct_back");
  points.indirect_back = light(p.indirect_back, "scene points: indirect_back");
  points.indirect_error = read_floats(p.indirect_error, 2 * M, "scene points: indirect_error");
  points.gloss = read_floats(p.gloss, 2 * M, "scene points: gloss");
  return points;
}

runtime::QueriesIn read_queries(const lte_queries& q, runtime::Device memory, bool albedo) {
  require(q.count >= 0, "queries: count is ", q.count, ", expected 0 or more");
  require((q.flags & ~LTE_QUERIES_TRUSTED) == 0, "queries: unknown flags ", q.flags);
  runtime::QueriesIn queries = {.memory = memory, .count = q.count};
  if (q.count == 0) return queries;  // and no arrays
  queries.position = read_triples(q.position, q.count, "queries: position");
  queries.normal = read_triples(q.normal, q.count, "queries: normal");
  if (albedo) queries.albedo = read_triples(q.albedo, q.count, "queries: albedo");
  queries.trusted = (q.flags & LTE_QUERIES_TRUSTED) != 0;
  if (q.mask == nullptr) return queries;
  queries.mask = q.mask;
  queries.mask_stride = q.mask_stride == 0 ? 1 : q.mask_stride;
  require(queries.mask_stride >= 1, "mask: stride is ", q.mask_stride,
          " bytes, expected 0 or more");
  check_span(q.count, queries.mask_stride, "mask");
  return queries;
}

void check_finite_triple(const float* values, const char* name) {
  check_pointer(values, alignof(float), name);
  for (int i = 0; i < 3; ++i) {
    require(std::isfinite(values[i]), name, "[", i, "] is not finite: ", values[i]);
  }
}

}  // namespace lte::c_api
