// Paths through whole pixels in two independent halves, more of them from pass to pass: the
// reference of a picture, as far as time or a count of paths has it.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "infer/picture/antialias.h"
#include "lte/pathtrace/render.h"

namespace lte::infer {

class PixelPaths {
 public:
  /// All that is given must outlive it. @param rows  of the picture, that are traced
  PixelPaths(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
             const scene::Camera& camera, const PictureRows& rows, int max_depth, uint64_t seed);

  /// Traces `paths` more in both halves.
  /// @param pixels  of these rows, numbered from the first of them on
  void add(std::span<const int64_t> pixels, int paths);

  /// The means of both halves, after which there is nothing left to add to. A pixel without paths
  /// is black.
  std::array<pathtrace::RadianceLayers, 2> take();

  /// Paths of each pixel in either half.
  const std::vector<int32_t>& paths() const { return paths_; }
  /// A pixel in both halves, on average.
  double mean_paths() const;

 private:
  const pathtrace::Bvh& bvh_;
  const pathtrace::Lights& lights_;
  const scene::Camera& camera_;
  const PictureRows rows_;
  const int max_depth_;
  const uint64_t seed_;
  uint64_t passes_ = 0;
  std::array<pathtrace::RadianceLayers, 2> halves_;  ///< sums over paths
  std::vector<int32_t> paths_;
};

}  // namespace lte::infer
