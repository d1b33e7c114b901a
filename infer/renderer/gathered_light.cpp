#include "infer/renderer/gathered_light.h"

#include <algorithm>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "infer/picture/picture_band.h"
#include "infer/picture/surface_guides.h"
#include "infer/renderer/kept_grid.h"
#include "infer/renderer/path_correction.h"
#include "infer/renderer/picture_grid.h"
#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/base/random.h"
#include "lte/base/timer.h"
#include "lte/gi/lone_pixels.h"
#include "lte/gi/upsample.h"
#include "lte/image/rgb_view.h"

namespace lte::infer {
namespace {

using image::Image;

constexpr int kTile = 8;
// Of pixels that stand alone one in each block of so many squared is asked, and its answer goes so
// far.
constexpr int kAloneBlock = 2, kAloneRadius = 3;
// What a thread takes at a time.
constexpr int64_t kPixels = 1 << 14;
constexpr size_t kPacedPoints = 1 << 13;  // whose rays a pace chooses at once
constexpr size_t kCheckedPoints = 1 << 11;
// Rays at the grid, of pixels that stand alone and of the two halves of the correcting paths are
// independent of each other, and of direct light's.
constexpr uint64_t kGather = 31, kAlone = 32, kHalves = 33, kStillAlone = 34;

/// A view whose light is gathered.
class Gatherer {
 public:
  Gatherer(const GatherScene& scene, const GatherRows& rows, const GatherSettings& settings,
           const GatherDirect& direct, int correction_paths, const image::Denoiser* denoiser)
      : scene_(scene),
        of_(rows),
        hits_(rows.hits),
        settings_(settings),
        direct_(direct),
        correction_paths_(correction_paths),
        denoiser_(denoiser),
        grid_(settings.step, hits_.width, hits_.height),
        reflects_(hits_.mask.size()) {
    const bool metal = rows.skip_metal && !hits_.metallic.empty();
    for_pixels([&](size_t i) {
      reflects_[i] = hits_.mask[i] && max_component(hits_.albedo[i]) > 0 &&
                     !(metal && is_metal(hits_.metallic[i]));
    });
    surfaces_.width = hits_.width;
    surfaces_.height = hits_.height;
    surfaces_.position = hits_.position;
    surfaces_.normal = hits_.normal;
    surfaces_.depth = hits_.depth;
    surfaces_.mask = reflects_;
    surfaces_.pixel_size = rows.pixel_size;
    const bool sum = direct.shadow_rays > 0 && direct.sum;
    const auto add_layer = [&](Image* image) {
      *image = Image(hits_.width, hits_.height, 3);
      layers_.push_back(image::rgb_view(*image));
    };
    add_layer(sum ? &out_.total : &out_.indirect);
    if (direct.shadow_rays > 0 && !sum) add_layer(&out_.direct);
  }

  GatheredCentres run() {
    Timer timer;
    if (of_.kept != nullptr) take_kept();
    out_.fill_seconds = timer.seconds();
    sample_grid();
    timer.restart();
    if (denoiser_ != nullptr) {
      const auto parts = shared_ ? shared_->noisy_parts() : std::vector<TileRect>{grid_.all()};
      for (const TileRect& part : parts) {
        if (settings_.check) settings_.check();
        denoise(part);
      }
      if (shared_) shared_->smooth_scattered();
    }
    out_.denoise_seconds = timer.seconds();
    timer.restart();
    if (shared_) shared_->keep();
    out_.fill_seconds += timer.seconds();
    if (settings_.step > 1) fill();
    if (correction_paths_ > 0) correct();  // of irradiance alone
    return std::move(out_);
  }

 private:
  void add_point(size_t pixel, LitPoints* out) const {
    out->position.push_back(hits_.position[pixel]);
    out->normal.push_back(hits_.normal[pixel]);
    out->pixel.push_back(pixel);
  }

  /// What earlier pictures know of this one's grid.
  void take_kept() {
    shared_.emplace(SharedPicture{of_.kept, *of_.projection, of_.first_row, kept_kind(), grid_,
                                  surfaces_, layers_});
  }

  bool is_new(size_t on_grid) const { return !shared_ || shared_->is_new(on_grid); }

  KeptKind kept_kind() const {
    KeptKind kind;
    kind.direct = direct_.shadow_rays > 0;
    kind.sum = kind.direct && direct_.sum;
    kind.gather_rays = settings_.rays;
    kind.shadow_rays = direct_.shadow_rays;
    return kind;
  }

  /// Pixels of the grid that reflect light and are not known, tile by tile.
  LitPoints grid_points() const {
    LitPoints out;
    out.reserve(grid_.size());
    const TileRect all = grid_.all();
    for (int tile_y = 0; tile_y < all.bottom; tile_y += kTile) {
      for (int tile_x = 0; tile_x < all.right; tile_x += kTile) {
        for (int j = tile_y; j < std::min(tile_y + kTile, all.bottom); ++j) {
          for (int i = tile_x; i < std::min(tile_x + kTile, all.right); ++i) {
            const size_t pixel = grid_.pixel(i, j);
            if (reflects_[pixel] && is_new(grid_.index(i, j))) add_point(pixel, &out);
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
    if (!settings_.check || points.size() <= kCheckedPoints)
      return sample_block(points, rays, stream, first_index);
    std::vector<size_t> block;
    for (size_t begin = 0; begin < points.size(); begin += kCheckedPoints) {
      settings_.check();
      block.resize(std::min(kCheckedPoints, points.size() - begin));
      std::iota(block.begin(), block.end(), begin);
      sample_block(points.some(block), rays, stream, first_index + static_cast<int64_t>(begin));
    }
  }

  void sample_block(const LitPoints& points, const LightRays& rays, uint64_t stream,
                    int64_t first_index) {
    GatherScene scene = scene_;
    scene.seed = hash_combine(scene_.seed, stream);
    const PointLight light = light_points(scene, points, rays, first_index, &out_.work);
    for (size_t k = 0; k < points.size(); ++k) {
      const size_t pixel = points.pixel[k];
      if (direct_.shadow_rays > 0 && direct_.sum) {
        layers_[0][pixel] = light.indirect[k] + light.direct[k];
        continue;
      }
      layers_[0][pixel] = light.indirect[k];
      if (direct_.shadow_rays > 0) layers_[1][pixel] = light.direct[k];
    }
  }

  /// Takes noise away from what is new in a part of the grid. What reflects nothing has no normal,
  /// like background.
  void denoise(const TileRect& inner) {
    const TileRect part = grid_.around(inner, KeptGrid::kAround);
    const Image black(part.right - part.left, part.bottom - part.top, 3);
    Image normal = black, position = black;
    grid_.for_part(part, [&](size_t small, size_t, size_t pixel) {
      if (!reflects_[pixel]) return;
      normal.set_rgb(small, hits_.normal[pixel]);
      position.set_rgb(small, hits_.position[pixel]);
    });
    const auto is_inner = [&](size_t on_grid) {
      return inner.contains(grid_.column_of(on_grid), grid_.row_of(on_grid));
    };
    for (const std::span<Rgb> layer : layers_) {
      Image light = black;
      grid_.for_part(part, [&](size_t small, size_t, size_t pixel) {
        if (reflects_[pixel]) light.set_rgb(small, layer[pixel]);
      });
      const Image clean =
          denoiser_->denoise({&light, &normal, &position, nullptr, nullptr}, settings_.quality);
      grid_.for_part(part, [&](size_t small, size_t on_grid, size_t pixel) {
        if (reflects_[pixel] && is_new(on_grid) && is_inner(on_grid))
          layer[pixel] = clean.rgb(small);
      });
    }
  }

  /// The pixels between those of the grid.
  void fill() {
    const Timer timer;
    std::vector<int32_t> open;  // where surfaces decide alone: the same in all layers
    for (const std::span<Rgb> layer : layers_) {
      std::vector<uint8_t> known(reflects_.size());
      grid_.for_all([&](size_t, size_t pixel) { known[pixel] = reflects_[pixel]; });
      open = gi::upsample(surfaces_, settings_.step, known, layer);
    }
    out_.fill_seconds += timer.seconds();
    light_alone(std::move(open));
  }

  /// Pixels that no point of the grid stands for: some of them answer for those around, too.
  void light_alone(std::vector<int32_t> open) {
    std::vector<uint8_t> answered(reflects_.size());
    int hint = -1;
    std::erase_if(open, [&](int32_t pixel) {
      const auto at = static_cast<size_t>(pixel);
      const auto found = shared_ ? shared_->find(at, &hint) : std::nullopt;
      for (size_t k = 0; found && k < layers_.size(); ++k) layers_[k][at] = found->value(k);
      if (found) answered[at] = 1;
      return found.has_value();
    });
    const auto answer = [&](const std::vector<int32_t>& pixels, uint64_t stream) {
      LitPoints points;
      points.reserve(pixels.size());
      for (const int32_t pixel : pixels) {
        add_point(static_cast<size_t>(pixel), &points);
        answered[static_cast<size_t>(pixel)] = 1;
      }
      const auto alone = [](int count) { return count > 0 ? std::max(count, kLeastAloneRays) : 0; };
      sample(points, {alone(settings_.rays), alone(direct_.shadow_rays)}, stream, 0);
    };
    answer(gi::first_of_blocks(surfaces_, open, kAloneBlock), kAlone);
    answer(gi::share_answers(surfaces_, open, answered, kAloneRadius, layers_), kStillAlone);
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
      if (reflects_[i]) add_point(i, &points);
    }
    const gi::RadiosityTable none(scene_.bvh, {}, {});
    std::array<Image, 2> half;
    LightWork work;
    for (uint64_t h = 0; h < 2; ++h) {
      half[h] = Image(hits_.width, hits_.height, 3);
      const PointLight light =
          light_points({scene_.bvh, scene_.lights, none, scene_.max_depth,
                        hash_combine(hash_combine(scene_.seed, kHalves), h)},
                       points, {std::max(1, correction_paths_ / 2), 0}, 0, &work);
      for (size_t k = 0; k < points.size(); ++k)
        half[h].set_rgb(points.pixel[k], light.indirect[k]);
    }
    out_.path_seconds = timer.seconds();
    timer.restart();
    out_.indirect = correct_by_paths(guides_of(hits_), reflects_, out_.indirect, half[0], half[1]);
    out_.denoise_seconds += timer.seconds();
  }

  const GatherScene& scene_;
  const GatherRows& of_;
  const pathtrace::GBuffer& hits_;
  const GatherSettings& settings_;
  const GatherDirect& direct_;
  const int correction_paths_;
  const image::Denoiser* denoiser_;
  PictureGrid grid_;
  gi::PixelSurfaces surfaces_;
  std::vector<uint8_t> reflects_;
  GatheredCentres out_;
  /// Light of each kind that is wanted, a pixel each; views of out_.
  std::vector<std::span<Rgb>> layers_;
  std::optional<KeptGrid> shared_;  ///< where pictures share light
};

}  // namespace

void check_gather_settings(const GatherSettings& settings) {
  const int step = settings.step;
  LTE_CHECK(settings.rays >= 1, "gather: rays must be at least 1, got ", settings.rays);
  LTE_CHECK(step >= 1 && step <= 64 && (step & (step - 1)) == 0,
            "gather: step must be a power of two up to 64, got ", step);
}

GatheredCentres gather_centres(const GatherScene& scene, const GatherRows& rows,
                               const GatherSettings& settings, const GatherDirect& direct,
                               int correction_paths, const image::Denoiser* denoiser) {
  check_gather_settings(settings);
  return Gatherer(scene, rows, settings, direct, correction_paths, denoiser).run();
}

}  // namespace lte::infer
