#include "infer/renderer/renderer.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lte/base/check.h"
#include "lte/base/process_memory.h"
#include "lte/base/timer.h"
#include "lte/render/picture.h"
#include "lte/render/progressive.h"
#include "lte/runtime/limit_error.h"
#include "lte/scene/metal.h"

namespace lte::infer {
namespace {

/// Bytes a pixel of the picture's layers, and of the denoiser's copies of them.
constexpr double kFrameBytes = 76, kDenoiserBytes = 100;
/// Open Image Denoise, which works in tiles beyond its limit (image/oidn.cpp).
constexpr double kOidnBytes = 600, kMaxOidnMib = 768;

/// A picture in a given time is corrected by paths, which takes denoising twice more, where it may
/// take so many times as long as denoising once.
constexpr double kCorrectedFrom = 12;
/// Of a given time, what the better denoiser may take; else the quick one is taken.
constexpr double kDenoisedIn = 1.0 / 3;
/// A side of the picture that a denoiser is timed by.
constexpr int kTimedSide = 128;

}  // namespace

Renderer::Renderer(const scene::Scene& scene)
    : Renderer(std::make_shared<pathtrace::Bvh>(scene), std::make_shared<pathtrace::Lights>(scene),
               std::make_shared<SharedDenoiser>()) {}

Renderer::Renderer(std::shared_ptr<const pathtrace::Bvh> bvh,
                   std::shared_ptr<const pathtrace::Lights> lights,
                   std::shared_ptr<SharedDenoiser> denoiser)
    : held_bvh_(std::move(bvh)),
      held_lights_(std::move(lights)),
      bvh_(*held_bvh_),
      lights_(*held_lights_),
      all_metal_(scene::all_metal(bvh_.scene())),
      denoiser_(std::move(denoiser)) {}

void Renderer::embed(const runtime::Network& network, const EmbedSettings& settings) {
  embedding_.reset();  // that of before and the new one would need twice the memory
  embed::Embedded made = embed::embed(bvh_, lights_, network, settings);
  embedding_ = std::make_shared<const runtime::SceneEmbedding>(std::move(made.embedding));
  pruned_points_ = made.pruned;
  culled_lights_ = std::move(made.culled_lights);
  seconds_.sample = made.sample_s;
  seconds_.light = made.light_s;
  seconds_.encode = made.encode_s;
}

void Renderer::set_embedding(runtime::SceneEmbedding embedding) {
  set_embedding(std::make_shared<const runtime::SceneEmbedding>(std::move(embedding)));
}

void Renderer::set_embedding(std::shared_ptr<const runtime::SceneEmbedding> embedding) {
  pruned_points_ = {};
  culled_lights_.clear();
  embedding_ = std::move(embedding);
}

const std::shared_ptr<const runtime::SceneEmbedding>& Renderer::shared_embedding() const {
  LTE_CHECK(embedding_ != nullptr, "the network has no embedding of the scene yet");
  return embedding_;
}

render::IrradianceSource Renderer::source() const {
  return [embedding = shared_embedding()](std::span<const Vec3> positions,
                                          std::span<const Vec3> normals,
                                          std::span<const Rgb> albedos) {
    return embedding->decode({positions, normals, albedos});
  };
}

void Renderer::make_cache(Method method, const render::CacheSettings& settings) {
  const Timer timer;
  cache_.reset();  // two at a time would need twice the memory
  cache_ = std::make_shared<const gi::IrradianceCache>(
      render::make_cache({bvh_, lights_}, settings,
                         method == Method::Network ? source() : render::IrradianceSource()));
  seconds_.cache = timer.seconds();
}

void Renderer::set_cache(std::shared_ptr<const gi::IrradianceCache> cache) {
  cache_ = std::move(cache);
}

const gi::IrradianceCache& Renderer::cache() const {
  LTE_CHECK(cache_ != nullptr, "there is no irradiance cache: make_cache() comes first");
  return *cache_;
}

bool Renderer::needs_cache(const RenderSettings& settings) const {
  if (all_metal_ && settings.output != Output::Irradiance) return false;  // by whole paths
  return settings.method != Method::Path && has_light() && !render::is_geometry(settings.output) &&
         settings.output != Output::Direct;
}

std::unique_ptr<render::Integrator> Renderer::integrator(const RenderSettings& settings) const {
  const render::TracedScene scene{bvh_, lights_};
  if (settings.method == Method::Path) return render::make_path(scene, settings.max_depth);
  if (needs_cache(settings)) cache();  // throws where there is none
  // Direct light needs no records.
  auto records = needs_cache(settings) ? cache_
                                       : std::make_shared<const gi::IrradianceCache>(
                                             bvh_, gi::CacheRecords(), std::span<const Rgb>());
  return render::make_gather(scene, std::move(records), settings.max_depth, settings.method);
}

/// What denoising such a picture will take, by what it takes for a small one.
double Renderer::denoising_seconds(int width, int height, image::OidnQuality quality) {
  const image::Image gray(kTimedSide, kTimedSide, 3);
  image::Image ones = gray;
  for (float& value : ones.pixels) value = 1;
  const Timer timer;
  denoiser_->get().denoise({&ones, &ones, &gray, nullptr, nullptr}, quality);
  return timer.seconds() * (double{1} * width * height) / (double{1} * kTimedSide * kTimedSide);
}

Frame Renderer::render(const scene::Camera& camera, const RenderSettings& settings) {
  Timer timer;
  const std::unique_ptr<render::Integrator> integrator = this->integrator(settings);
  const bool lit = has_light() && !render::is_geometry(settings.output);
  const bool denoises = lit && settings.denoise;
  render::RenderSettings what;
  what.direct = lit && settings.output != Output::Gi && settings.output != Output::Irradiance;
  what.indirect = lit && settings.output != Output::Direct;
  what.irradiance = settings.output == Output::Irradiance;
  what.rays = settings.gather_rays;
  what.light_samples = settings.light_samples;
  what.edge_rays = settings.edge_rays;
  what.path_samples = settings.method == Method::Path ? settings.path_samples : 1;
  what.max_samples = settings.max_samples;
  what.correct = settings.correct && denoises;
  what.max_depth = settings.max_depth;
  what.seed = settings.seed;
  if (settings.method == Method::Path && what.irradiance) {
    what.rays = settings.path_samples;
    what.light_samples = settings.path_samples;
  }
  render::Until until;
  until.passes = render::is_geometry(settings.output) ? 1 : settings.passes;
  until.seconds = settings.seconds;
  image::OidnQuality quality = settings.denoise_quality;
  if (denoises && std::isfinite(until.seconds)) {
    double once = denoising_seconds(settings.width, settings.height, quality);
    if (once > kDenoisedIn * until.seconds) {
      quality = image::OidnQuality::Fast;
      once = denoising_seconds(settings.width, settings.height, quality);
    }
    what.correct = what.correct && until.seconds >= kCorrectedFrom * once;
    until.seconds -= (what.correct ? 3 : 1) * once;  // both halves of the paths, too
  }
  until.stop = settings.stop;
  if (settings.progress)
    until.pass_done = [&](const render::Film&, double share) { settings.progress(share); };
  render::Film film(settings.width, settings.height);
  render::RenderSeconds spent;
  until.seconds -= timer.seconds();
  render::render({bvh_, lights_}, *integrator, camera, what, until, &film, &spent);
  if (settings.stop && settings.stop()) throw PictureStopped();
  timer.restart();
  const image::Denoiser* denoiser = denoises ? &denoiser_->get() : nullptr;
  Frame frame = render::make_picture(film, {settings.output, denoiser, quality, settings.layers});
  seconds_.hits = spent.hits;
  seconds_.irradiance = spent.light;
  seconds_.paths = spent.paths;
  seconds_.denoise = timer.seconds();
  seconds_.check = 0;
  denoised_by_ = denoiser != nullptr ? denoiser->description() : "";
  passes_ = film.passes;
  path_passes_ = film.path_passes;
  return frame;
}

double picture_mb(int width, int height) {
  const double pixels = double{1} * width * height;
  return (pixels * (render::kFilmBytes + kFrameBytes + kDenoiserBytes)) / (1 << 20) +
         std::min(kMaxOidnMib, pixels * kOidnBytes / (1 << 20));
}

void check_picture_fits(int width, int height, const runtime::MemoryLimit& limit) {
  const double need = picture_mb(width, height), free = available_memory_mb();
  const std::string what = concat("a picture of ", width, "x", height);
  limit.check_ahead(need, what, "take a smaller one", {runtime::Hint::FewerQueries});
  if (need <= free) return;
  throw runtime::NotEnoughMemory(
      concat(what, " needs ", runtime::memory_text(need), " and ", runtime::memory_text(free),
             " are free: take a smaller one"),
      {runtime::Hint::FewerQueries});
}

}  // namespace lte::infer
