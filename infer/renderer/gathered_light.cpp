#include "infer/renderer/gathered_light.h"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "infer/picture/picture_band.h"
#include "infer/picture/surface_guides.h"
#include "infer/renderer/path_correction.h"
#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/base/random.h"
#include "lte/base/timer.h"
#include "lte/gi/upsample.h"

namespace lte::infer {
namespace {

using image::Image;

constexpr int kTile = 8;
// What a thread takes at a time.
constexpr int64_t kPixels = 1 << 14, kRows = 8;
constexpr size_t kPacedPoints = 1 << 13;  // whose rays a pace chooses at once
// Rays at the grid, of pixels that stand alone and of the two halves of the correcting paths are
// independent of each other, and of direct light's.
constexpr uint64_t kGather = 31, kAlone = 32, kHalves = 33;

/// A view whose light is gathered.
class Gatherer {
 public:
  Gatherer(const GatherScene& scene, const pathtrace::GBuffer& hits, float pixel_size,
           bool skip_metal, const GatherSettings& settings, const GatherDirect& direct,
           const image::Denoiser* denoiser)
      : scene_(scene),
        hits_(hits),
        settings_(settings),
        direct_(direct),
        denoiser_(denoiser),
        columns_(settings.step, hits.width),
        rows_(settings.step, hits.height),
        reflects_(hits.mask.size()) {
    const bool metal = skip_metal && !hits.metallic.empty();
    for_pixels([&](size_t i) {
      reflects_[i] = hits.mask[i] && max_component(hits.albedo[i]) > 0 &&
                     !(metal && is_metal(hits.metallic[i]));
    });
    surfaces_.width = hits.width;
    surfaces_.height = hits.height;
    surfaces_.position = hits.position;
    surfaces_.normal = hits.normal;
    surfaces_.depth = hits.depth;
    surfaces_.mask = reflects_;
    surfaces_.pixel_size = pixel_size;
    const bool sum = direct.shadow_rays > 0 && direct.sum;
    layers_.push_back({sum ? &out_.total : &out_.indirect, {}});
    if (direct.shadow_rays > 0 && !sum) layers_.push_back({&out_.direct, {}});
    for (Layer& layer : layers_) layer.values.resize(reflects_.size());
  }

  GatheredCentres run() {
    sample_grid();
    Timer timer;
    if (denoiser_ != nullptr) denoise();
    out_.denoise_seconds = timer.seconds();
    if (settings_.step > 1) fill();
    timer.restart();
    for (Layer& layer : layers_) {
      *layer.out = Image(hits_.width, hits_.height, 3);
      for_pixels([&](size_t i) { layer.out->set_rgb(i, layer.values[i]); });
    }
    out_.fill_seconds += timer.seconds();
    if (settings_.paths > 0) correct();  // of irradiance alone
    return std::move(out_);
  }

 private:
  /// Light of one kind, 0 where none is reflected.
  struct Layer {
    Image* out;
    std::vector<Rgb> values;
  };

  void add_point(size_t pixel, int step, LitPoints* out) const {
    out->position.push_back(hits_.position[pixel]);
    out->normal.push_back(hits_.normal[pixel]);
    out->extent.push_back(hits_.depth[pixel] * surfaces_.pixel_size * static_cast<float>(step));
    out->pixel.push_back(pixel);
  }

  /// Pixels of the grid that reflect light, tile by tile.
  LitPoints grid_points() const {
    LitPoints out;
    out.reserve(grid_size());
    for (int tile_y = 0; tile_y < rows_.count(); tile_y += kTile) {
      for (int tile_x = 0; tile_x < columns_.count(); tile_x += kTile) {
        for (int j = tile_y; j < std::min(tile_y + kTile, rows_.count()); ++j) {
          for (int i = tile_x; i < std::min(tile_x + kTile, columns_.count()); ++i) {
            const size_t pixel = surfaces_.at(columns_.at(i), rows_.at(j));
            if (reflects_[pixel]) add_point(pixel, settings_.step, &out);
          }
        }
      }
    }
    return out;
  }

  /// Light on the grid, with the rays that were wanted or that a pace has time for.
  void sample_grid() {
    const LitPoints points = grid_points();
    const LightRays wanted{settings_.rays, direct_.shadow_rays};
    if (settings_.pace == nullptr) {
      sample(points, wanted, kGather, 0);
      return;
    }
    std::vector<size_t> block;
    for (size_t begin = 0; begin < points.size(); begin += kPacedPoints) {
      block.resize(std::min(kPacedPoints, points.size() - begin));
      std::iota(block.begin(), block.end(), begin);
      const LightRays rays =
          settings_.pace->rays(wanted, static_cast<int64_t>(points.size() - begin));
      const LightWork before = out_.work;
      sample(points.some(block), rays, kGather, static_cast<int64_t>(begin));
      settings_.pace->add_rays(
          rays, {out_.work.points - before.points, out_.work.gather_seconds - before.gather_seconds,
                 out_.work.direct_seconds - before.direct_seconds});
    }
  }

  /// Light at points, into their pixels.
  void sample(const LitPoints& points, const LightRays& rays, uint64_t stream,
              int64_t first_index) {
    GatherScene scene = scene_;
    scene.seed = hash_combine(scene_.seed, stream);
    const PointLight light = light_points(scene, points, rays, first_index, &out_.work);
    for (size_t k = 0; k < points.size(); ++k) {
      const size_t pixel = points.pixel[k];
      if (direct_.shadow_rays > 0 && direct_.sum) {
        layers_[0].values[pixel] = light.indirect[k] + light.direct[k];
        continue;
      }
      layers_[0].values[pixel] = light.indirect[k];
      if (direct_.shadow_rays > 0) layers_[1].values[pixel] = light.direct[k];
    }
  }

  /// Takes noise away on the grid. What reflects nothing has no normal, like background.
  void denoise() {
    const Image black(columns_.count(), rows_.count(), 3);
    Image normal = black, position = black;
    for_grid([&](size_t small, size_t pixel) {
      if (!reflects_[pixel]) return;
      normal.set_rgb(small, hits_.normal[pixel]);
      position.set_rgb(small, hits_.position[pixel]);
    });
    for (Layer& layer : layers_) {
      Image light = black;
      for_grid([&](size_t small, size_t pixel) {
        if (reflects_[pixel]) light.set_rgb(small, layer.values[pixel]);
      });
      const Image clean =
          denoiser_->denoise({&light, &normal, &position, nullptr, nullptr}, settings_.quality);
      for_grid([&](size_t small, size_t pixel) {
        if (reflects_[pixel]) layer.values[pixel] = clean.rgb(small);
      });
    }
  }

  size_t grid_size() const {
    return static_cast<size_t>(columns_.count()) * static_cast<size_t>(rows_.count());
  }

  /// Calls use(number on the grid, pixel) for all of the grid, in several threads.
  template <typename Use>
  void for_grid(const Use& use) const {
    parallel_for(rows_.count(), kRows, [&](int64_t begin, int64_t end) {
      for (auto j = static_cast<int>(begin); j < static_cast<int>(end); ++j) {
        for (int i = 0; i < columns_.count(); ++i) {
          const auto small = static_cast<size_t>(j) * static_cast<size_t>(columns_.count()) +
                             static_cast<size_t>(i);
          use(small, surfaces_.at(columns_.at(i), rows_.at(j)));
        }
      }
    });
  }

  /// The pixels between those of the grid.
  void fill() {
    const Timer timer;
    std::vector<int32_t> open;  // where surfaces decide alone: the same in all layers
    for (Layer& layer : layers_) {
      std::vector<uint8_t> known(reflects_.size());
      for_grid([&](size_t, size_t pixel) { known[pixel] = reflects_[pixel]; });
      open = gi::upsample(surfaces_, settings_.step, known, layer.values);
    }
    out_.fill_seconds = timer.seconds();
    LitPoints points;
    for (const int32_t pixel : open) add_point(static_cast<size_t>(pixel), 1, &points);
    const auto alone = [](int count) { return count > 0 ? std::max(count, kLeastAloneRays) : 0; };
    sample(points, {alone(settings_.rays), alone(direct_.shadow_rays)}, kAlone, 0);
  }

  /// Calls use(pixel) for all of them, in several threads.
  template <typename Use>
  void for_pixels(const Use& use) const {
    parallel_for(static_cast<int64_t>(hits_.mask.size()), kPixels, [&](int64_t begin, int64_t end) {
      for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i) use(i);
    });
  }

  /// Paths know what the table does not.
  void correct() {
    Timer timer;
    LitPoints points;
    for (size_t i = 0; i < reflects_.size(); ++i) {
      if (reflects_[i]) add_point(i, 1, &points);
    }
    const gi::RadiosityTable none(scene_.bvh, {}, {});
    std::array<Image, 2> half;
    LightWork work;
    for (uint64_t h = 0; h < 2; ++h) {
      half[h] = Image(hits_.width, hits_.height, 3);
      const PointLight light =
          light_points({scene_.bvh, scene_.lights, none, scene_.max_depth,
                        hash_combine(hash_combine(scene_.seed, kHalves), h)},
                       points, {std::max(1, settings_.paths / 2), 0}, 0, &work);
      for (size_t k = 0; k < points.size(); ++k)
        half[h].set_rgb(points.pixel[k], light.indirect[k]);
    }
    out_.path_seconds = timer.seconds();
    timer.restart();
    out_.indirect = correct_by_paths(guides_of(hits_), reflects_, out_.indirect, half[0], half[1]);
    out_.denoise_seconds += timer.seconds();
  }

  const GatherScene& scene_;
  const pathtrace::GBuffer& hits_;
  const GatherSettings& settings_;
  const GatherDirect& direct_;
  const image::Denoiser* denoiser_;
  gi::GridAxis columns_, rows_;
  gi::PixelSurfaces surfaces_;
  std::vector<uint8_t> reflects_;
  GatheredCentres out_;
  std::vector<Layer> layers_;  ///< those of out_ that are wanted
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

GatheredCentres gather_centres(const GatherScene& scene, const pathtrace::GBuffer& hits,
                               float pixel_size, bool skip_metal, const GatherSettings& settings,
                               const GatherDirect& direct, const image::Denoiser* denoiser) {
  check_gather_settings(settings);
  return Gatherer(scene, hits, pixel_size, skip_metal, settings, direct, denoiser).run();
}

}  // namespace lte::infer
