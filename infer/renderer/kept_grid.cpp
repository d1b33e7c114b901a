#include "infer/renderer/kept_grid.h"

#include <algorithm>
#include <utility>

namespace lte::infer {
namespace {

// Points along a tile; it is denoised where one in so many of its points at least is new.
constexpr int kTile = 32, kMuchNew = 4;
// Points to each side whose mean new points in other tiles take, and how many of them one from an
// earlier picture counts for.
constexpr int kWindow = 3;
constexpr float kKnownWeight = 4;
constexpr int64_t kRows = 8, kPoints = 256;  // that a thread takes at a time

}  // namespace

KeptGrid::KeptGrid(const SharedPicture& picture)
    : of_(picture),
      view_(picture.projection, picture.first_row, picture.grid.columns, picture.grid.rows,
            picture.surfaces.pixel_size) {
  view_.kind = picture.kind;
  take();
  mark_new();
}

std::optional<KeptViews::Found> KeptGrid::find(size_t pixel, int* hint) const {
  const gi::PixelSurfaces& surfaces = of_.surfaces;
  const float extent =
      surfaces.depth[pixel] * surfaces.pixel_size * static_cast<float>(of_.grid.columns.step);
  return of_.kept->find(gi::point_of(surfaces, pixel), extent, of_.kind, hint);
}

/// A row begins without a hint, so that nothing depends on how rows are shared out.
void KeptGrid::take() {
  const PictureGrid& grid = of_.grid;
  const gi::PixelSurfaces& surfaces = of_.surfaces;
  parallel_for(grid.rows.count(), kRows, [&](int64_t begin, int64_t end) {
    for (auto row = static_cast<int>(begin); row < static_cast<int>(end); ++row) {
      int hint = -1;
      for (int column = 0; column < grid.columns.count(); ++column) {
        const size_t pixel = grid.pixel(column, row);
        if (!surfaces.mask[pixel]) continue;
        const size_t at = grid.index(column, row);
        view_.mask[at] = 1;
        view_.position[at] = surfaces.position[pixel];
        view_.normal[at] = surfaces.normal[pixel];
        view_.depth[at] = surfaces.depth[pixel];
        const auto found = find(pixel, &hint);
        if (!found) continue;
        view_.steps[at] = found->steps;
        for (size_t k = 0; k < of_.layers.size(); ++k) of_.layers[k][pixel] = found->value(k);
      }
    }
  });
}

void KeptGrid::mark_new() {
  const PictureGrid& grid = of_.grid;
  tile_columns_ = (grid.columns.count() + kTile - 1) / kTile;
  const int tile_rows = (grid.rows.count() + kTile - 1) / kTile;
  struct Points {
    int lit = 0, fresh = 0;
  };
  std::vector<Points> tiles(static_cast<size_t>(tile_columns_) * static_cast<size_t>(tile_rows));
  for (size_t at = 0; at < grid.size(); ++at) {
    Points& tile = tiles[tile_index(at)];
    tile.lit += view_.mask[at];
    tile.fresh += view_.mask[at] && is_new(at) ? 1 : 0;
  }
  much_new_.resize(tiles.size());
  std::transform(tiles.begin(), tiles.end(), much_new_.begin(), [](const Points& tile) {
    return tile.fresh > 0 && kMuchNew * tile.fresh >= tile.lit ? 1 : 0;
  });
}

size_t KeptGrid::tile_index(size_t on_grid) const {
  const int column = of_.grid.column_of(on_grid), row = of_.grid.row_of(on_grid);
  return static_cast<size_t>(row / kTile) * static_cast<size_t>(tile_columns_) +
         static_cast<size_t>(column / kTile);
}

bool KeptGrid::is_scattered(size_t on_grid) const {
  return view_.mask[on_grid] && is_new(on_grid) && !much_new_[tile_index(on_grid)];
}

std::vector<TileRect> KeptGrid::noisy_parts() const {
  const TileRect all = of_.grid.all();
  const int tile_rows = static_cast<int>(much_new_.size()) / tile_columns_;
  std::vector<TileRect> parts = cover_tiles(much_new_, tile_columns_, tile_rows);
  int64_t seen = 0;
  for (TileRect& part : parts) {
    part = {part.left * kTile, part.top * kTile, std::min(all.right, part.right * kTile),
            std::min(all.bottom, part.bottom * kTile)};
    seen += of_.grid.around(part, kAround).size();
  }
  return seen < all.size() ? parts : std::vector<TileRect>{all};
}

/// @param mean  [layers], 0 so far
void KeptGrid::mean_around(size_t on_grid, std::span<Rgb> mean) const {
  const PictureGrid& grid = of_.grid;
  const gi::PixelSurfaces points = view_.surfaces();
  const gi::SurfacePoint here = gi::point_of(points, on_grid);
  const int column = grid.column_of(on_grid), row = grid.row_of(on_grid);
  const TileRect window = grid.around({column, row, column + 1, row + 1}, kWindow);
  float sum = 0;
  for (int j = window.top; j < window.bottom; ++j) {
    for (int i = window.left; i < window.right; ++i) {
      const size_t other = grid.index(i, j);
      const float known = is_new(other) ? 1 : kKnownWeight;
      const float weight = view_.mask[other] ? known * gi::similarity(points, here, other) : 0;
      sum += weight;
      for (size_t k = 0; k < mean.size() && weight > 0; ++k)
        mean[k] += of_.layers[k][grid.pixel(i, j)] * weight;
    }
  }
  for (Rgb& value : mean) value = value / sum;
}

void KeptGrid::smooth_scattered() {
  std::vector<size_t> scattered;
  for (size_t at = 0; at < of_.grid.size(); ++at) {
    if (is_scattered(at)) scattered.push_back(at);
  }
  const size_t layers = of_.layers.size();
  std::vector<Rgb> means(scattered.size() * layers);
  parallel_for(static_cast<int64_t>(scattered.size()), kPoints, [&](int64_t begin, int64_t end) {
    for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i)
      mean_around(scattered[i], std::span(means).subspan(i * layers, layers));
  });
  for (size_t i = 0; i < scattered.size(); ++i) {
    const size_t pixel =
        of_.grid.pixel(of_.grid.column_of(scattered[i]), of_.grid.row_of(scattered[i]));
    for (size_t k = 0; k < layers; ++k) of_.layers[k][pixel] = means[i * layers + k];
  }
}

void KeptGrid::keep() {
  view_.values.assign(of_.layers.size(), std::vector<Rgb>(of_.grid.size()));
  of_.grid.for_all([&](size_t at, size_t pixel) {
    for (size_t k = 0; k < of_.layers.size(); ++k) view_.values[k][at] = of_.layers[k][pixel];
  });
  of_.kept->add(std::move(view_));
}

}  // namespace lte::infer
