// Joint bilateral upsampling: irradiance at every pixel from that of some (Kopf et al. 2007).
//
// Pixels are filled level by level. The grid of a step has the pixels whose coordinates are
// multiples of it, and the last row and column. What is new on it lies on an edge or in the middle
// of a cell of twice the step, and takes the two or four corners around, weighted by how well they
// lie in its plane and under its normal. Weights are those of perspective: irradiance that is
// linear over a plane stays so.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "lte/gi/pixel_surfaces.h"

namespace lte::gi {

/// The corners around a pixel that is new on a grid.
struct Stencil {
  std::array<size_t, 4> pixel{};
  std::array<float, 4> weight{};  ///< bilinear, sum 1
  int count = 0;                  ///< 2 on an edge, 4 in the middle of a cell
};

/// What a stencil's known pixels say.
struct Prediction {
  Rgb value;
  bool any = false;       ///< a known pixel lies on this surface; without, `value` is zero
  bool complete = false;  ///< they lie to both sides, so that `value` is no extrapolation
};

/// @param known  per pixel, not 0 where `values` has irradiance
Prediction predict(const PixelSurfaces& surfaces, size_t pixel, const Stencil& stencil,
                   std::span<const uint8_t> known, std::span<const Rgb> values);

/// The coordinates of a grid along a side of `length` pixels.
struct GridAxis {
  int step, last;

  GridAxis(int grid_step, int length)
      : step(grid_step), last(length - 1), count_((last + step - 1) / step + 1) {}
  int count() const { return count_; }
  int at(int index) const { return index * step < last ? index * step : last; }
  /// Whether the grid of twice the step has it not.
  bool is_new(int index) const { return index % 2 == 1 && at(index) != last; }
  int before(int index) const { return is_new(index) ? at(index) - step : at(index); }
  int after(int index) const { return is_new(index) ? at(index + 1) : at(index); }

 private:
  int count_;
};

/// The stencil of the grid's place (column, row), of which one coordinate at least is new.
Stencil stencil_at(const PixelSurfaces& surfaces, const GridAxis& columns, const GridAxis& rows,
                   int column, int row);

/// The irradiance of the known pixels next to image point (x, y) that lie on the surface of
/// `point`: the mean over the nearest square ring that has any, by similarity. Nothing if none of
/// the rings up to `radius` has.
std::optional<Rgb> nearest_known(const PixelSurfaces& surfaces, int x, int y,
                                 const SurfacePoint& point, std::span<const uint8_t> known,
                                 std::span<const Rgb> values, int radius);

/// Fills the pixels of the mask that are not known from those that are, which keep every bit.
///
/// @param step    a power of two; known pixels lie on the grid of this step, or anywhere. What the
///                grids leave open takes the nearest known pixels, at most `step` away
/// @param known   per pixel, not 0 where `values` has irradiance; set where a pixel is filled
/// @param values  per pixel
/// @return  the pixels of the mask that no known pixel around stands for, in order: to be answered
/// @throws lte::Error if sizes differ or `step` is no power of two.
/// @note O(pixels), and the same for any number of threads.
std::vector<int32_t> upsample(const PixelSurfaces& surfaces, int step, std::span<uint8_t> known,
                              std::span<Rgb> values);

}  // namespace lte::gi
