// Light maps: lte.bake(), as lte_bake computes and writes them.
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "infer/bake/bake_scene.h"
#include "infer/renderer/quality.h"
#include "lte/bake/formats/formats.h"
#include "lte/base/log.h"

#include "python/src/module.h"

namespace lte::python {
namespace {

using Baked = infer::BakedScene;

Array picture_of(const Baked& self, std::vector<float> irradiance) {
  return array_of(std::move(irradiance),
                  {static_cast<size_t>(self.map.height), static_cast<size_t>(self.map.width), 3});
}

FloatArrays baked_layers(const Baked& self) {
  nb::dict out;
  for (const bake::Layer& layer : self.map.layers)
    out[layer.name.c_str()] = picture_of(self, layer.irradiance);
  return out;
}

nb::ndarray<nb::numpy, uint8_t> mask(const Baked& self) {
  auto* kept = new std::vector<uint8_t>(self.map.mask);
  const nb::capsule owner(kept,
                          [](void* p) noexcept { delete static_cast<std::vector<uint8_t>*>(p); });
  return {kept->data(),
          {static_cast<size_t>(self.map.height), static_cast<size_t>(self.map.width)},
          owner};
}

/// Notes and progress on standard error, for as long as it lives.
class Verbose {
 public:
  explicit Verbose(bool wanted) : before_(log_level()) {
    if (wanted) set_log_level(LogLevel::Info);
  }
  ~Verbose() { set_log_level(before_); }
  Verbose(const Verbose&) = delete;
  Verbose& operator=(const Verbose&) = delete;

 private:
  LogLevel before_;
};

Baked bake_lightmap(const Scene& self, bool progress, double texels_per_metre, int size,
                    bool keep_uvs, const std::string& include, bool by_light,
                    const std::string& integrator, const Model* model, const std::string& quality,
                    double seconds, double error, const std::string& probes, int depth,
                    uint64_t seed, bool keep_samples, const std::string& since, double change) {
  infer::BakeRequest request;
  request.scene = self.scene().name;
  request.atlas = {texels_per_metre, size, keep_uvs};
  request.include = include;
  request.by_light = by_light;
  request.integrator = integrator;
  if (model != nullptr) {
    request.checkpoint = model->path;
    request.network = model->network;
  }
  argument([&] { parse_enum<infer::Quality>("quality", quality); });
  request.quality = quality;
  if (seconds > 0) request.time = concat(seconds, "s");
  request.error = error;
  request.probes = probes;
  request.max_depth = depth;
  request.seed = seed;
  request.keep_samples = keep_samples;
  request.since = since;
  request.change = change;
  const Verbose verbose(progress);
  return interruptible([&] {
    if (model != nullptr) apply_threads();
    infer::Renderer renderer = self.renderer();
    return std::move(*infer::bake_scene(request, &renderer));
  });
}

void save_baked(const Baked& self, const std::string& folder, const std::string& format,
                const std::string& three, double bend, int64_t max_triangles) {
  const nb::gil_scoped_release unlocked;
  bake::FormatOptions options;
  options.three = three;
  options.vertex = {bend, max_triangles};
  infer::write_baked(self, format, std::move(options), folder);
}

}  // namespace

void bind_bake(nb::module_& m) {
  nb::class_<Baked>(m, "LightMap")
      .def("irradiance", [](const Baked& self) { return picture_of(self, self.map.total()); })
      .def("layers", &baked_layers)
      .def("mask", &mask)
      .def("save", &save_baked)
      .def_prop_ro("expected_error",
                   [](const Baked& self) { return self.map.provenance.expected_error; })
      .def_prop_ro("texels_per_metre",
                   [](const Baked& self) { return self.map.provenance.texels_per_metre; });
  m.def("bake", &bake_lightmap, nb::arg("scene"), nb::arg("progress"), nb::arg("texels_per_metre"),
        nb::arg("size"), nb::arg("keep_uvs"), nb::arg("include"), nb::arg("by_light"),
        nb::arg("integrator"), nb::arg("model").none(), nb::arg("quality"), nb::arg("seconds"),
        nb::arg("error"), nb::arg("probes"), nb::arg("depth"), nb::arg("seed"),
        nb::arg("keep_samples"), nb::arg("since"), nb::arg("change"));
  m.def("bake_formats", [] {
    std::vector<std::string> names{"gltf"};
    for (const bake::Format& format : bake::engine_formats()) names.emplace_back(format.name);
    return names;
  });
}

}  // namespace lte::python
