// Pictures: lte.render(), and a picture with its layers.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>

#include "infer/render/exposure.h"
#include "infer/render/frame_io.h"
#include "infer/render/scene_size.h"
#include "infer/render/views.h"
#include "infer/renderer/embedding_flags.h"
#include "infer/renderer/quality.h"
#include "lte/scene/load_camera.h"

#include "python/src/module.h"

namespace lte::python {
namespace {

/// A frame, and what it takes to write it as lte_render does.
struct Picture {
  render::Frame frame;
  render::Output output = render::Output::Full;
  scene::Camera camera;
  int passes = 0;
  std::string denoiser;

  float exposure(std::optional<double> given, double ev) const {
    infer::ExposureOptions options;
    options.exposure = given;
    options.ev = ev;
    return infer::choose_exposure(frame, output, options);
  }
};

Array image_array(const image::Image& image) {
  const auto width = static_cast<size_t>(image.width), height = static_cast<size_t>(image.height),
             channels = static_cast<size_t>(image.channels);
  if (channels == 1) return array_of(image.pixels, {height, width});
  return array_of(image.pixels, {height, width, channels});
}

FloatArrays layers(const Picture& self) {
  nb::dict out;
  const std::pair<const char*, const image::Image*> named[] = {
      {"albedo", &self.frame.albedo}, {"normal", &self.frame.normal},
      {"depth", &self.frame.depth},   {"emission", &self.frame.emission},
      {"direct", &self.frame.direct}, {"indirect", &self.frame.indirect}};
  for (const auto& [name, layer] : named) {
    if (layer->width > 0) out[name] = image_array(*layer);
  }
  return out;
}

void save(const Picture& self, const std::string& path, std::optional<double> exposure, double ev,
          const std::string& tone) {
  const auto curve = argument([&] { return parse_enum<image::ToneCurve>("tone", tone); });
  const nb::gil_scoped_release unlocked;
  infer::write_frame(path, self.frame, self.output, self.exposure(exposure, ev), &self.camera,
                     curve);
}

/// Of origin, target, up and the vertical angle of view.
using Triple = std::tuple<float, float, float>;
using GivenCamera = std::tuple<Triple, Triple, std::optional<Triple>, float>;

scene::Camera camera_of(const GivenCamera& given) {
  const auto vec = [](const Triple& t) {
    const auto& [x, y, z] = t;
    return Vec3{x, y, z};
  };
  const auto& [origin, target, up, vfov] = given;
  scene::Camera camera;
  camera.name = "camera";
  camera.origin = vec(origin);
  camera.target = vec(target);
  camera.up = up ? vec(*up) : scene::default_up(camera.target - camera.origin);
  camera.vfov = vfov;
  argument([&] { scene::check_camera(camera, "camera"); });
  return camera;
}

/// @param word  lte_render's --camera; where it is empty and no camera is given, the scene's first,
///              else the automatic one
scene::Camera choose_camera(const Scene& scene, const std::string& word,
                            const std::optional<scene::Camera>& given, float aspect) {
  std::vector<infer::View> views;
  if (given) {
    views = {{*given, ""}};
  } else {
    views = infer::choose_views(*scene.bvh(), word, "", aspect);
  }
  LTE_CHECK(views.size() == 1, "camera \"", word, "\": expected one camera, got ", views.size());
  infer::check_in_view(scene.scene(), scene.bvh()->bounds(), views, aspect);
  return views.front().camera;
}

/// Fills the renderer's cache as lte_render does: where the network meets light that it has never
/// seen, by paths.
void provide_cache(Scene* scene, const scene::Camera& camera, const Model* model,
                   const infer::RenderSettings& settings, infer::Renderer* renderer) {
  render::CacheSettings cache;
  cache.paths = infer::record_paths(settings);
  cache.max_depth = settings.max_depth;
  cache.seed = settings.seed;
  const infer::EmbeddingFlags flags;
  infer::EmbedSettings embedding = infer::embed_settings(flags, settings.seed, {});
  const embed::Receivers seen = std::vector{camera};
  if (model != nullptr &&
      !infer::knows_light(flags, *scene->bvh(), model->network, embedding, seen))
    model = nullptr;
  if (model != nullptr) {
    apply_threads();
    infer::check_size(scene->scene().name, scene->scene(), model->network, flags.rescale);
    infer::cull_lights(flags, *scene->bvh(), model->network, seen, &embedding);
  }
  scene->provide_cache(cache, model, embedding, renderer);
}

Picture render_picture(Scene* scene, const scene::Camera& camera, const Model* model,
                       infer::RenderSettings settings) {
  const Timer timer;
  infer::Renderer renderer = scene->renderer();
  if (renderer.needs_cache(settings)) provide_cache(scene, camera, model, settings, &renderer);
  settings.seconds -= timer.seconds();
  Picture picture;
  picture.frame = renderer.render(camera, settings);
  picture.output = settings.output;
  picture.camera = camera;
  picture.passes = renderer.passes();
  picture.denoiser = renderer.denoised_by();
  return picture;
}

Picture make_picture(Scene* scene, int width, int height, const std::string& camera_word,
                     const std::optional<GivenCamera>& given_camera, const std::string& integrator,
                     const Model* model, const std::string& quality, double seconds, int spp,
                     const std::string& output, int depth, uint64_t seed, bool denoise) {
  infer::RenderSettings settings;
  settings.width = width;
  settings.height = height;
  argument([&] {
    settings.output = parse_enum<render::Output>("output", output);
    settings.method = parse_enum<render::Method>("integrator", integrator);
    settings = infer::with_quality(parse_enum<infer::Quality>("quality", quality), settings);
  });
  settings.max_depth = depth;
  settings.seed = seed;
  settings.denoise = denoise;
  if (seconds > 0) settings = infer::with_time(seconds, settings);
  if (spp > 0) settings = infer::with_paths(spp, settings);
  infer::check_picture_fits(width, height, {});
  std::optional<scene::Camera> given;
  if (given_camera) given = camera_of(*given_camera);
  return interruptible([&] {
    const float aspect = static_cast<float>(width) / static_cast<float>(height);
    return render_picture(scene, choose_camera(*scene, camera_word, given, aspect), model,
                          settings);
  });
}

}  // namespace

void bind_picture(nb::module_& m) {
  nb::class_<Picture>(m, "Picture")
      .def("color", [](const Picture& self) { return image_array(self.frame.color); })
      .def("layers", &layers)
      .def("exposure", &Picture::exposure, nb::arg("exposure").none(), nb::arg("ev"))
      .def("save", &save, nb::arg("path"), nb::arg("exposure").none(), nb::arg("ev"),
           nb::arg("tone"))
      .def_prop_ro("camera", [](const Picture& self) { return scene::camera_json(self.camera); })
      .def_ro("passes", &Picture::passes)
      .def_ro("denoiser", &Picture::denoiser);
  m.def("render", &make_picture, nb::arg("scene"), nb::arg("width"), nb::arg("height"),
        nb::arg("camera_word"), nb::arg("camera").none(), nb::arg("integrator"),
        nb::arg("model").none(), nb::arg("quality"), nb::arg("seconds"), nb::arg("spp"),
        nb::arg("output"), nb::arg("depth"), nb::arg("seed"), nb::arg("denoise"));
}

}  // namespace lte::python
