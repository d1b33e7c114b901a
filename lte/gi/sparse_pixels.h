// Irradiance of a picture from answers at few of its pixels.
//
// The pixels form a quadtree: the grids of upsample.h are its levels. The coarsest is answered as
// a whole. A pixel that is new on a finer one is asked about only where
// - no answered pixel around it lies on its surface, or those that do lie to one side while the
//   grid is still coarse (edges);
// - it is near a contact, or the caller wants it;
// - the answers at a corner of its cell, one level before, were not what their own neighbours had
//   predicted.
// Everything else keeps its prediction, which finer levels build on.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "lte/gi/pixel_surfaces.h"

namespace lte::gi {

/// A surface point whose irradiance is asked for.
struct Query {
  Vec3 position, normal;
  Rgb albedo;
};

/// Answers queries, W/m², an entry each. Every call has the pixels of one level.
using Answerer = std::function<std::vector<Rgb>(std::span<const Query>)>;

struct SparseOptions {
  /// Step of the grid that is answered as a whole: 8 is 1/64 of the pixels. A power of two.
  int step = 8;
  /// From this step on down a pixel may take the answers of one side alone. A power of two, or 0
  /// for never: then every pixel at an edge is answered.
  int edge_step = 2;
  /// A level is refined where an answer and its prediction differ by more than this share of the
  /// answer and a tenth of the picture's mean. 0: everywhere; INFINITY: nowhere.
  float tolerance = 0.05f;
  /// Every pixel so near to a contact is answered, in pixels (contacts.h); −1 for none.
  int contact_radius = 0;
  /// Asked before each level: true ends the refinement. Pixels on surfaces without any answer are
  /// still answered. May be null.
  std::function<bool()> stop;
};

/// @throws lte::Error naming the option that is out of range.
void check_sparse_options(const SparseOptions& options);

struct SparseAnswers {
  std::vector<Rgb> irradiance;    ///< per pixel, 0 outside of the mask
  std::vector<uint8_t> answered;  ///< per pixel, 1 where it is an answer and no mean of some
  int64_t answers = 0;
};

/// Answers the pixels of the mask.
///
/// @param albedo  per pixel, handed on with queries
/// @param wanted  per pixel, not 0 where an answer is wanted in any case; may be empty
/// @throws lte::Error if sizes differ, an option is out of range, or `answer` gives another number
///         of values than it was asked for.
/// @note The same for any number of threads. Memory: some 20 bytes a pixel.
SparseAnswers answer_sparsely(const PixelSurfaces& surfaces, std::span<const Rgb> albedo,
                              std::span<const uint8_t> wanted, const SparseOptions& options,
                              const Answerer& answer);

}  // namespace lte::gi
