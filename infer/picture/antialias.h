// Anti-aliasing: several primary hits in the pixels at edges, which share the answers that pixels
// ask for anyway.
//
// A pixel lies at an edge where one of the four beside it sees something else: background, another
// instance, another plane, normal, color, emission or share of metal. There N image points are
// traced, a stratified set that is turned by a hash of the pixel. Half of them, but four at least,
// come first: where all of them see what the centre sees and no lamp is near, the edge lies in the
// neighbour, and the others are left out. Each takes the irradiance of the nearest query that
// stands on its plane and under its normal: its own pixel's, or one of the eight around it. Where
// none does, it becomes a query itself, which later points of this and of the neighbouring pixels
// that found none share in turn.
//
// A lamp shines a hundred times as bright as what is beside it, so what share of a pixel it has is
// most of a picture's squared error. Pixels near a lamp, and others whose hits shine unlike, get
// lamp_hits() for their emission alone.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lte/pathtrace/gbuffer.h"

namespace lte::infer {

/// Surface points that are asked for irradiance.
struct QuerySet {
  std::vector<Vec3> position, normal;
  std::vector<Rgb> albedo;

  int64_t size() const { return static_cast<int64_t>(position.size()); }
  void resize(size_t count) {
    position.resize(count);
    normal.resize(count);
    albedo.resize(count);
  }
  void put(size_t query, const pathtrace::GBuffer& hits, size_t index) {
    position[query] = hits.position[index];
    normal[query] = hits.normal[index];
    albedo[query] = hits.albedo[index];
  }
  void add(const pathtrace::GBuffer& hits, size_t index) {
    position.push_back(hits.position[index]);
    normal.push_back(hits.normal[index]);
    albedo.push_back(hits.albedo[index]);
  }
};

/// Rows of a picture that are worked on at once.
struct PictureRows {
  int width = 0, height = 0;  ///< of the picture
  int first = 0, last = 0;    ///< rows
};

/// What anti-aliasing looks at. Pixels are numbered from the first of `rows` on.
struct EdgeView {
  const pathtrace::GBuffer& hits;  ///< of `rows`, at least
  PictureRows rows;
  float pixel_size = 0;  ///< edge of what a pixel covers at depth 1, in metres
  size_t first = 0;      ///< of hits: the first pixel of `rows`

  int width() const { return rows.width; }
  int height() const { return rows.last - rows.first; }
};

/// The pixels of `view` that lie at an edge, in order. On the diagonals only lamps count, whose
/// corners do. Else they are not needed: where a straight edge parts a pixel, the centre of one of
/// the four beside it lies on the other side, as of cos θ and sin θ one is at least
/// (cos θ + sin θ) / 2, the farthest that a corner lies from the centre across an edge under θ.
std::vector<int32_t> find_edges(const EdgeView& view);

/// Hits inside edge pixels, of which each has `few` or `many`.
struct SubHits {
  std::vector<int32_t> pixel;  ///< of the rows, in order
  int few = 0, many = 0;
  std::vector<int32_t> more;    ///< by pixel: its place among those of many, kNone if it has few
  pathtrace::GBuffer hits;      ///< in one row: the first few of all pixels, then those that follow
  std::vector<int32_t> source;  ///< the query that answers, kNone where nothing is reflected
  std::vector<Rgb> emission;    ///< by pixel: the mean, of further hits where a lamp may be

  int count(size_t entry) const { return more[entry] == scene::kNone ? few : many; }
  /// Calls use(place in hits) for those of a pixel.
  template <typename Use>
  void each(size_t entry, const Use& use) const {
    const auto first = static_cast<size_t>(few), others = static_cast<size_t>(many - few);
    for (size_t s = entry * first; s < (entry + 1) * first; ++s) use(s);
    if (more[entry] == scene::kNone) return;
    const size_t begin = pixel.size() * first + static_cast<size_t>(more[entry]) * others;
    for (size_t s = begin; s < begin + others; ++s) use(s);
  }
};

/// Hits for the emission of a pixel that a lamp may have a share of, where others have `many`.
constexpr int lamp_hits(int many) { return 2 * many * many; }

/// Traces up to `many` points in each of `pixels` of the view, and lamp_hits() for emission: `many`
/// for 32 pixels of the view in all, at most.
SubHits trace_sub_hits(const pathtrace::Bvh& bvh, const scene::Camera& camera, const EdgeView& view,
                       std::vector<int32_t> pixels, int many);

/// The numbers of queries.
struct PixelQueries {
  std::span<const int32_t> of_pixel;  ///< of each pixel of a view, kNone if it asks nothing
  int32_t first_listed = 0;           ///< of the first in the QuerySet
};

/// Finds the source of every sub-hit, and appends to `queries` those that no query answers.
void assign_sources(const EdgeView& view, const PixelQueries& asked, QuerySet* queries,
                    SubHits* sub);

}  // namespace lte::infer
