// Light at points: lte_probe's answers, and plain path tracing by lamp.
#include <cmath>

#include <nanobind/stl/string.h>

#include "infer/check/check_report.h"
#include "infer/probe/probe_answers.h"
#include "lte/base/log.h"
#include "lte/pathtrace/irradiance.h"
#include "lte/pathtrace/probe.h"
#include "lte/scene/number_check.h"

#include "python/src/module.h"

namespace lte::python {
namespace {

/// @throws ValueError that names the first row of no use
void check_surface(const Triples& points, const Triples& normals) {
  for (size_t i = 0; i < points.shape(0); ++i) {
    const Vec3 at = row_of(points, i), side = row_of(normals, i);
    const auto check = [i](bool good, const char* what, const char* fault) {
      if (!good) throw nb::value_error(concat(what, ": row ", i, fault).c_str());
    };
    check(is_finite(at), "points", " is not finite");
    check(scene::is_place(at), "points", " is too far from the origin");
    check(is_finite(side), "normals", " is not finite");
    check(length(side) > 1e-6f && std::isfinite(length(side)), "normals",
          " has no length, or too much");
  }
}

FloatArrays probe(const Scene& self, const Triples& points, const Triples& normals,
                  const std::string& integrator, const Model* model, int64_t spp, double error,
                  int depth, uint64_t seed) {
  infer::ProbeRequest request;
  request.integrator = integrator;
  request.spp = spp;
  request.error = error;
  request.max_depth = depth;
  request.seed = seed;
  const infer::ProbeAnswer answer = interruptible([&] {
    const scene::PointTable table = table_of(self, points, normals);
    infer::Renderer renderer = self.renderer();
    if (!renderer.has_light()) return infer::darkness(table);
    if (model == nullptr) return infer::answer_points(request, nullptr, {}, table, &renderer);
    apply_threads();
    const infer::EmbedSettings settings = infer::embed_settings(
        request, model->network, embed::SurfacePlaces{table.position, table.normal}, renderer);
    return infer::answer_points(request, &model->network, settings, table, &renderer);
  });
  const std::string note = infer::check_note(
      answer.check, model == nullptr ? "the gathered" : "the network's", "the points");
  if (!note.empty()) log_warning(self.scene().name, ": ", note);
  nb::dict out;
  out["total"] = array_of(answer.light.total);
  out["direct"] = array_of(answer.light.direct);
  out["stderr"] = array_of(answer.light.standard_error);
  std::vector<float> expected(answer.expected_error.begin(), answer.expected_error.end());
  expected.resize(answer.light.total.size());  // where nothing shines there is no error
  const size_t count = expected.size();
  out["expected_error"] = array_of(std::move(expected), {count});
  return out;
}

/// [groups, points, 3], or [points, 3] of the sum.
Array light_of(const std::vector<Rgb>& values, const pathtrace::Irradiance& of, bool by_light) {
  if (!by_light) {
    std::vector<Rgb> sum = values;
    sum.resize(static_cast<size_t>(of.points));  // without lamps there are no groups
    return array_of(sum);
  }
  const auto* first = reinterpret_cast<const float*>(values.data());
  return array_of({first, first + 3 * values.size()},
                  {static_cast<size_t>(of.groups), static_cast<size_t>(of.points), 3});
}

FloatArrays trace(const Scene& self, const Triples& points, const Triples& normals, int rays,
                  int depth, uint64_t seed, bool by_light) {
  const pathtrace::Irradiance light = interruptible([&] {
    pathtrace::IrradianceOptions options;
    options.rays = rays;
    options.max_depth = depth;
    options.seed = seed;
    options.by_group = by_light;
    const scene::PointTable table = table_of(self, points, normals);
    return pathtrace::estimate_irradiance(*self.bvh(), *self.lights(), table.position, table.normal,
                                          options);
  });
  std::vector<Rgb> error;
  for (const Rgb& variance : light.variance_total)
    error.push_back({std::sqrt(variance.x), std::sqrt(variance.y), std::sqrt(variance.z)});
  nb::dict out;
  out["direct"] = light_of(light.direct, light, by_light);
  out["indirect"] = light_of(light.indirect, light, by_light);
  out["stderr"] = array_of(error);
  return out;
}

}  // namespace

scene::PointTable table_of(const Scene& scene, const Triples& points, const Triples& normals) {
  scene::PointTable table;
  table.position = vector_of(points);
  table.normal = directions_of(normals);
  pathtrace::settle_points(*scene.bvh(), "points", &table);
  return table;
}

void bind_light(nb::module_& m) {
  m.def("probe", &probe, nb::arg("scene"), nb::arg("points"), nb::arg("normals"),
        nb::arg("integrator"), nb::arg("model").none(), nb::arg("spp"), nb::arg("error"),
        nb::arg("depth"), nb::arg("seed"));
  m.def("trace", &trace);
  m.def("check_surface", &check_surface);
}

}  // namespace lte::python
