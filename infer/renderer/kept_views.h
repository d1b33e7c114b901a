// Light that earlier pictures of a scene have shown, found again where a further one shows the same
// surfaces: irradiance does not depend on who looks (reverse reprojection, Nehab et al. 2007).
//
// A picture keeps the points that it has asked for light, a grid of its pixels. A point of another
// picture is projected into it. Where the four points of the grid around that place lie on its
// surface, it takes what lies between them. Each such step softens light by half a distance of
// points, so a point rather takes what rays have found than what was taken itself.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "infer/picture/projection.h"
#include "lte/gi/upsample.h"

namespace lte::infer {

/// What was asked at the points of a picture. Only what is alike is taken.
struct KeptKind {
  bool direct = false, indirect = true;
  bool sum = false;  ///< both in one
  int gather_rays = 0, shadow_rays = 0;

  /// Whether light of this kind will do where `wanted` is.
  bool serves(const KeptKind& wanted) const;
};

/// A picture's points on a grid, or those of some of its rows. Arrays [rows * columns].
struct KeptView {
  KeptView(const Projection& picture, int top_row, const gi::GridAxis& grid_columns,
           const gi::GridAxis& grid_rows, float size_of_pixel);

  Projection projection;
  int first_row = 0;           ///< of the picture: row 0 of the grid's pixels
  gi::GridAxis columns, rows;  ///< pixels that stand on the grid
  float pixel_size = 0;        ///< edge of what a pixel covers at depth 1, in metres
  KeptKind kind;
  std::vector<Vec3> position, normal;
  std::vector<float> depth;
  std::vector<uint8_t> mask;  ///< 1 where there is light
  /// Taken from another view so many times; 0: rays found it. 255, once it is kept: no light.
  std::vector<uint8_t> steps;
  std::vector<std::vector<Rgb>> values;  ///< a layer each; as many as the kind has

  size_t size() const { return mask.size(); }
  /// The points as pixels of a small picture.
  gi::PixelSurfaces surfaces() const;
};

/// What was taken so many times is asked anew.
inline constexpr uint8_t kMostKeptSteps = 6;

class KeptViews {
 public:
  /// @param most  points that are kept at least; views from the oldest on are forgotten beyond them
  explicit KeptViews(int64_t most = int64_t{1} << 20);

  void add(KeptView view);

  /// Where the irradiance of a point is found.
  struct Found {
    const KeptView* view = nullptr;
    gi::Stencil around;  ///< weights sum up to 1
    uint8_t steps = 0;   ///< of it, this one included

    Rgb value(size_t layer) const;
  };

  /// Threads may ask at once.
  /// @param extent  metres that the point stands for: no view is asked whose points there stand for
  ///                much more
  /// @param hint    the view that served the point before, which is asked first; set to the one
  ///                that serves this. -1 for none
  std::optional<Found> find(const gi::SurfacePoint& point, float extent, const KeptKind& kind,
                            int* hint) const;

  int64_t points() const { return points_; }
  size_t views() const { return views_.size(); }

 private:
  int64_t most_, points_ = 0;
  std::deque<KeptView> views_;  ///< the newest last
};

}  // namespace lte::infer
