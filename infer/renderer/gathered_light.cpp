#include "infer/renderer/gathered_light.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "infer/renderer/path_correction.h"
#include "lte/base/check.h"
#include "lte/base/random.h"
#include "lte/base/timer.h"
#include "lte/gi/gather.h"
#include "lte/gi/upsample.h"

namespace lte::infer {
namespace {

using image::Image;

constexpr int kTile = 8;
// Rays of gathers, of pixels that stand alone and of the two halves of the correcting paths are
// independent of each other, and of direct light's.
constexpr uint64_t kGather = 31, kAlone = 32, kHalves = 33;

void put(Image* image, size_t pixel, const Rgb& value) {
  for (size_t c = 0; c < 3; ++c) image->pixels[3 * pixel + c] = value[static_cast<int>(c)];
}

Rgb get(const Image& image, size_t pixel) {
  const float* p = image.pixels.data() + 3 * pixel;
  return {p[0], p[1], p[2]};
}

/// Points of pixels, whose rays meet the same nodes and triangles if the pixels are neighbours.
struct Points {
  std::vector<Vec3> position, normal;
  std::vector<size_t> pixel;
  void add(const SurfaceGuides& guides, size_t at) {
    position.push_back(get(guides.position, at));
    normal.push_back(get(guides.normal, at));
    pixel.push_back(at);
  }
};

/// A view whose light is gathered.
class Gatherer {
 public:
  Gatherer(const GatherScene& scene, const SurfaceGuides& guides, float pixel_size, bool skip_metal,
           const GatherSettings& settings, const image::Denoiser* denoiser)
      : scene_(scene),
        guides_(guides),
        settings_(settings),
        denoiser_(denoiser),
        columns_(settings.step, guides.width()),
        rows_(settings.step, guides.height()) {
    reflects_.resize(guides.pixels());
    for (size_t i = 0; i < reflects_.size(); ++i) {
      reflects_[i] = guides.mask[i] && max_component(get(guides.albedo, i)) > 0 &&
                     !(skip_metal && guides.metal[i]);
    }
    surfaces_.width = guides.width();
    surfaces_.height = guides.height();
    surfaces_.pixel_size = pixel_size;
  }

  GatheredCentres run() {
    Timer timer;
    out_.irradiance = Image(guides_.width(), guides_.height(), 3);
    const Points points = grid_points();
    const std::vector<Rgb> light = rays(points, settings_.rays, kGather);
    for (size_t k = 0; k < light.size(); ++k) put(&out_.irradiance, points.pixel[k], light[k]);
    out_.gather_seconds = timer.seconds();
    timer.restart();
    if (denoiser_ != nullptr) denoise();
    out_.denoise_seconds = timer.seconds();
    timer.restart();
    if (settings_.step > 1) fill();
    out_.gather_seconds += timer.seconds();
    if (settings_.paths > 0) correct();
    return std::move(out_);
  }

 private:
  bool skips() const { return settings_.step > 1; }

  /// Pixels of the grid that reflect light, tile by tile.
  Points grid_points() const {
    Points out;
    for (int tile_y = 0; tile_y < rows_.count(); tile_y += kTile) {
      for (int tile_x = 0; tile_x < columns_.count(); tile_x += kTile) {
        for (int j = tile_y; j < std::min(tile_y + kTile, rows_.count()); ++j) {
          for (int i = tile_x; i < std::min(tile_x + kTile, columns_.count()); ++i) {
            const size_t pixel = guides_.index(columns_.at(i), rows_.at(j));
            if (reflects_[pixel]) out.add(guides_, pixel);
          }
        }
      }
    }
    return out;
  }

  std::vector<Rgb> rays(const Points& points, int count, uint64_t stream) {
    out_.gathered += static_cast<int64_t>(points.pixel.size());
    GatherScene scene = scene_;
    scene.seed = hash_combine(scene_.seed, stream);
    return gather_points(scene, points.position, points.normal, count, 0);
  }

  /// Takes noise away on the grid. What reflects nothing has no normal, like background.
  void denoise() {
    const Image black(columns_.count(), rows_.count(), 3);
    Image light = black, normal = black, position = black;
    for_grid([&](size_t small, size_t pixel) {
      if (!reflects_[pixel]) return;
      put(&light, small, get(out_.irradiance, pixel));
      put(&normal, small, get(guides_.normal, pixel));
      put(&position, small, get(guides_.position, pixel));
    });
    const Image clean =
        denoiser_->denoise({&light, &normal, &position, nullptr, nullptr}, settings_.quality);
    for_grid([&](size_t small, size_t pixel) {
      if (reflects_[pixel]) put(&out_.irradiance, pixel, get(clean, small));
    });
  }

  template <typename Use>
  void for_grid(const Use& use) const {
    for (int j = 0; j < rows_.count(); ++j) {
      for (int i = 0; i < columns_.count(); ++i) {
        const auto small =
            static_cast<size_t>(j) * static_cast<size_t>(columns_.count()) + static_cast<size_t>(i);
        use(small, guides_.index(columns_.at(i), rows_.at(j)));
      }
    }
  }

  /// The pixels between those of the grid.
  void fill() {
    std::vector<Vec3> position(guides_.pixels()), normal(guides_.pixels());
    std::vector<Rgb> values(guides_.pixels());
    std::vector<uint8_t> known(guides_.pixels());
    for (size_t i = 0; i < values.size(); ++i) {
      position[i] = get(guides_.position, i);
      normal[i] = get(guides_.normal, i);
    }
    for_grid([&](size_t, size_t pixel) {
      values[pixel] = get(out_.irradiance, pixel);
      known[pixel] = reflects_[pixel];
    });
    surfaces_.position = position;
    surfaces_.normal = normal;
    surfaces_.depth = guides_.depth;
    surfaces_.mask = reflects_;
    const std::vector<int32_t> open = gi::upsample(surfaces_, settings_.step, known, values);
    Points points;
    for (const int32_t pixel : open) points.add(guides_, static_cast<size_t>(pixel));
    const std::vector<Rgb> light = rays(points, std::max(settings_.rays, kLeastAloneRays), kAlone);
    for (size_t k = 0; k < light.size(); ++k) values[points.pixel[k]] = light[k];
    for (size_t i = 0; i < values.size(); ++i) {
      if (reflects_[i]) put(&out_.irradiance, i, values[i]);
    }
  }

  /// Paths know what the table does not.
  void correct() {
    Timer timer;
    Points points;
    for (size_t i = 0; i < reflects_.size(); ++i) {
      if (reflects_[i]) points.add(guides_, i);
    }
    const gi::RadiosityTable none(scene_.bvh, {}, {});
    std::array<Image, 2> half;
    for (uint64_t h = 0; h < 2; ++h) {
      half[h] = Image(guides_.width(), guides_.height(), 3);
      const std::vector<Rgb> light =
          gather_points({scene_.bvh, scene_.lights, none, scene_.max_depth,
                         hash_combine(hash_combine(scene_.seed, kHalves), h)},
                        points.position, points.normal, std::max(1, settings_.paths / 2), 0);
      for (size_t k = 0; k < light.size(); ++k) put(&half[h], points.pixel[k], light[k]);
    }
    out_.path_seconds = timer.seconds();
    timer.restart();
    out_.irradiance = correct_by_paths(guides_, reflects_, out_.irradiance, half[0], half[1]);
    out_.denoise_seconds += timer.seconds();
  }

  const GatherScene& scene_;
  const SurfaceGuides& guides_;
  const GatherSettings& settings_;
  const image::Denoiser* denoiser_;
  gi::GridAxis columns_, rows_;
  gi::PixelSurfaces surfaces_;
  std::vector<uint8_t> reflects_;
  GatheredCentres out_;
};

}  // namespace

void check_gather_settings(const GatherSettings& settings) {
  const int step = settings.step;
  LTE_CHECK(settings.rays >= 1, "gather: rays must be at least 1, got ", settings.rays);
  LTE_CHECK(step >= 1 && step <= 64 && (step & (step - 1)) == 0,
            "gather: step must be a power of two up to 64, got ", step);
  LTE_CHECK(settings.paths >= 0 && settings.paths % 2 == 0,
            "gather: paths must be an even number, got ", settings.paths);
}

std::vector<Rgb> gather_points(const GatherScene& scene, std::span<const Vec3> positions,
                               std::span<const Vec3> normals, int rays, int64_t first_index) {
  if (scene.max_depth < 2) return std::vector<Rgb>(positions.size());
  gi::GatherOptions options;
  options.rays = rays;
  options.max_depth = scene.max_depth;
  options.seed = scene.seed;
  return std::move(gi::gather_irradiance(scene.bvh, scene.lights, scene.table, positions, normals,
                                         options, first_index)
                       .indirect);
}

GatheredCentres gather_centres(const GatherScene& scene, const SurfaceGuides& guides,
                               float pixel_size, bool skip_metal, const GatherSettings& settings,
                               const image::Denoiser* denoiser) {
  check_gather_settings(settings);
  return Gatherer(scene, guides, pixel_size, skip_metal, settings, denoiser).run();
}

}  // namespace lte::infer
