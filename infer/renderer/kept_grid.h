// The grid of a picture whose light others share: what earlier pictures know of it, which of its
// points are new, and what it tells later ones (kept_views.h).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "infer/picture/projection.h"
#include "infer/renderer/kept_views.h"
#include "infer/renderer/picture_grid.h"

namespace lte::infer {

/// A picture, or some of its rows. What is lent must outlive the grid.
struct SharedPicture {
  KeptViews* kept = nullptr;
  Projection projection;  ///< of the whole picture
  int first_row = 0;      ///< of the picture, that of the pixels
  KeptKind kind;
  const PictureGrid& grid;
  const gi::PixelSurfaces& surfaces;       ///< the mask: pixels that reflect light
  std::span<const std::span<Rgb>> layers;  ///< [layers][pixel]: light of each kind
};

class KeptGrid {
 public:
  /// Points to each side that the denoiser sees around what it denoises.
  static constexpr int kAround = 16;

  /// Takes what earlier pictures know of the grid into the layers.
  explicit KeptGrid(const SharedPicture& picture);

  /// Whether no earlier picture knows the light of a point.
  bool is_new(size_t on_grid) const { return view_.steps[on_grid] == 0; }

  /// Light of a pixel, which need not stand on the grid. @param hint  as that of KeptViews::find()
  std::optional<KeptViews::Found> find(size_t pixel, int* hint) const;

  /// What is denoised: the tiles in which much is new, or all where these are as much.
  std::vector<TileRect> noisy_parts() const;

  /// New points in tiles of few take means over the points around them, of which those from earlier
  /// pictures are without noise. Open Image Denoise would take the noise of a narrow strip between
  /// such points for texture, and it would stay on its surface.
  void smooth_scattered();

  /// Gives the light on the grid to later pictures, once.
  void keep();

 private:
  void take();
  void mark_new();
  size_t tile_index(size_t on_grid) const;
  bool is_scattered(size_t on_grid) const;
  void mean_around(size_t on_grid, std::span<Rgb> mean) const;

  SharedPicture of_;
  KeptView view_;                  ///< of this picture
  std::vector<uint8_t> much_new_;  ///< tiles of points of the grid, by tile_index()
  int tile_columns_ = 0;
};

}  // namespace lte::infer
