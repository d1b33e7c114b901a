#include "lte/render/camera_pass.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "lte/base/parallel.h"
#include "lte/base/random.h"
#include "lte/base/timer.h"
#include "lte/pathtrace/gbuffer.h"
#include "lte/pathtrace/render.h"
#include "lte/render/edges.h"
#include "lte/scene/metal.h"

namespace lte::render {
namespace {

using pathtrace::GBuffer;
using pathtrace::PixelRadiance;

constexpr int kTile = 8;  // neighbours in space are neighbours in blocks of rays
constexpr int64_t kStripPixels = int64_t{1} << 15;
constexpr int64_t kPixelsAtOnce = 1 << 12;
/// Camera rays for the emission of a pixel at a lamp's edge.
constexpr int kLampRays = 128;
/// Above this a surface counts as metal: an irradiance at a point says too little of it.
constexpr float kMetallic = 0.05f;
// Streams of random numbers: light at points, whole paths in pixels with metal, path passes.
constexpr uint64_t kPoints = 41, kMetalPaths = 42, kPaths = 43;

/// Where in its pixel a camera ray goes: the middle, then the R2 sequence (Roberts 2018), the
/// fractional parts of multiples of the plastic number's inverses.
Vec2 jitter(int number) {
  const auto part = [&](double step) {
    const double at = 0.5 + step * number;
    return static_cast<float>(std::min(at - std::floor(at), 1 - 0x1p-20));
  };
  return {part(0.7548776662466927), part(0.5698402909980532)};
}

/// The pixels of some rows tile by tile.
std::vector<size_t> tiled(int width, int first, int last) {
  std::vector<size_t> out;
  out.reserve(static_cast<size_t>(width) * static_cast<size_t>(last - first));
  for (int top = first; top < last; top += kTile) {
    for (int left = 0; left < width; left += kTile) {
      for (int y = top; y < std::min(top + kTile, last); ++y) {
        for (int x = left; x < std::min(left + kTile, width); ++x)
          out.push_back(static_cast<size_t>(y) * static_cast<size_t>(width) +
                        static_cast<size_t>(x));
      }
    }
  }
  return out;
}

/// Sums that are there from now on.
void begin(const Film& film, LightSums* sums) {
  if (!sums->empty()) return;
  sums->emission = sums->direct = sums->indirect = image::Image(film.width, film.height, 3);
  sums->samples.resize(film.pixels());
}

/// Which camera rays pixels get, and which of their hits are lit.
struct Rays {
  int count = 1;
  int lit_every = 1;  ///< the first of so many; 0: none
  int rays = 1, light_samples = 1;
};

/// Some pixels in one pass.
class Batch {
 public:
  Batch(const TracedScene& scene, const scene::Camera& camera, const RenderSettings& settings,
        const Rays& rays, std::span<const size_t> pixels, Film* film)
      : scene_(scene),
        camera_(camera),
        settings_(settings),
        rays_(rays),
        pixels_(pixels),
        film_(*film) {}

  /// Traces the camera rays and sums up what they see.
  void see() {
    const auto rays = static_cast<size_t>(rays_.count);
    std::vector<Vec2> points(pixels_.size() * rays);
    for_pixels([&](size_t i) {
      const auto width = static_cast<size_t>(film_.width);
      const size_t column = pixels_[i] % width, row = pixels_[i] / width;
      const auto x = static_cast<float>(column), y = static_cast<float>(row);
      for (size_t k = 0; k < rays; ++k) {
        const Vec2 in_pixel = jitter(film_.rays[pixels_[i]] + static_cast<int>(k));
        points[i * rays + k] = {x + in_pixel.x, y + in_pixel.y};
      }
    });
    pathtrace::append_image_points(scene_.bvh, camera_, film_.width, film_.height, points, &hits_);
    if (!hits_.metallic.empty() && film_.has_metal.empty()) {
      film_.has_metal.resize(film_.pixels());
      film_.metal.resize(film_.pixels());
      film_.default_metal.resize(film_.pixels());
    }
    for_pixels([&](size_t i) {
      for (size_t k = i * rays; k < (i + 1) * rays; ++k) add_hit(pixels_[i], k);
    });
  }

  /// Light at hits.
  /// @param next_point  number of the next random stream
  void light(const Integrator& integrator, int64_t* next_point) {
    LightSums& sums = film_.gathered.halves[static_cast<size_t>(film_.passes % 2)];
    begin(film_, &sums);
    std::vector<Vec3> position, normal, geometric_normal;
    std::vector<size_t> lit;    // hits
    std::vector<size_t> metal;  // pixels
    for (size_t i = 0; i < pixels_.size(); ++i) {
      const size_t pixel = pixels_[i];
      if (!settings_.irradiance && film_.sees_metal(pixel)) {
        metal.push_back(pixel);
        continue;
      }
      const auto count = static_cast<size_t>(rays_.count);
      for (size_t k = 0; k < count; k += static_cast<size_t>(rays_.lit_every)) {
        const size_t hit = i * count + k;
        if (!reflects(hit)) {
          ++sums.samples[pixel];
          continue;
        }
        position.push_back(hits_.position[hit]);
        normal.push_back(hits_.normal[hit]);
        if (!hits_.geometric_normal.empty()) geometric_normal.push_back(hits_.geometric(hit));
        lit.push_back(hit);
      }
    }
    PointSampling sampling;
    sampling.rays = settings_.indirect ? rays_.rays : 0;
    sampling.light_samples = settings_.direct ? rays_.light_samples : 0;
    sampling.seed =
        hash_combine(hash_combine(settings_.seed, kPoints), static_cast<uint64_t>(film_.passes));
    sampling.first_index = *next_point;
    *next_point += static_cast<int64_t>(lit.size());
    const PointIrradiance light =
        integrator.irradiance({position, normal, geometric_normal}, sampling);
    for (size_t k = 0; k < lit.size(); ++k) add_light(lit[k], k, light, &sums);
    if (!metal.empty()) trace_metal(metal, &sums);
  }

 private:
  template <typename Use>
  void for_pixels(const Use& use) {
    parallel_for(static_cast<int64_t>(pixels_.size()), kPixelsAtOnce,
                 [&](int64_t begin, int64_t end) {
                   for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i)
                     use(i);
                 });
  }

  const scene::Material& material_of(int32_t instance) const {
    const scene::Scene& scene = scene_.bvh.scene();
    const int mesh = scene.instances[static_cast<size_t>(instance)].mesh;
    return scene.materials[static_cast<size_t>(scene.meshes[static_cast<size_t>(mesh)].material)];
  }

  bool reflects(size_t hit) const {
    return hits_.mask[hit] && (settings_.irradiance || max_component(hits_.albedo[hit]) > 0);
  }

  void add_hit(size_t pixel, size_t hit) {
    const auto add = [&](image::Image* sum, const Rgb& value) {
      sum->set_rgb(pixel, sum->rgb(pixel) + value);
    };
    ++film_.rays[pixel];
    if (!settings_.irradiance) add(&film_.emission, hits_.emission[hit]);
    if (!hits_.mask[hit]) return;
    ++film_.surface_hits[pixel];
    add(&film_.albedo, hits_.albedo[hit]);
    add(&film_.normal, hits_.normal[hit]);
    add(&film_.position, hits_.position[hit]);
    film_.depth[pixel] += hits_.depth[hit];
    if (hits_.metallic.empty() || !(hits_.metallic[hit] > 0)) return;
    film_.metal[pixel] += hits_.metallic[hit];
    if (scene::is_default_metal(material_of(hits_.instance[hit])))
      film_.default_metal[pixel] += hits_.metallic[hit];
    if (settings_.irradiance || film_.has_metal[pixel] || hits_.metallic[hit] <= kMetallic) return;
    film_.has_metal[pixel] = 1;
    film_.gathered.forget(pixel);
    film_.gathered_albedo.set_rgb(pixel, {0, 0, 0});
  }

  void add_light(size_t hit, size_t point, const PointIrradiance& light, LightSums* sums) {
    const size_t pixel = pixels_[hit / static_cast<size_t>(rays_.count)];
    const Rgb albedo = settings_.irradiance ? Rgb{kPi, kPi, kPi} : hits_.albedo[hit];
    PixelRadiance radiance;
    if (!light.direct.empty()) radiance.direct = albedo * light.direct[point] * (1 / kPi);
    if (!light.indirect.empty()) radiance.indirect = albedo * light.indirect[point] * (1 / kPi);
    sums->add(pixel, radiance, 1);
    film_.gathered_albedo.set_rgb(pixel, film_.gathered_albedo.rgb(pixel) + albedo);
  }

  void trace_metal(const std::vector<size_t>& metal, LightSums* sums) {
    const std::vector<int64_t> pixels(metal.begin(), metal.end());
    pathtrace::RenderOptions options;
    options.spp = std::max(2, rays_.count);
    options.max_depth = settings_.max_depth + 1;
    options.seed = hash_combine(hash_combine(settings_.seed, kMetalPaths),
                                2 * static_cast<uint64_t>(film_.passes) + (rays_.count > 1));
    const std::vector<PixelRadiance> found = pathtrace::trace_pixels(
        scene_.bvh, scene_.lights, camera_, film_.width, film_.height, pixels, options);
    const auto weight = static_cast<float>(options.spp);
    for (size_t k = 0; k < metal.size(); ++k) {
      PixelRadiance light;
      if (settings_.direct) light.direct = found[k].direct * weight;
      if (settings_.indirect) light.indirect = found[k].indirect * weight;
      sums->add(metal[k], light, options.spp);
    }
  }

  const TracedScene& scene_;
  const scene::Camera& camera_;
  const RenderSettings& settings_;
  const Rays rays_;
  std::span<const size_t> pixels_;
  Film& film_;
  GBuffer hits_;
};

int strip_rows(const Film& film) {
  const auto rows = static_cast<int>(std::max<int64_t>(1, kStripPixels / film.width));
  return std::max(kTile, rows / kTile * kTile);
}

/// Camera rays of some pixels, and light at what they meet.
void add_rays(const TracedScene& scene, const Integrator* integrator, const scene::Camera& camera,
              const RenderSettings& settings, const Rays& rays, std::span<const size_t> pixels,
              int64_t* next_point, Film* film, RenderSeconds* seconds) {
  const size_t at_once = static_cast<size_t>(kStripPixels / rays.count);
  for (size_t first = 0; first < pixels.size(); first += at_once) {
    Batch batch(scene, camera, settings, rays,
                pixels.subspan(first, std::min(at_once, pixels.size() - first)), film);
    Timer timer;
    batch.see();
    seconds->hits += timer.seconds();
    timer.restart();
    if (integrator != nullptr && rays.lit_every > 0) batch.light(*integrator, next_point);
    seconds->light += timer.seconds();
  }
}

}  // namespace

bool camera_pass(const TracedScene& scene, const Integrator* integrator,
                 const scene::Camera& camera, const RenderSettings& settings,
                 const std::function<bool()>& stop, Film* film, RenderSeconds* seconds) {
  int64_t next_point = 0;
  const int rows = strip_rows(*film);
  const Rays every{1, 1, settings.rays, settings.light_samples};
  bool all = true;
  for (int first = 0; first < film->height && all; first += rows) {
    all = !stop || !stop();
    if (!all) break;
    add_rays(scene, integrator, camera, settings, every,
             tiled(film->width, first, std::min(first + rows, film->height)), &next_point, film,
             seconds);
  }
  ++film->passes;  // also where it was ended: its random numbers are used up
  if (!all || film->passes > 1 || settings.edge_rays == 0) return all;
  const Edges edges = find_edges(*film, pathtrace::pixel_size(camera, film->height));
  const auto add = [&](const std::vector<size_t>& pixels, const Rays& rays) {
    add_rays(scene, integrator, camera, settings, rays, pixels, &next_point, film, seconds);
  };
  add(edges.surface, {settings.edge_rays, 2, 1, 1});
  add(edges.color, {settings.edge_rays, 0, 1, 1});
  add(edges.lamp, {kLampRays, 0, 1, 1});
  return true;
}

bool path_pass(const TracedScene& scene, const scene::Camera& camera,
               const RenderSettings& settings, const std::function<bool()>& stop, Film* film,
               RenderSeconds* seconds) {
  const Timer timer;
  LightSums& sums = film->paths.halves[static_cast<size_t>(film->path_passes % 2)];
  begin(*film, &sums);
  pathtrace::RenderOptions options;
  options.spp = settings.path_samples;
  options.max_depth = settings.max_depth + 1;
  options.seed =
      hash_combine(hash_combine(settings.seed, kPaths), static_cast<uint64_t>(film->path_passes));
  const auto weight = static_cast<float>(settings.path_samples);
  const int rows = strip_rows(*film);
  std::vector<int64_t> pixels;
  for (int first = 0; first < film->height; first += rows) {
    if (stop && stop()) {
      ++film->path_passes;
      return false;
    }
    const int64_t begin = int64_t{first} * film->width,
                  end = int64_t{std::min(first + rows, film->height)} * film->width;
    pixels.resize(static_cast<size_t>(end - begin));
    std::iota(pixels.begin(), pixels.end(), begin);
    const std::vector<PixelRadiance> found = pathtrace::trace_pixels(
        scene.bvh, scene.lights, camera, film->width, film->height, pixels, options);
    for (size_t i = 0; i < found.size(); ++i) {
      PixelRadiance light;
      light.emission = found[i].emission * weight;
      if (settings.direct) light.direct = found[i].direct * weight;
      if (settings.indirect) light.indirect = found[i].indirect * weight;
      sums.add(static_cast<size_t>(pixels[i]), light, settings.path_samples);
    }
  }
  ++film->path_passes;
  seconds->paths += timer.seconds();
  return true;
}

}  // namespace lte::render
