// Scenes: from files, with other light, and points on their surfaces.
#include <algorithm>
#include <cmath>

#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include "lte/base/log.h"
#include "lte/cli/scene_flags.h"
#include "lte/cli/scene_source.h"
#include "lte/pathtrace/reach/lost_light.h"
#include "lte/scene/export.h"
#include "lte/scene/light_gains.h"
#include "lte/scene/sampler.h"

#include "python/src/module.h"

namespace lte::python {

Scene::Scene(scene::Scene scene)
    : scene_(std::make_unique<const scene::Scene>(std::move(scene))),
      bvh_(pathtrace::Bvh::with_own_meshes(*scene_)),
      lights_(std::make_shared<const pathtrace::Lights>(*scene_)),
      denoiser_(std::make_shared<render::SharedDenoiser>()) {}

Scene::Scene(const Scene& bright, std::span<const float> gains) : denoiser_(bright.denoiser_) {
  std::vector<int> trees;
  scene_ = std::make_unique<const scene::Scene>(scene::with_gains(bright.scene(), gains, &trees));
  bvh_ = std::make_shared<const pathtrace::Bvh>(*scene_, *bright.bvh_, trees);
  lights_ = std::make_shared<const pathtrace::Lights>(*scene_);
}

void Scene::provide_cache(const render::CacheSettings& settings, const Model* model,
                          const embed::EmbedSettings& embedding, infer::Renderer* renderer) {
  CacheKey key{settings.records,       settings.paths, settings.max_depth, settings.seed, "",
               embedding.culled_lights};
  if (model != nullptr) key.network = model->fingerprint;
  {
    const std::lock_guard lock(mutex_);
    if (cache_ && cached_ == key) return renderer->set_cache(cache_);
  }
  render::IrradianceSource source;
  if (model != nullptr) {
    renderer->embed(model->network, embedding);
    source = renderer->source();
  }
  auto cache = std::make_shared<const gi::IrradianceCache>(
      render::make_cache({*bvh_, *lights_}, settings, source));
  renderer->set_cache(cache);
  const std::lock_guard lock(mutex_);
  cached_ = std::move(key);
  cache_ = std::move(cache);
}

namespace {

/// What --add-light auto gives light to: the scene's first camera, or else the automatic one.
constexpr const char* kSeenByCamera = "";

std::unique_ptr<Scene> load(const std::string& path, const std::string& up,
                            const std::string& environment, double environment_turn,
                            std::vector<std::string> lights, bool allow_outside) {
  SceneSource source;
  source.scene = path;
  source.up = up;
  source.environment = environment;
  source.environment_turn = environment_turn;
  source.lights = std::move(lights);
  source.loading.allow_outside = allow_outside;
  return interruptible([&] {
    auto scene = std::make_unique<Scene>(load_source(source, kSeenByCamera));
    if (scene->lights()->empty())
      log_warning(path, ": nothing emits light (environment=\"1,1,1\" or add_light=\"auto\" do)");
    pathtrace::warn_of_lost_light(path, *scene->bvh());
    return scene;
  });
}

std::unique_ptr<Scene> dimmed(const Scene& self, const std::vector<float>& gains) {
  return interruptible([&] { return std::make_unique<Scene>(self, gains); });
}

std::unique_ptr<Scene> with_light(const Scene& self, const std::string& light) {
  return interruptible([&] {
    scene::Scene scene = self.scene();
    log_info(scene.name, ": added ", add_light(light, kSeenByCamera, &scene));
    return std::make_unique<Scene>(std::move(scene));
  });
}

nb::typed<nb::tuple, Array, Array> sample(const Scene& self, int64_t count, uint64_t seed) {
  const scene::SurfaceSamples points = interruptible([&] {
    scene::SamplerOptions options;
    options.seed = seed;
    options.filter_footprint = false;
    options.environment_share = 0;
    options.punctual_lights = false;
    return scene::sample_surface(self.scene(), count, options);
  });
  return nb::make_tuple(array_of(points.position), array_of(points.normal));
}

std::tuple<std::vector<float>, std::vector<float>> bounds(const Scene& self) {
  const Bounds box = self.scene().bounds();
  return {{box.low.x, box.low.y, box.low.z}, {box.high.x, box.high.y, box.high.z}};
}

/// The environment, [H, W, 3] by longitude and latitude (1 x 1 of a constant one), and the axes of
/// its frame; None where there is none.
nb::object sky(const Scene& self) {
  const std::optional<scene::Environment>& environment = self.scene().environment;
  if (!environment) return nb::none();
  const scene::EnvironmentMap* const map = environment->map.get();
  const bool as_it_is = map == nullptr || map->mapping() == scene::SphereMapping::Equirectangular;
  const int width = map == nullptr ? 1 : as_it_is ? map->width() : std::min(4 * map->width(), 8192);
  const int height = map == nullptr ? 1 : as_it_is ? map->height() : width / 2;
  std::vector<Rgb> texels;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double theta = (y + 0.5) / height * M_PI, phi = ((x + 0.5) / width - 0.5) * 2 * M_PI;
      const Vec3 local{static_cast<float>(std::sin(theta) * std::cos(phi)),
                       static_cast<float>(std::cos(theta)),
                       static_cast<float>(std::sin(theta) * std::sin(phi))};
      texels.push_back(environment->radiance_from(environment->to_world(local)));
    }
  }
  const auto* first = reinterpret_cast<const float*>(texels.data());
  Array picture = array_of({first, first + 3 * texels.size()},
                           {static_cast<size_t>(height), static_cast<size_t>(width), 3});
  return nb::make_tuple(std::move(picture), array_of(environment->axes));
}

std::vector<std::string> camera_names(const Scene& self) {
  std::vector<std::string> names;
  for (const scene::Camera& camera : self.scene().cameras) names.push_back(camera.name);
  return names;
}

}  // namespace

void bind_scene(nb::module_& m) {
  nb::class_<Scene>(m, "Scene")
      .def_prop_ro("name", [](const Scene& self) { return self.scene().name; })
      .def_prop_ro("triangles", [](const Scene& self) { return self.scene().triangle_count(); })
      .def_prop_ro("bounds", &bounds)
      .def_prop_ro("lights", [](const Scene& self) { return self.scene().light_groups; })
      .def_prop_ro("cameras", &camera_names)
      .def_prop_ro("ignored", [](const Scene& self) { return self.scene().ignored; })
      .def("dimmed", &dimmed)
      .def("with_light", &with_light)
      .def("sample", &sample)
      .def("sky", &sky)
      .def("save", [](const Scene& self, const std::string& path) {
        const nb::gil_scoped_release unlocked;
        scene::write_glb(path, self.scene());
      });
  m.def("load", &load);
}

}  // namespace lte::python
