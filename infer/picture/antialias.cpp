#include "infer/picture/antialias.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "infer/picture/hit_difference.h"
#include "lte/base/parallel.h"
#include "lte/base/random.h"

namespace lte::infer {
namespace {

// What may share an answer.
constexpr float kSharedNormal = 0.9f;  ///< cosine, 26°

constexpr std::pair<int, int> kAround[] = {{-1, -1}, {0, -1}, {1, -1}, {-1, 0},
                                           {1, 0},   {-1, 1}, {0, 1},  {1, 1}};

/// Those of them that come later, row by row.
constexpr std::array<std::pair<int, int>, 4> kAfter = {{{1, 0}, {-1, 1}, {0, 1}, {1, 1}}};
constexpr int64_t kRows = 2, kEntries = 128;  // that a thread takes at a time
// Hits of a pixel that come first: this share of all, but as many at least.
constexpr int kFewShare = 2, kFewestHits = 4;
// Hits for emission are so many at most, for each pixel of a view and each hit of one at an edge.
constexpr size_t kLampHitShare = 32;

/// Hammersley's points in the unit square. The first `few` are stratified by themselves: one in
/// each of as many columns, and in rows of their own as far as there are such.
std::vector<Vec2> stratified_points(int count, int few) {
  std::vector<Vec2> points(static_cast<size_t>(count));
  for (int i = 0; i < count; ++i) {
    float reversed = 0, digit = 0.5f;
    for (int bits = i; bits > 0; bits >>= 1) {
      if (bits & 1) reversed += digit;
      digit *= 0.5f;
    }
    points[static_cast<size_t>(i)] = {(static_cast<float>(i) + 0.5f) / static_cast<float>(count),
                                      reversed};
  }
  std::vector<uint8_t> row_is_taken(static_cast<size_t>(few));
  const auto row_of = [&](const Vec2& point) {
    return static_cast<size_t>(point.y * static_cast<float>(few));
  };
  for (int column = 0; column < few; ++column) {
    // What is chosen moves forward, what it passes back by one: later columns stay where they are.
    const auto first = points.begin() + column * count / few,
               end = points.begin() + (column + 1) * count / few;
    auto chosen =
        std::find_if(first, end, [&](const Vec2& point) { return !row_is_taken[row_of(point)]; });
    if (chosen == end) chosen = first;
    row_is_taken[row_of(*chosen)] = 1;
    std::rotate(points.begin() + column, chosen, chosen + 1);
  }
  return points;
}

/// Places within a pixel, turned by a hash of the pixel.
class PixelPoints {
 public:
  PixelPoints(int x, int y) : x_(static_cast<float>(x)), y_(static_cast<float>(y)) {
    Rng turn(static_cast<uint64_t>(y), static_cast<uint64_t>(x));
    turn_x_ = turn.uniform();
    turn_y_ = turn.uniform();
  }

  /// @param within  of the unit square
  Vec2 at(const Vec2& within) const {
    const float x = within.x + turn_x_, y = within.y + turn_y_;
    return {x_ + (x - std::floor(x)), y_ + (y - std::floor(y))};
  }

 private:
  float x_, y_, turn_x_ = 0, turn_y_ = 0;
};

/// Calls use(pixel) for those around a pixel that the view has.
template <typename Use>
void each_around(const EdgeView& view, int32_t pixel, const Use& use) {
  const int width = view.width(), x = pixel % width, y = pixel / width;
  for (const auto& [dx, dy] : kAround) {
    if (x + dx < 0 || x + dx >= width || y + dy < 0 || y + dy >= view.height()) continue;
    use(static_cast<size_t>(y + dy) * static_cast<size_t>(width) + static_cast<size_t>(x + dx));
  }
}

/// Finds the queries that answer the sub-hits of edge pixels.
class SourceFinder {
 public:
  SourceFinder(const EdgeView& view, const PixelQueries& asked, QuerySet* queries, SubHits* sub)
      : view_(view),
        asked_(asked),
        queries_(*queries),
        sub_(*sub),
        own_(sub->pixel.size() + 1),
        open_(sub->pixel.size()),
        entry_(asked.of_pixel.size(), scene::kNone) {
    for (size_t i = 0; i < sub->pixel.size(); ++i)
      entry_[static_cast<size_t>(sub->pixel[i])] = static_cast<int32_t>(i);
  }

  /// The nearest query of a pixel, the sub-hit's own or one of the eight around it. Entries do not
  /// touch each other.
  void find_pixels(size_t entry) {
    std::array<Candidate, 9> candidates;
    size_t count = 0;
    each_pixel_near(entry, [&](size_t pixel) {
      const int32_t query = asked_.of_pixel[pixel];
      const size_t hit = view_.first + pixel;
      if (query != scene::kNone)
        candidates[count++] = {view_.hits.position[hit], view_.hits.normal[hit], query};
    });
    sub_.each(entry, [&](size_t s) {
      if (!reflects(s)) return;
      sub_.source[s] = nearest(s, std::span(candidates).first(count));
      if (sub_.source[s] == scene::kNone) open_[entry] = 1;
    });
  }

  /// For sub-hits that found none: the nearest query that a sub-hit before has added, in this pixel
  /// or next to it, or one more. In the order of the entries.
  void find_or_add(size_t entry) {
    own_[entry] = own_[entry + 1] = static_cast<int32_t>(queries_.size());
    if (!open_[entry]) return;
    collect_added(entry);
    sub_.each(entry, [&](size_t s) {
      if (sub_.source[s] != scene::kNone || !reflects(s)) return;
      sub_.source[s] = nearest(s, added_);
      if (sub_.source[s] != scene::kNone) return;
      queries_.add(sub_.hits, s);
      added_.push_back(candidate(static_cast<int32_t>(queries_.size()) - 1));
      sub_.source[s] = added_.back().query;
    });
    own_[entry + 1] = static_cast<int32_t>(queries_.size());
  }

 private:
  struct Candidate {
    Vec3 position, normal;
    int32_t query = scene::kNone;
  };

  bool reflects(size_t s) const {
    return sub_.hits.mask[s] && max_component(sub_.hits.albedo[s]) > 0;
  }
  Candidate candidate(int32_t listed) const {
    const auto at = static_cast<size_t>(listed);
    return {queries_.position[at], queries_.normal[at], asked_.first_listed + listed};
  }

  /// Its own first.
  template <typename Use>
  void each_pixel_near(size_t entry, const Use& use) const {
    use(static_cast<size_t>(sub_.pixel[entry]));
    each_around(view_, sub_.pixel[entry], use);
  }

  /// What sub-hits of entries before this one have added around it.
  void collect_added(size_t entry) {
    added_.clear();
    each_pixel_near(entry, [&](size_t pixel) {
      const int32_t other = entry_[pixel];
      if (other == scene::kNone || static_cast<size_t>(other) >= entry) return;
      const auto at = static_cast<size_t>(other);
      for (int32_t q = own_[at]; q < own_[at + 1]; ++q) added_.push_back(candidate(q));
    });
  }

  int32_t nearest(size_t s, std::span<const Candidate> candidates) const {
    const Vec3 &position = sub_.hits.position[s], &normal = sub_.hits.normal[s];
    const float tolerance = sub_.hits.depth[s] * view_.pixel_size;
    int32_t best = scene::kNone;
    float best_distance = INFINITY;
    for (const Candidate& candidate : candidates) {
      const Vec3 between = candidate.position - position;
      const float distance = dot(between, between);
      if (!(distance < best_distance) || dot(normal, candidate.normal) < kSharedNormal) continue;
      if (!same_plane(position, normal, candidate.position, candidate.normal, tolerance)) continue;
      best_distance = distance;
      best = candidate.query;
    }
    return best;
  }

  const EdgeView& view_;
  const PixelQueries& asked_;
  QuerySet& queries_;
  SubHits& sub_;
  std::vector<int32_t> own_;    ///< place of the first query that an edge pixel added, by its entry
  std::vector<uint8_t> open_;   ///< by entry: a sub-hit found no pixel
  std::vector<int32_t> entry_;  ///< of a pixel among the edge pixels
  std::vector<Candidate> added_;
};

/// Whether what is around a pixel sends out more light or less: the smallest part of a lamp counts.
bool is_near_lamp(const EdgeView& view, int32_t pixel) {
  const auto emission = [&](size_t i) { return view.hits.emission[view.first + i]; };
  bool lamp = false;
  each_around(view, pixel, [&](size_t other) {
    lamp = lamp || emissions_differ(emission(static_cast<size_t>(pixel)), emission(other));
  });
  return lamp;
}

/// Hits of pixels in a row.
class PixelTracer {
 public:
  /// All that is given must outlive it.
  PixelTracer(const pathtrace::Bvh& bvh, const scene::Camera& camera, const PictureRows& rows,
              std::span<const int32_t> pixels)
      : bvh_(bvh), camera_(camera), rows_(rows), pixels_(pixels) {}

  /// Appends the points `within` each of these pixels, by their entries.
  void append(std::span<const size_t> entries, std::span<const Vec2> within,
              pathtrace::GBuffer* hits) const {
    std::vector<Vec2> points(entries.size() * within.size());
    parallel_for(static_cast<int64_t>(entries.size()), kEntries, [&](int64_t begin, int64_t end) {
      for (auto k = static_cast<size_t>(begin); k < static_cast<size_t>(end); ++k) {
        const int32_t pixel = pixels_[entries[k]];
        const PixelPoints inside(pixel % rows_.width, rows_.first + pixel / rows_.width);
        for (size_t i = 0; i < within.size(); ++i)
          points[k * within.size() + i] = inside.at(within[i]);
      }
    });
    pathtrace::append_image_points(bvh_, camera_, rows_.width, rows_.height, points, hits);
  }

 private:
  const pathtrace::Bvh& bvh_;
  const scene::Camera& camera_;
  const PictureRows& rows_;
  std::span<const int32_t> pixels_;
};

/// The means of what sub-hits send out, and the pixels which lamps may have a share of: those where
/// sub-hits differ, and all near a lamp. If its edge lies as in one pixel in all that it runs
/// through, a small share that hits rarely meet would be missing from the whole edge.
/// @param near_lamp  by entry
std::vector<size_t> average_emission(std::span<const uint8_t> near_lamp, SubHits* sub) {
  sub->emission.resize(sub->pixel.size());
  std::vector<uint8_t> shared(near_lamp.begin(), near_lamp.end());
  parallel_for(static_cast<int64_t>(shared.size()), kEntries, [&](int64_t begin, int64_t end) {
    for (auto entry = static_cast<size_t>(begin); entry < static_cast<size_t>(end); ++entry) {
      const Rgb& first = sub->hits.emission[entry * static_cast<size_t>(sub->few)];
      Rgb sum;
      sub->each(entry, [&](size_t s) {
        const Rgb& emission = sub->hits.emission[s];
        sum += emission;
        shared[entry] = shared[entry] || emissions_differ(first, emission);
      });
      sub->emission[entry] = sum * (1.0f / static_cast<float>(sub->count(entry)));
    }
  });
  std::vector<size_t> out;
  for (size_t entry = 0; entry < shared.size(); ++entry) {
    if (shared[entry]) out.push_back(entry);
  }
  return out;
}

/// Looks closer at what share of a pixel lamps have.
/// @param most  hits
void refine_emission(const PixelTracer& tracer, std::span<const uint8_t> near_lamp, size_t most,
                     SubHits* sub) {
  const std::vector<size_t> lamps = average_emission(near_lamp, sub);
  if (lamps.empty()) return;
  const auto hits =
      static_cast<int>(std::min(static_cast<size_t>(lamp_hits(sub->many)), most / lamps.size()));
  if (hits <= sub->many) return;
  pathtrace::GBuffer more;
  tracer.append(lamps, stratified_points(hits, hits), &more);
  for (size_t k = 0; k < lamps.size(); ++k) {
    Rgb sum;
    for (size_t i = 0; i < static_cast<size_t>(hits); ++i)
      sum += more.emission[k * static_cast<size_t>(hits) + i];
    sub->emission[lamps[k]] = sum * (1.0f / static_cast<float>(hits));
  }
}

}  // namespace

std::vector<int32_t> find_edges(const EdgeView& view) {
  const auto width = static_cast<size_t>(view.width());
  const int height = view.height();
  // A bit for each neighbour of kAfter that differs: each pair is looked at once.
  std::vector<uint8_t> differs(width * static_cast<size_t>(height));
  parallel_for(height, kRows, [&](int64_t begin, int64_t end) {
    for (auto y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (size_t k = 0; k < kAfter.size(); ++k) {
        const auto& [dx, dy] = kAfter[k];
        if (y + dy >= height) continue;
        // The pixels of the row that have such a neighbour.
        const size_t first = static_cast<size_t>(y) * width + (dx < 0 ? 1 : 0),
                     count = dx == 0 ? width : width - 1;
        const size_t a = view.first + first,
                     b = a + static_cast<size_t>(dy) * width + static_cast<size_t>(dx);
        const auto bit = static_cast<uint8_t>(1u << k);
        if (dx * dy == 0) {
          mark_differing_hits(view.hits, a, b, count, view.pixel_size, bit, &differs[first]);
        } else {
          mark_differing_emissions(view.hits, a, b, count, bit, &differs[first]);
        }
      }
    }
  });
  std::vector<std::vector<int32_t>> found(static_cast<size_t>((height + kRows - 1) / kRows));
  parallel_for(height, kRows, [&](int64_t begin, int64_t end) {
    std::vector<int32_t>& edges = found[static_cast<size_t>(begin / kRows)];
    std::vector<uint8_t> is_edge(width);
    for (auto y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      const uint8_t* row = differs.data() + static_cast<size_t>(y) * width;
      std::copy_n(row, width, is_edge.begin());
      for (size_t k = 0; k < kAfter.size(); ++k) {
        const auto& [dx, dy] = kAfter[k];
        if (y - dy < 0) continue;
        const size_t first = dx > 0 ? 1 : 0, last = dx < 0 ? width - 1 : width;
        const uint8_t* before = row - static_cast<size_t>(dy) * width - dx;
        const auto bit = static_cast<uint8_t>(1u << k);
        for (size_t x = first; x < last; ++x)
          is_edge[x] = static_cast<uint8_t>(is_edge[x] | (before[x] & bit));
      }
      for (size_t x = 0; x < width; ++x) {
        if (is_edge[x]) edges.push_back(static_cast<int32_t>(static_cast<size_t>(y) * width + x));
      }
    }
  });
  std::vector<int32_t> out;
  for (const std::vector<int32_t>& edges : found) out.insert(out.end(), edges.begin(), edges.end());
  return out;
}

SubHits trace_sub_hits(const pathtrace::Bvh& bvh, const scene::Camera& camera, const EdgeView& view,
                       std::vector<int32_t> pixels, int many) {
  SubHits out;
  out.pixel = std::move(pixels);
  out.few = std::min(many, std::max(kFewestHits, many / kFewShare));
  out.many = many;
  out.more.assign(out.pixel.size(), scene::kNone);
  out.hits.reserve(out.pixel.size() * static_cast<size_t>(many));
  const std::vector<Vec2> within = stratified_points(many, out.few);
  const PixelTracer tracer(bvh, camera, view.rows, out.pixel);
  std::vector<size_t> all(out.pixel.size());
  std::iota(all.begin(), all.end(), size_t{0});
  const auto few = static_cast<size_t>(out.few);
  tracer.append(all, std::span(within).first(few), &out.hits);
  std::vector<uint8_t> near_lamp(out.pixel.size());
  parallel_for(static_cast<int64_t>(out.pixel.size()), kEntries, [&](int64_t begin, int64_t end) {
    for (auto entry = static_cast<size_t>(begin); entry < static_cast<size_t>(end); ++entry) {
      near_lamp[entry] = is_near_lamp(view, out.pixel[entry]) ? 1 : 0;
      if (out.few == many) continue;
      const size_t centre = view.first + static_cast<size_t>(out.pixel[entry]);
      bool open = near_lamp[entry] != 0;
      for (size_t s = entry * few; s < (entry + 1) * few && !open; ++s)
        open = hits_differ(view.hits, centre, out.hits, s, view.pixel_size);
      if (open) out.more[entry] = 0;
    }
  });
  if (out.few < many) {
    std::vector<size_t> open;
    for (size_t entry = 0; entry < out.more.size(); ++entry) {
      if (out.more[entry] == scene::kNone) continue;
      out.more[entry] = static_cast<int32_t>(open.size());
      open.push_back(entry);
    }
    tracer.append(open, std::span(within).subspan(few), &out.hits);
  }
  refine_emission(tracer, near_lamp,
                  view.hits.mask.size() * static_cast<size_t>(many) / kLampHitShare, &out);
  out.source.assign(out.hits.mask.size(), scene::kNone);
  return out;
}

void assign_sources(const EdgeView& view, const PixelQueries& asked, QuerySet* queries,
                    SubHits* sub) {
  SourceFinder finder(view, asked, queries, sub);
  parallel_for(static_cast<int64_t>(sub->pixel.size()), kEntries, [&](int64_t begin, int64_t end) {
    for (int64_t entry = begin; entry < end; ++entry)
      finder.find_pixels(static_cast<size_t>(entry));
  });
  for (size_t entry = 0; entry < sub->pixel.size(); ++entry) finder.find_or_add(entry);
}

}  // namespace lte::infer
