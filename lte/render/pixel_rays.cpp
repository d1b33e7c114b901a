#include "lte/render/pixel_rays.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lte/base/parallel_each.h"
#include "lte/base/random.h"
#include "lte/pathtrace/blocks/tile_sequence.h"
#include "lte/pathtrace/render.h"
#include "lte/render/edges.h"
#include "lte/scene/metal.h"

namespace lte::render {
namespace {

using pathtrace::PixelRadiance;

constexpr int64_t kPixelsAtOnce = 1 << 12;
/// Above this a surface counts as metal: an irradiance at a point says too little of it.
constexpr float kMetallic = 0.05f;
// Streams of random numbers: light at points, whole paths in pixels with metal.
constexpr uint64_t kPoints = 41, kMetalPaths = 42;
constexpr uint64_t kScramble = 44;  // of places in pixels

/// Where in a pixel its camera ray of this number goes: Sobol's first two dimensions, of which each
/// power of two is stratified in both, under a scramble a pixel. An edge through the pixel then
/// parts the rays as it parts the pixel, but for one over their number.
Vec2 place_in_pixel(size_t pixel, int number) {
  const auto n = static_cast<uint32_t>(number);
  uint32_t x = 0, y = 0;
  for (uint32_t bit = 0, column = 1u << 31; n >> bit != 0; ++bit, column ^= column >> 1) {
    if ((n >> bit & 1) == 0) continue;
    x ^= 1u << (31 - bit);
    y ^= column;
  }
  const uint64_t scramble = hash_combine(kScramble, pixel);
  const auto unit = [](uint32_t bits) { return static_cast<float>(bits >> 8) * 0x1p-24f; };
  return {unit(x ^ static_cast<uint32_t>(scramble)),
          unit(y ^ static_cast<uint32_t>(scramble >> 32))};
}

}  // namespace

PixelRays::PixelRays(const TracedScene& scene, const scene::Camera& camera,
                     const RenderSettings& settings, const Rays& rays,
                     std::span<const size_t> pixels, Film* film)
    : scene_(scene),
      camera_(camera),
      settings_(settings),
      rays_(rays),
      pixels_(pixels),
      film_(*film),
      pixel_size_(pathtrace::pixel_size(camera, film->height)) {}

const scene::Material& PixelRays::material_of(int32_t instance) const {
  const scene::Scene& scene = scene_.bvh.scene();
  const int mesh = scene.instances[static_cast<size_t>(instance)].mesh;
  return scene.materials[static_cast<size_t>(scene.meshes[static_cast<size_t>(mesh)].material)];
}

bool PixelRays::reflects(size_t hit) const {
  return hits_.mask[hit] && (settings_.irradiance || max_component(hits_.albedo[hit]) > 0);
}

Rgb PixelRays::albedo(size_t hit) const {
  return settings_.irradiance ? Rgb{kPi, kPi, kPi} : hits_.albedo[hit];
}

void PixelRays::see() {
  const auto rays = static_cast<size_t>(rays_.count);
  std::vector<Vec2> points(pixels_.size() * rays);
  parallel_each(pixels_.size(), kPixelsAtOnce, [&](size_t i) {
    const auto width = static_cast<size_t>(film_.width);
    const size_t column = pixels_[i] % width, row = pixels_[i] / width;
    const auto x = static_cast<float>(column), y = static_cast<float>(row);
    for (size_t k = 0; k < rays; ++k) {
      const Vec2 in_pixel =
          is_center() ? Vec2{0.5f, 0.5f}
                      : place_in_pixel(pixels_[i], film_.rays[pixels_[i]] + static_cast<int>(k));
      points[i * rays + k] = {x + in_pixel.x, y + in_pixel.y};
    }
  });
  // Rays of a pixel that are spread over it filter its texture together.
  const int of_pixel = is_center() ? 1 : std::max(rays_.count, film_.passes + 1);
  pathtrace::append_image_points(scene_.bvh, camera_, film_.width, film_.height, points, &hits_,
                                 1 / std::sqrt(static_cast<float>(of_pixel)));
  if (!hits_.metallic.empty() && film_.has_metal.empty()) {
    film_.has_metal.resize(film_.pixels());
    film_.metal.resize(film_.pixels());
    film_.default_metal.resize(film_.pixels());
  }
  parallel_each(pixels_.size(), kPixelsAtOnce, [&](size_t i) {
    for (size_t k = i * rays; k < (i + 1) * rays; ++k) add_hit(pixels_[i], k);
  });
}

void PixelRays::add_hit(size_t pixel, size_t hit) {
  const auto add = [&](image::Image* sum, const Rgb& value) {
    sum->set_rgb(pixel, sum->rgb(pixel) + value);
  };
  ++film_.rays[pixel];
  if (!settings_.irradiance) add(&film_.emission, hits_.emission[hit]);
  if (!hits_.mask[hit]) return;
  ++film_.surface_hits[pixel];
  add(&film_.albedo, hits_.albedo[hit]);
  add(&film_.normal, hits_.normal[hit]);
  film_.depth[pixel] += hits_.depth[hit];
  if (is_center()) {
    film_.center_position.set_rgb(pixel, hits_.position[hit]);
    film_.center_normal.set_rgb(pixel, hits_.geometric(hit));
    film_.center_tolerance[pixel] = hits_.depth[hit] * pixel_size_;
  }
  if (hits_.metallic.empty() || !(hits_.metallic[hit] > 0)) return;
  film_.metal[pixel] += hits_.metallic[hit];
  if (scene::is_default_metal(material_of(hits_.instance[hit])))
    film_.default_metal[pixel] += hits_.metallic[hit];
  if (settings_.irradiance || film_.has_metal[pixel] || hits_.metallic[hit] <= kMetallic) return;
  film_.has_metal[pixel] = 1;
  film_.gathered.forget(pixel);
}

/// The pixel whose irradiance has the light of a hit in one at an edge, which counts it.
size_t PixelRays::source_of(size_t pixel, size_t hit, EdgePixel* edge) {
  const SurfacePlace place{hits_.position[hit], hits_.geometric(hit),
                           hits_.depth[hit] * pixel_size_};
  const int source = light_source(film_, pixel, place);
  edge->mixed = edge->mixed || !same_surface(place, film_.center(pixel));
  if (source < 0) return Film::kNoPixel;
  edge->albedo[static_cast<size_t>(source)] += albedo(hit);
  return film_.near_pixel(pixel, static_cast<size_t>(source));
}

void PixelRays::list_hits(std::vector<LitHit>* lit, std::vector<size_t>* metal) {
  const auto count = static_cast<size_t>(rays_.count);
  for (size_t i = 0; i < pixels_.size(); ++i) {
    const size_t pixel = pixels_[i];
    if (!settings_.irradiance && film_.sees_metal(pixel)) {
      metal->push_back(pixel);
      continue;
    }
    EdgePixel* const edge = film_.edge(pixel);
    for (size_t hit = i * count; hit < (i + 1) * count; ++hit) {
      if (edge != nullptr && (hits_.mask[hit] || !settings_.irradiance)) ++edge->rays;
      if (reflects(hit)) {
        const size_t source = edge == nullptr ? pixel : source_of(pixel, hit, edge);
        if (rays_.lit == Rays::Lit::All || source == Film::kNoPixel) lit->push_back({hit, source});
      } else if (edge != nullptr) {
        edge->mixed = true;
      }
    }
  }
}

/// Pixels of a tile share a point set, which goes on from pass to pass of a half: a denoiser takes
/// the mean of many of them, whose noise falls faster than with a set a pass.
std::vector<pathtrace::SampleNumber> PixelRays::sample_numbers(const std::vector<LitHit>& lit,
                                                               int samples) const {
  std::vector<pathtrace::SampleNumber> out;
  if (rays_.lit != Rays::Lit::All) return out;
  const uint64_t stream =
      hash_combine(hash_combine(settings_.seed, kPoints), static_cast<uint64_t>(film_.passes % 2));
  const auto number = static_cast<uint32_t>(film_.passes / 2 * samples);
  const auto width = static_cast<size_t>(film_.width);
  for (const LitHit& each : lit) {
    const size_t pixel = pixels_[each.hit / static_cast<size_t>(rays_.count)];
    out.push_back(pathtrace::sample_number(stream, static_cast<uint32_t>(pixel % width),
                                           static_cast<uint32_t>(pixel / width), number));
  }
  return out;
}

void PixelRays::light(const Integrator& integrator, int64_t* next_point) {
  LightSums& sums = film_.gathered.halves[static_cast<size_t>(film_.passes % 2)];
  if (sums.empty()) sums = LightSums(film_.width, film_.height);
  std::vector<LitHit> lit;
  std::vector<size_t> metal;  // pixels
  list_hits(&lit, &metal);
  std::vector<Vec3> position, normal, geometric_normal;
  for (const LitHit& each : lit) {
    position.push_back(hits_.position[each.hit]);
    normal.push_back(hits_.normal[each.hit]);
    if (!hits_.geometric_normal.empty()) geometric_normal.push_back(hits_.geometric(each.hit));
  }
  PointSampling sampling;
  sampling.rays = settings_.indirect ? rays_.rays : 0;
  sampling.light_samples = settings_.direct ? rays_.light_samples : 0;
  sampling.seed =
      hash_combine(hash_combine(settings_.seed, kPoints), static_cast<uint64_t>(film_.passes));
  sampling.first_index = *next_point;
  *next_point += static_cast<int64_t>(lit.size());
  const std::vector<pathtrace::SampleNumber> ray_numbers = sample_numbers(lit, settings_.rays),
                                             light_numbers =
                                                 sample_numbers(lit, settings_.light_samples);
  sampling.ray_numbers = ray_numbers;
  sampling.light_numbers = light_numbers;
  const PointIrradiance light =
      integrator.irradiance({position, normal, geometric_normal}, sampling);
  for (size_t k = 0; k < lit.size(); ++k) {
    PixelRadiance sample;
    if (!light.direct.empty()) sample.direct = light.direct[k];
    if (!light.indirect.empty()) sample.indirect = light.indirect[k];
    if (lit[k].source != Film::kNoPixel) {
      sums.add(lit[k].source, sample, 1);
      continue;
    }
    EdgePixel* const edge = film_.edge(pixels_[lit[k].hit / static_cast<size_t>(rays_.count)]);
    const Rgb reflected = albedo(lit[k].hit) * (1 / kPi);
    edge->lit_albedo += albedo(lit[k].hit);
    edge->direct += reflected * sample.direct;
    edge->indirect += reflected * sample.indirect;
  }
  if (!metal.empty()) trace_metal(metal, &sums);
}

void PixelRays::trace_metal(const std::vector<size_t>& metal, LightSums* sums) {
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

}  // namespace lte::render
