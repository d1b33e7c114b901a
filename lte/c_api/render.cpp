#include "lte/c_api/render.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "lte/base/log.h"
#include "lte/c_api/arguments.h"
#include "lte/c_api/error.h"
#include "lte/c_api/handles.h"
#include "lte/embed/embed.h"
#include "lte/pathtrace/placement/auto_camera.h"
#include "lte/render/picture.h"
#include "lte/render/progressive.h"
#include "lte/scene/load.h"
#include "lte/scene/up_axis.h"

namespace lte::c_api {
namespace {

constexpr int64_t kMaxSide = 1 << 15, kMaxPixels = 1 << 28;
constexpr int64_t kMaxRecords = 1 << 26, kMaxDepth = 1 << 16;
/// Paths a pixel of a pass of LTE_METHOD_PATH.
constexpr int kPassPaths = 4;
constexpr int kPasses = 16, kPreviewPasses = 4;

/// A number for which 0 stands for a default.
template <typename T>
T given_or(T value, T otherwise, int64_t most, const char* name) {
  require(value >= 0 && value <= most, name, " is ", value, ", expected 0 to ", most);
  return value == 0 ? otherwise : value;
}

scene::Camera read_camera(const lte_camera& from) {
  check_finite_triple(from.origin, "camera: origin");
  check_finite_triple(from.target, "camera: target");
  check_finite_triple(from.up, "camera: up");
  require(from.vfov > 0 && from.vfov < 180, "camera: vfov is ", from.vfov,
          ", expected degrees between 0 and 180");
  const auto vec = [](const float* v) { return Vec3{v[0], v[1], v[2]}; };
  return {"", vec(from.origin), vec(from.target), vec(from.up), from.vfov, from.mirrored != 0};
}

/// Calls the caller's function, and remembers that it has ended the picture.
struct Progress {
  int32_t (*function)(void* user, double share);
  void* user;
  double share = 0;
  bool stopped = false;

  bool stop() {
    if (!stopped && function != nullptr) stopped = function(user, share) != 0;
    return stopped;
  }
};

void check_picture(const lte_picture& picture) {
  for (const int32_t side : {picture.width, picture.height})
    require(side >= 1 && side <= kMaxSide, "picture: width or height is ", side, ", expected 1 to ",
            kMaxSide);
  require(int64_t{picture.width} * picture.height <= kMaxPixels, "picture: ", picture.width, "x",
          picture.height, " are more than 2^28 pixels");
}

render::Until read_until(const lte_render_options& from) {
  require(from.passes >= 0, "passes is ", from.passes, ", expected 0 or more");
  require(from.seconds >= 0 && std::isfinite(from.seconds), "seconds is ", from.seconds,
          ", expected 0 or more");
  render::Until until;
  if (from.seconds > 0) until.seconds = from.seconds;
  if (from.passes > 0 || from.seconds == 0) until.passes = from.passes > 0 ? from.passes : kPasses;
  return until;
}

image::OidnQuality denoising_effort(int passes) {
  if (passes < kPreviewPasses) return image::OidnQuality::Fast;
  return passes < kPasses ? image::OidnQuality::Balanced : image::OidnQuality::High;
}

void write(const image::Image& from, size_t floats, float* to) {
  if (to == nullptr) return;
  if (from.pixels.empty()) {  // there is no such light
    std::fill_n(to, floats, 0.0f);
  } else {
    std::copy_n(from.pixels.begin(), floats, to);
  }
}

}  // namespace

lte_scene* open_scene(const char* path, const lte_scene_options* options) {
  const bool z_up = options != nullptr && read_struct(options, "lte_scene_options").z_up != 0;
  set_log_level(LogLevel::Quiet);  // of this library's own log
  scene::Scene loaded = scene::load_scene(path);
  if (z_up) scene::turn_z_up(&loaded);
  return new lte_scene{std::make_shared<const TracedFile>(std::move(loaded))};
}

lte_scene_info info_of(const TracedFile& file) {
  lte_scene_info info = {};
  info.triangles = file.scene.triangle_count();
  info.cameras = static_cast<int64_t>(file.scene.cameras.size());
  info.lights = static_cast<int64_t>(file.scene.light_groups.size());
  const Bounds& bounds = file.bvh.bounds();
  for (int i = 0; i < 3; ++i) {
    info.bounds_min[i] = bounds.low[i];
    info.bounds_max[i] = bounds.high[i];
  }
  return info;
}

lte_camera camera_of(const TracedFile& file, int64_t number) {
  const auto count = static_cast<int64_t>(file.scene.cameras.size());
  require(number >= LTE_CAMERA_AUTO && number < count, "camera number is ", number,
          ", expected LTE_CAMERA_AUTO or one below the scene's ", count);
  const scene::Camera from = number == LTE_CAMERA_AUTO
                                 ? pathtrace::auto_camera(file.bvh)
                                 : file.scene.cameras[static_cast<size_t>(number)];
  lte_camera camera = {};
  for (int i = 0; i < 3; ++i) {
    camera.origin[i] = from.origin[i];
    camera.target[i] = from.target[i];
    camera.up[i] = from.up[i];
  }
  camera.vfov = from.vfov;
  camera.mirrored = from.mirrored;
  return camera;
}

lte_embedding* encode_scene(const TracedFile& file, const lte_model& model,
                            const lte_scene_encode_options& from) {
  require(from.scene_points >= 0 && from.scene_points < std::numeric_limits<int32_t>::max(),
          "scene_points is ", from.scene_points, ", expected 0 to 2^31 - 2");
  embed::EmbedSettings settings;
  settings.scene_points = from.scene_points;
  settings.seed = from.seed;
  settings.rescale = from.rescale != 0;
  return new lte_embedding{embed::embed(file.bvh, file.lights, model.network, settings).embedding};
}

lte_integrator* make_integrator(const lte_scene& of, const lte_integrator_options& from) {
  const TracedFile& file = *of.file;
  require(from.method >= LTE_METHOD_GATHER && from.method <= LTE_METHOD_PATH, "method is ",
          from.method, ", expected an lte_method");
  const bool by_network = from.method == LTE_METHOD_NETWORK;
  require(!by_network || from.embedding != nullptr,
          "embedding is null, but LTE_METHOD_NETWORK needs one");
  require(by_network || from.embedding == nullptr,
          "embedding is given, but is for LTE_METHOD_NETWORK alone");
  render::CacheSettings settings;
  settings.records = given_or(from.records, settings.records, kMaxRecords, "records");
  settings.paths = given_or(from.record_paths, settings.paths, kMaxSamples, "record_paths");
  settings.max_depth = given_or(from.max_depth, settings.max_depth, kMaxDepth, "max_depth");
  settings.seed = from.seed;
  const render::TracedScene scene{file.bvh, file.lights};
  const int depth = settings.max_depth;
  if (from.method == LTE_METHOD_PATH)
    return new lte_integrator{of.file, render::make_path(scene, depth), depth};
  render::IrradianceSource source;
  if (by_network)
    source = [&](std::span<const Vec3> positions, std::span<const Vec3> normals,
                 std::span<const Rgb> albedos) {
      return from.embedding->scene.decode({positions, normals, albedos});
    };
  // The cache is made here, so that nothing of the embedding is needed later.
  auto cache =
      std::make_shared<const gi::IrradianceCache>(render::make_cache(scene, settings, source));
  const render::Method method = by_network ? render::Method::Network : render::Method::Gather;
  return new lte_integrator{of.file, render::make_gather(scene, std::move(cache), depth, method),
                            depth};
}

void render_picture(const lte_integrator& by, const lte_camera& camera,
                    const lte_render_options& from, const lte_picture& to) {
  check_picture(to);
  render::Until until = read_until(from);
  const TracedFile& file = *by.file;
  render::RenderSettings settings;
  settings.direct = to.color != nullptr || to.direct != nullptr || to.indirect != nullptr;
  settings.indirect = settings.direct;
  settings.path_samples = by.integrator->method() == render::Method::Path ? kPassPaths : 1;
  settings.correct = from.keep_noise == 0;
  settings.max_depth = by.max_depth;
  settings.seed = from.seed;
  Progress progress{from.progress, from.user};
  until.stop = [&] { return progress.stop(); };
  until.pass_done = [&](const render::Film&, double share) { progress.share = share; };
  render::Film film(to.width, to.height);
  render::render({file.bvh, file.lights}, *by.integrator, read_camera(camera), settings, until,
                 &film);
  if (progress.stop()) throw ApiError(LTE_STOPPED, "the progress function has ended the picture");
  render::PictureSettings picture;
  const bool denoises = from.keep_noise == 0 && settings.direct && !file.lights.empty();
  if (denoises) picture.denoiser = &file.denoiser.get();
  picture.quality = denoising_effort(film.passes);
  const render::Frame frame = render::make_picture(film, picture);
  const size_t pixels = film.pixels();
  write(frame.color, 3 * pixels, to.color);
  write(frame.albedo, 3 * pixels, to.albedo);
  write(frame.normal, 3 * pixels, to.normal);
  write(frame.depth, pixels, to.depth);
  write(frame.emission, 3 * pixels, to.emission);
  write(frame.direct, 3 * pixels, to.direct);
  write(frame.indirect, 3 * pixels, to.indirect);
}

}  // namespace lte::c_api
