#include "infer/renderer/gathered_light.h"

#include <algorithm>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "infer/picture/picture_band.h"
#include "infer/picture/surface_guides.h"
#include "infer/renderer/path_correction.h"
#include "infer/renderer/tile_cover.h"
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
// Of the grid, where pictures share light: tiles that are denoised, of whose points one in so
// many at least is new, and what the denoiser sees around them.
constexpr int kNoisyTile = 32, kMuchNew = 4, kAround = 16;
// Points to each side whose mean new points in other tiles take, and how many of them one from an
// earlier picture counts for.
constexpr int kWindow = 3;
constexpr float kKnownWeight = 4;
// Of pixels that stand alone one in each block of so many squared is asked, and its answer goes so
// far.
constexpr int kAloneBlock = 2, kAloneRadius = 3;
// What a thread takes at a time.
constexpr int64_t kPixels = 1 << 14, kRows = 8;
constexpr size_t kPacedPoints = 1 << 13;  // whose rays a pace chooses at once
// Rays at the grid, of pixels that stand alone and of the two halves of the correcting paths are
// independent of each other, and of direct light's.
constexpr uint64_t kGather = 31, kAlone = 32, kHalves = 33, kStillAlone = 34;

/// A view whose light is gathered.
class Gatherer {
 public:
  Gatherer(const GatherScene& scene, const GatherRows& rows, const GatherSettings& settings,
           const GatherDirect& direct, const image::Denoiser* denoiser)
      : scene_(scene),
        of_(rows),
        hits_(rows.hits),
        settings_(settings),
        direct_(direct),
        denoiser_(denoiser),
        columns_(settings.step, hits_.width),
        rows_(settings.step, hits_.height),
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
    layers_.push_back({sum ? &out_.total : &out_.indirect, {}});
    if (direct.shadow_rays > 0 && !sum) layers_.push_back({&out_.direct, {}});
    for (Layer& layer : layers_) {
      *layer.out = Image(hits_.width, hits_.height, 3);
      layer.values = image::rgb_view(*layer.out);
    }
  }

  GatheredCentres run() {
    Timer timer;
    if (of_.kept != nullptr) {
      take_kept();
      mark_new();
    }
    out_.fill_seconds = timer.seconds();
    sample_grid();
    timer.restart();
    if (denoiser_ != nullptr) {
      for (const TileRect& part : noisy_parts()) denoise(part);
      if (view_) smooth_scattered();
    }
    out_.denoise_seconds = timer.seconds();
    timer.restart();
    if (of_.kept != nullptr) keep();
    out_.fill_seconds += timer.seconds();
    if (settings_.step > 1) fill();
    if (settings_.paths > 0) correct();  // of irradiance alone
    return std::move(out_);
  }

 private:
  /// Light of one kind, 0 where none is reflected.
  struct Layer {
    Image* out;
    std::span<Rgb> values;  ///< of out
  };

  void add_point(size_t pixel, LitPoints* out) const {
    out->position.push_back(hits_.position[pixel]);
    out->normal.push_back(hits_.normal[pixel]);
    out->pixel.push_back(pixel);
  }

  /// Takes what earlier pictures know of the grid. A row begins without a hint, so that nothing
  /// depends on how rows are shared out.
  void take_kept() {
    KeptView& view =
        view_.emplace(*of_.projection, of_.first_row, columns_, rows_, surfaces_.pixel_size);
    view.kind = kept_kind();
    parallel_for(rows_.count(), kRows, [&](int64_t begin, int64_t end) {
      for (auto row = static_cast<int>(begin); row < static_cast<int>(end); ++row) {
        int hint = -1;
        for (int column = 0; column < columns_.count(); ++column) {
          const size_t pixel = surfaces_.at(columns_.at(column), rows_.at(row));
          if (!reflects_[pixel]) continue;
          const size_t at = grid_index(column, row);
          view.mask[at] = 1;
          view.position[at] = hits_.position[pixel];
          view.normal[at] = hits_.normal[pixel];
          view.depth[at] = hits_.depth[pixel];
          const auto found = find_kept(pixel, &hint);
          if (!found) continue;
          view.steps[at] = found->steps;
          for (size_t k = 0; k < layers_.size(); ++k) layers_[k].values[pixel] = found->value(k);
        }
      }
    });
  }

  std::optional<KeptViews::Found> find_kept(size_t pixel, int* hint) const {
    const float extent =
        hits_.depth[pixel] * surfaces_.pixel_size * static_cast<float>(settings_.step);
    return of_.kept->find(gi::point_of(surfaces_, pixel), extent, kept_kind(), hint);
  }

  /// For later pictures.
  void keep() {
    view_->values.assign(layers_.size(), std::vector<Rgb>(grid_size()));
    for_grid([&](size_t small, size_t pixel) {
      for (size_t k = 0; k < layers_.size(); ++k)
        view_->values[k][small] = layers_[k].values[pixel];
    });
    of_.kept->add(std::move(*view_));
  }

  bool is_new(size_t on_grid) const { return !view_ || view_->steps[on_grid] == 0; }

  /// Whether it is a new point in a tile of few.
  bool is_scattered(size_t on_grid) const {
    const auto width = static_cast<size_t>(columns_.count());
    return view_ && view_->mask[on_grid] && is_new(on_grid) &&
           !much_new_[tile_index(static_cast<int>(on_grid % width),
                                 static_cast<int>(on_grid / width))];
  }

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
    out.reserve(grid_size());
    for (int tile_y = 0; tile_y < rows_.count(); tile_y += kTile) {
      for (int tile_x = 0; tile_x < columns_.count(); tile_x += kTile) {
        for (int j = tile_y; j < std::min(tile_y + kTile, rows_.count()); ++j) {
          for (int i = tile_x; i < std::min(tile_x + kTile, columns_.count()); ++i) {
            const size_t pixel = surfaces_.at(columns_.at(i), rows_.at(j));
            if (reflects_[pixel] && is_new(grid_index(i, j))) add_point(pixel, &out);
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

  /// Tiles of the grid in which much is new, where pictures share light.
  void mark_new() {
    tile_columns_ = (columns_.count() + kNoisyTile - 1) / kNoisyTile;
    const int tile_rows = (rows_.count() + kNoisyTile - 1) / kNoisyTile;
    struct Points {
      int lit = 0, fresh = 0;
    };
    std::vector<Points> tiles(static_cast<size_t>(tile_columns_) * static_cast<size_t>(tile_rows));
    for (int row = 0; row < rows_.count(); ++row) {
      for (int column = 0; column < columns_.count(); ++column) {
        const size_t at = grid_index(column, row);
        Points& tile = tiles[tile_index(column, row)];
        tile.lit += view_->mask[at];
        tile.fresh += view_->mask[at] && view_->steps[at] == 0 ? 1 : 0;
      }
    }
    much_new_.resize(tiles.size());
    std::transform(tiles.begin(), tiles.end(), much_new_.begin(), [](const Points& tile) {
      return tile.fresh > 0 && kMuchNew * tile.fresh >= tile.lit ? 1 : 0;
    });
  }

  size_t tile_index(int column, int row) const {
    return static_cast<size_t>(row / kNoisyTile) * static_cast<size_t>(tile_columns_) +
           static_cast<size_t>(column / kNoisyTile);
  }

  /// What is denoised: all of the grid, or where pictures share light the tiles in which much is
  /// new.
  std::vector<TileRect> noisy_parts() const {
    const TileRect all{0, 0, columns_.count(), rows_.count()};
    if (!view_) return {all};
    const int tile_rows = static_cast<int>(much_new_.size()) / tile_columns_;
    std::vector<TileRect> parts = cover_tiles(much_new_, tile_columns_, tile_rows);
    int64_t seen = 0;
    for (TileRect& part : parts) {
      part = {part.left * kNoisyTile, part.top * kNoisyTile,
              std::min(all.right, part.right * kNoisyTile),
              std::min(all.bottom, part.bottom * kNoisyTile)};
      seen += with_surroundings(part).size();
    }
    return seen < all.size() ? parts : std::vector<TileRect>{all};
  }

  /// With what the denoiser sees around it.
  TileRect with_surroundings(const TileRect& part) const {
    return {std::max(0, part.left - kAround), std::max(0, part.top - kAround),
            std::min(columns_.count(), part.right + kAround),
            std::min(rows_.count(), part.bottom + kAround)};
  }

  /// Takes noise away from what is new in a part of the grid. What reflects nothing has no normal,
  /// like background.
  void denoise(const TileRect& inner) {
    const TileRect part = with_surroundings(inner);
    const Image black(part.right - part.left, part.bottom - part.top, 3);
    Image normal = black, position = black;
    for_part(part, [&](size_t small, size_t, size_t pixel) {
      if (!reflects_[pixel]) return;
      normal.set_rgb(small, hits_.normal[pixel]);
      position.set_rgb(small, hits_.position[pixel]);
    });
    const auto width = static_cast<size_t>(columns_.count());
    const auto is_inner = [&](size_t on_grid) {
      return inner.contains(static_cast<int>(on_grid % width), static_cast<int>(on_grid / width));
    };
    for (Layer& layer : layers_) {
      Image light = black;
      for_part(part, [&](size_t small, size_t, size_t pixel) {
        if (reflects_[pixel]) light.set_rgb(small, layer.values[pixel]);
      });
      const Image clean =
          denoiser_->denoise({&light, &normal, &position, nullptr, nullptr}, settings_.quality);
      for_part(part, [&](size_t small, size_t on_grid, size_t pixel) {
        if (reflects_[pixel] && is_new(on_grid) && is_inner(on_grid))
          layer.values[pixel] = clean.rgb(small);
      });
    }
  }

  /// New points in tiles of few take means over the points around them, of which those from earlier
  /// pictures are without noise. Open Image Denoise would take the noise of a narrow strip between
  /// such points for texture, and it would stay on its surface.
  void smooth_scattered() {
    const gi::PixelSurfaces points = view_->surfaces();
    std::vector<std::vector<Rgb>> smooth(layers_.size(), std::vector<Rgb>(grid_size()));
    for_grid([&](size_t at, size_t) {
      if (!is_scattered(at)) return;
      const gi::SurfacePoint here = gi::point_of(points, at);
      const auto column = static_cast<int>(at % static_cast<size_t>(points.width)),
                 row = static_cast<int>(at / static_cast<size_t>(points.width));
      float sum = 0;
      for (int j = std::max(0, row - kWindow); j <= std::min(row + kWindow, points.height - 1);
           ++j) {
        for (int i = std::max(0, column - kWindow);
             i <= std::min(column + kWindow, points.width - 1); ++i) {
          const size_t other = grid_index(i, j);
          const float known = is_new(other) ? 1 : kKnownWeight;
          const float weight = view_->mask[other] ? known * gi::similarity(points, here, other) : 0;
          sum += weight;
          const size_t pixel = surfaces_.at(columns_.at(i), rows_.at(j));
          for (size_t k = 0; k < layers_.size() && weight > 0; ++k)
            smooth[k][at] += layers_[k].values[pixel] * weight;
        }
      }
      for (size_t k = 0; k < layers_.size(); ++k) smooth[k][at] = smooth[k][at] / sum;
    });
    for_grid([&](size_t at, size_t pixel) {
      for (size_t k = 0; k < layers_.size() && is_scattered(at); ++k)
        layers_[k].values[pixel] = smooth[k][at];
    });
  }

  /// Calls use(number in the part, number on the grid, pixel) for all of it, in several threads.
  template <typename Use>
  void for_part(const TileRect& part, const Use& use) const {
    parallel_for(part.bottom - part.top, kRows, [&](int64_t begin, int64_t end) {
      for (int j = part.top + static_cast<int>(begin); j < part.top + static_cast<int>(end); ++j) {
        size_t small =
            static_cast<size_t>(j - part.top) * static_cast<size_t>(part.right - part.left);
        for (int i = part.left; i < part.right; ++i)
          use(small++, grid_index(i, j), surfaces_.at(columns_.at(i), rows_.at(j)));
      }
    });
  }

  size_t grid_index(int column, int row) const {
    return static_cast<size_t>(row) * static_cast<size_t>(columns_.count()) +
           static_cast<size_t>(column);
  }

  size_t grid_size() const {
    return static_cast<size_t>(columns_.count()) * static_cast<size_t>(rows_.count());
  }

  /// Calls use(number on the grid, pixel) for all of the grid, in several threads.
  template <typename Use>
  void for_grid(const Use& use) const {
    for_part({0, 0, columns_.count(), rows_.count()},
             [&](size_t, size_t on_grid, size_t pixel) { use(on_grid, pixel); });
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
    out_.fill_seconds += timer.seconds();
    light_alone(std::move(open));
  }

  /// Pixels that no point of the grid stands for: some of them answer for those around, too.
  void light_alone(std::vector<int32_t> open) {
    std::vector<uint8_t> answered(reflects_.size());
    int hint = -1;
    std::erase_if(open, [&](int32_t pixel) {
      const auto at = static_cast<size_t>(pixel);
      const auto found = of_.kept != nullptr ? find_kept(at, &hint) : std::nullopt;
      for (size_t k = 0; found && k < layers_.size(); ++k) layers_[k].values[at] = found->value(k);
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
    std::vector<std::span<Rgb>> values;
    for (const Layer& layer : layers_) values.push_back(layer.values);
    answer(gi::share_answers(surfaces_, open, answered, kAloneRadius, values), kStillAlone);
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
  const GatherRows& of_;
  const pathtrace::GBuffer& hits_;
  const GatherSettings& settings_;
  const GatherDirect& direct_;
  const image::Denoiser* denoiser_;
  gi::GridAxis columns_, rows_;
  gi::PixelSurfaces surfaces_;
  std::vector<uint8_t> reflects_;
  std::optional<KeptView> view_;   ///< of this picture, where light is kept
  std::vector<uint8_t> much_new_;  ///< tiles of kNoisyTile² points of the grid, by tile_index()
  int tile_columns_ = 0;
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

GatheredCentres gather_centres(const GatherScene& scene, const GatherRows& rows,
                               const GatherSettings& settings, const GatherDirect& direct,
                               const image::Denoiser* denoiser) {
  check_gather_settings(settings);
  return Gatherer(scene, rows, settings, direct, denoiser).run();
}

}  // namespace lte::infer
