#include "lte/runtime/points.h"

#include "lte/base/check.h"
#include "lte/nn/model.h"
#include "lte/runtime/tensors.h"
#include "lte/runtime/torch_parts.h"

namespace lte::runtime {
namespace {

/// An undefined tensor for light that was not given.
at::Tensor borrow_light(std::span<const Rgb> irradiance) {
  return irradiance.empty() ? at::Tensor() : borrow(irradiance);
}

void check_sizes(const ScenePoints& points) {
  const size_t size = points.position.size();
  LTE_CHECK(size > 0, "a scene needs at least one scene point");
  LTE_CHECK(points.normal.size() == size && points.albedo.size() == size &&
                points.emission.size() == size && points.area.size() == size,
            "scene point arrays differ in length: ", size, " positions, ", points.normal.size(),
            " normals, ", points.albedo.size(), " albedos, ", points.emission.size(),
            " emissions, ", points.area.size(), " areas");
  for (const auto& light :
       {points.direct, points.indirect, points.direct_back, points.indirect_back}) {
    LTE_CHECK(light.empty() || light.size() == size, "scene point arrays differ in length: ", size,
              " positions, ", light.size(), " irradiances");
  }
  LTE_CHECK(points.indirect_error.empty() || points.indirect_error.size() == 2 * size,
            "scene point arrays differ in length: ", size, " positions, ",
            points.indirect_error.size(), " standard errors, expected two each");
  LTE_CHECK(points.gloss.empty() || points.gloss.size() == 2 * size,
            "scene point arrays differ in length: ", size, " positions, ", points.gloss.size(),
            " numbers of gloss, expected two each");
}

}  // namespace

nn::PointSet borrow(const ScenePoints& points) {
  check_sizes(points);
  nn::PointSet set{borrow(points.position),
                   borrow(points.normal),
                   borrow(points.albedo),
                   borrow(points.emission),
                   borrow(points.area),
                   borrow_light(points.direct),
                   borrow_light(points.indirect),
                   borrow_light(points.direct_back),
                   borrow_light(points.indirect_back),
                   {},
                   {}};
  if (!points.indirect_error.empty())
    set.indirect_error = borrow(points.indirect_error).view({points.size(), 2});
  if (!points.gloss.empty()) set.gloss = borrow(points.gloss).view({points.size(), 2});
  return set;
}

nn::QuerySet borrow(const QueryPoints& queries) {
  LTE_CHECK(queries.normal.size() == queries.position.size() &&
                queries.albedo.size() == queries.position.size(),
            "query arrays differ in length: ", queries.position.size(), " positions, ",
            queries.normal.size(), " normals, ", queries.albedo.size(), " albedos");
  return {borrow(queries.position), borrow(queries.normal), borrow(queries.albedo)};
}

double mean_emission(const ScenePoints& points) { return nn::mean_emission(borrow(points)); }

}  // namespace lte::runtime
