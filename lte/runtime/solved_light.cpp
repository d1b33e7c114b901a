#include "lte/runtime/solved_light.h"

#include <algorithm>
#include <vector>

#include <ATen/ops/empty.h>

#include "lte/radiosity/point_radiosity.h"

namespace lte::runtime {
namespace {

at::Tensor on_cpu(const at::Tensor& t) { return t.to(at::kCPU, at::kFloat).contiguous(); }

std::span<const Vec3> triples(const at::Tensor& t) {
  return {reinterpret_cast<const Vec3*>(t.const_data_ptr<float>()), static_cast<size_t>(t.size(0))};
}

/// [M, 3] of its own.
at::Tensor tensor(const std::vector<Rgb>& light) {
  at::Tensor out = at::empty({static_cast<int64_t>(light.size()), 3}, at::kFloat);
  std::copy(light.begin(), light.end(), reinterpret_cast<Rgb*>(out.data_ptr<float>()));
  return out;
}

}  // namespace

bool solves_light_of(const nn::PointSet& points, const nn::ModelConfig& config) {
  return config.solves_light() && !points.direct.defined() && !points.indirect.defined();
}

nn::PointSet with_solved_light(nn::PointSet points, const nn::ModelConfig& config) {
  if (!solves_light_of(points, config)) return points;
  const c10::Device device = points.position.device();
  const at::Tensor position = on_cpu(points.position), normal = on_cpu(points.normal),
                   albedo = on_cpu(points.albedo), emission = on_cpu(points.emission),
                   area = on_cpu(points.area);
  const radiosity::PointIrradiance light =
      radiosity::solve({triples(position), triples(normal), triples(albedo), triples(emission),
                        std::span(area.const_data_ptr<float>(), static_cast<size_t>(area.size(0)))},
                       1);
  points.direct = tensor(light.direct).to(device);
  points.indirect = tensor(light.indirect).to(device);
  points.direct_back = tensor(light.direct_back).to(device);
  points.indirect_back = tensor(light.indirect_back).to(device);
  return points;
}

}  // namespace lte::runtime
