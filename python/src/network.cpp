// Models, a scene's embedding, and the light that is decoded from it.
#include <atomic>

#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>
#include <pthread.h>

#include "infer/probe/embedded_light.h"
#include "infer/renderer/embedding_flags.h"
#include "infer/tool/tool_options.h"
#include "lte/base/log.h"
#include "lte/base/parallel.h"
#include "lte/base/passive_waiting.h"
#include "lte/cli/assets.h"
#include "lte/embed/point_albedo.h"
#include "lte/embed/untrained_light.h"
#include "lte/runtime/device.h"
#include "lte/scene/light_points.h"

#include "python/src/module.h"

namespace lte::python {
namespace {

std::atomic<bool> threads_used{false}, threads_lost{false};

std::unique_ptr<Model> load_model(const std::string& path, const std::string& precision) {
  const auto chosen = argument([&] { return infer::choose_precision(precision); });
  return interruptible(
      [&] { return std::make_unique<Model>(checkpoint_or_shipped(path).string(), chosen); });
}

std::unique_ptr<runtime::SceneEmbedding> encode(const Model& self, const Scene& scene,
                                                int64_t scene_points, uint64_t seed) {
  return interruptible([&] {
    apply_threads();
    const runtime::Network& network = self.network;
    network.check_fits(max_component(scene::point_bounds(scene.scene()).extent()),
                       /*rescale=*/true);
    const std::string note = embed::untrained_light_note(scene.scene(), network.metadata());
    if (!note.empty()) log_warning(scene.scene().name, ": ", note);
    embed::EmbedSettings settings;
    settings.scene_points = scene_points;
    settings.seed = seed;
    settings.rescale = true;
    return std::make_unique<runtime::SceneEmbedding>(
        embed::embed(*scene.bvh(), *scene.lights(), network, settings).embedding);
  });
}

/// Indirect irradiance, [N, 3]. @param albedo  by default the surface's
Array decode(const runtime::SceneEmbedding& self, const Scene& scene, const Triples& points,
             const Triples& normals, const std::optional<Triples>& albedo) {
  const auto ask = [&] {
    apply_threads();
    const std::vector<Vec3> at = vector_of(points), side = directions_of(normals);
    const std::vector<Rgb> color =
        albedo ? vector_of(*albedo) : embed::albedo_at(*scene.bvh(), {at, side});
    return self.decode({at, side, color});
  };
  constexpr size_t kFew = 1000;  // that are there before anyone would end it
  if (points.shape(0) > kFew) return array_of(interruptible(ask));
  const auto unlocked = [&] {
    const nb::gil_scoped_release release;
    return ask();
  };
  return array_of(unlocked());
}

/// Light at points with direct light, the error to expect, or both: [N, 3], and [N], or [0] where
/// none is wanted.
nb::typed<nb::tuple, Array, Array> answer(const runtime::SceneEmbedding& self, const Scene& scene,
                                          const Triples& points, const Triples& normals,
                                          const std::optional<Triples>& albedo, bool direct,
                                          bool error, uint64_t seed) {
  const infer::EmbeddedLight light = interruptible([&] {
    apply_threads();
    const scene::PointTable table = table_of(scene, points, normals);
    const std::vector<Rgb> color =
        albedo ? vector_of(*albedo)
               : embed::albedo_at(*scene.bvh(), {table.position, table.normal});
    return infer::embedded_light(self, table, color, *scene.bvh(), *scene.lights(),
                                 {direct, error, seed});
  });
  const std::vector<float> off(light.expected_error.begin(), light.expected_error.end());
  return nb::make_tuple(array_of(light.irradiance), array_of(off, {off.size()}));
}

}  // namespace

Model::Model(const std::string& file, runtime::Precision precision)
    : path(file),
      network(file, {{}, precision}),
      fingerprint(concat(network.fingerprint(), ' ', enum_name(precision))) {}

void apply_threads() {
  wait_passively();
  threads_used = true;
  // Of the threads that its parent had, a forked process has one, and OpenMP waits for the others.
  runtime::set_torch_threads(threads_lost ? 1 : num_threads());
}

void bind_network(nb::module_& m) {
  pthread_atfork(nullptr, nullptr, [] { threads_lost = threads_used.load(); });
  nb::class_<Model>(m, "Model")
      .def_prop_ro("path", [](const Model& self) { return self.path; })
      .def_prop_ro("parameters", [](const Model& self) { return self.network.parameters(); })
      .def("encode", &encode);
  nb::class_<runtime::SceneEmbedding>(m, "Embedding")
      .def_prop_ro("scene_points",
                   [](const runtime::SceneEmbedding& self) { return self.info().scene_points; })
      .def("decode", &decode, nb::arg("scene"), nb::arg("points"), nb::arg("normals"),
           nb::arg("albedo").none())
      .def("answer", &answer, nb::arg("scene"), nb::arg("points"), nb::arg("normals"),
           nb::arg("albedo").none(), nb::arg("direct"), nb::arg("error"), nb::arg("seed"));
  m.def("load_model", &load_model);
}

}  // namespace lte::python
