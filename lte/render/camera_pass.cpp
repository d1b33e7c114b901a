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
#include "lte/render/pixel_rays.h"

namespace lte::render {
namespace {

using pathtrace::PixelRadiance;

constexpr int kTileBits = 3, kTile = 1 << kTileBits;
constexpr int64_t kStripPixels = int64_t{1} << 15;
/// Camera rays for the emission of a pixel at a lamp's edge.
constexpr int kLampRays = 128;
constexpr uint64_t kPaths = 43;  // random numbers of path passes

/// The even bits of a number.
constexpr int even_bits(int number) {
  int out = 0;
  for (int bit = 0; bit < kTileBits; ++bit) out |= (number >> bit) & (1 << bit);
  return out;
}

/// The pixels of some rows tile by tile, those of a tile along Morton's curve: neighbors in space
/// are neighbors in blocks of rays, and share what stratifies them (lte/gi/gather.h).
std::vector<size_t> tiled(int width, int first, int last) {
  std::vector<size_t> out;
  out.reserve(static_cast<size_t>(width) * static_cast<size_t>(last - first));
  for (int top = first; top < last; top += kTile) {
    for (int left = 0; left < width; left += kTile) {
      for (int k = 0; k < kTile * kTile; ++k) {
        const int x = left + even_bits(k), y = top + even_bits(k >> 1);
        if (x < width && y < last)
          out.push_back(static_cast<size_t>(y) * static_cast<size_t>(width) +
                        static_cast<size_t>(x));
      }
    }
  }
  return out;
}

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
    PixelRays batch(scene, camera, settings, rays,
                    pixels.subspan(first, std::min(at_once, pixels.size() - first)), film);
    Timer timer;
    batch.see();
    seconds->hits += timer.seconds();
    timer.restart();
    if (integrator != nullptr && rays.lit != Rays::Lit::None) batch.light(*integrator, next_point);
    seconds->light += timer.seconds();
  }
}

void begin_edges(const std::vector<size_t>& pixels, Film* film) {
  film->edges.resize(pixels.size());
  film->edge_of.assign(film->pixels(), -1);
  for (size_t k = 0; k < pixels.size(); ++k) film->edge_of[pixels[k]] = static_cast<int32_t>(k);
}

/// What a pass takes of the samples that are left.
int left(const RenderSettings& settings, int wanted, int passes) {
  const int64_t taken = int64_t{wanted} * passes;
  return static_cast<int>(std::clamp<int64_t>(settings.max_samples - taken, 1, wanted));
}

}  // namespace

bool camera_pass(const TracedScene& scene, const Integrator* integrator,
                 const scene::Camera& camera, const RenderSettings& settings,
                 const std::function<bool()>& stop, Film* film, RenderSeconds* seconds) {
  int64_t next_point = 0;
  const int rows = strip_rows(*film);
  const auto samples = [&](int wanted) { return left(settings, wanted, film->passes); };
  const Rays every{1, Rays::Lit::All, samples(settings.rays), samples(settings.light_samples)};
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
  const Edges edges = find_edges(*film);
  const auto add = [&](const std::vector<size_t>& pixels, const Rays& rays) {
    add_rays(scene, integrator, camera, settings, rays, pixels, &next_point, film, seconds);
  };
  // Rays through centers are not spread over pixels: those at edges forget theirs.
  for (const std::vector<size_t>* pixels : {&edges.surface, &edges.color, &edges.lamp}) {
    for (const size_t pixel : *pixels) film->forget_rays(pixel);
  }
  const int few = (settings.edge_rays + 1) / 2;
  add(edges.color, {settings.edge_rays, Rays::Lit::None});
  if (integrator != nullptr) begin_edges(edges.surface, film);
  add(edges.surface, {few, Rays::Lit::Unshared});
  std::vector<size_t> mixed;
  for (const size_t pixel : edges.surface) {
    if (integrator == nullptr || film->edge(pixel)->mixed) mixed.push_back(pixel);
  }
  add(mixed, {few, Rays::Lit::Unshared});
  add(edges.lamp, {kLampRays, Rays::Lit::None});
  return true;
}

bool path_pass(const TracedScene& scene, const scene::Camera& camera,
               const RenderSettings& settings, const std::function<bool()>& stop, Film* film,
               RenderSeconds* seconds) {
  const Timer timer;
  LightSums& sums = film->paths.halves[static_cast<size_t>(film->path_passes % 2)];
  if (sums.empty()) sums = LightSums(film->width, film->height);
  pathtrace::RenderOptions options;
  options.spp = left(settings, settings.path_samples, film->path_passes);
  options.max_depth = settings.max_depth + 1;
  options.seed = hash_combine(hash_combine(settings.seed, kPaths),
                              static_cast<uint64_t>(film->path_passes % 2));
  options.had = film->path_passes / 2 * settings.path_samples;
  options.in_all = static_cast<int>(std::min<int64_t>(settings.max_samples, pathtrace::kMaxPaths));
  const auto weight = static_cast<float>(options.spp);
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
      sums.add(static_cast<size_t>(pixels[i]), light, options.spp);
    }
  }
  ++film->path_passes;
  seconds->paths += timer.seconds();
  return true;
}

}  // namespace lte::render
