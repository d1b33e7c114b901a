#include "infer/picture/antialias.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "lte/base/parallel.h"
#include "lte/base/random.h"

namespace lte::infer {
namespace {

using pathtrace::GBuffer;

// Thresholds of an edge: what an eye sees as one surface stays one.
constexpr float kSameNormal = 0.97f;   ///< cosine, 14°
constexpr float kColorStep = 0.15f;    ///< of the root of albedo, about that of display values
constexpr float kEmissionStep = 0.1f;  ///< relative
constexpr float kMetalStep = 0.1f;
// What may share an answer.
constexpr float kSharedNormal = 0.9f;  ///< cosine, 26°

constexpr std::pair<int, int> kAround[] = {{-1, -1}, {0, -1}, {1, -1}, {-1, 0},
                                           {1, 0},   {-1, 1}, {0, 1},  {1, 1}};

/// Those of them that come later, row by row.
constexpr std::array<std::pair<int, int>, 4> kAfter = {{{1, 0}, {-1, 1}, {0, 1}, {1, 1}}};
constexpr int64_t kRows = 8;  // that a thread takes at a time

/// Whether both points lie in the planes of each other, within `tolerance` metres.
inline bool same_plane(const Vec3& a, const Vec3& normal_a, const Vec3& b, const Vec3& normal_b,
                       float tolerance) {
  const Vec3 between = b - a;
  return std::abs(dot(between, normal_a)) <= tolerance &&
         std::abs(dot(between, normal_b)) <= tolerance;
}

bool colors_differ(const Rgb& a, const Rgb& b) {
  for (int c = 0; c < 3; ++c) {
    // Roots of numbers that are nearer than the step's square are nearer than the step.
    if (std::abs(a[c] - b[c]) < 0.99f * kColorStep * kColorStep) continue;
    if (std::abs(std::sqrt(a[c]) - std::sqrt(b[c])) > kColorStep) return true;
  }
  return false;
}

bool emissions_differ(const Rgb& a, const Rgb& b) {
  if (a == b) return false;
  for (int c = 0; c < 3; ++c) {
    if (std::abs(a[c] - b[c]) > kEmissionStep * std::max(a[c], b[c])) return true;
  }
  return false;
}

/// Whether two hits, each by its place in a buffer, see something else.
bool hits_differ(const GBuffer& of_a, size_t a, const GBuffer& of_b, size_t b, float pixel_size) {
  if (of_a.mask[a] != of_b.mask[b] || of_a.instance[a] != of_b.instance[b]) return true;
  if (!of_a.mask[a]) return false;
  if (dot(of_a.normal[a], of_b.normal[b]) < kSameNormal) return true;
  const float tolerance = std::min(of_a.depth[a], of_b.depth[b]) * pixel_size;
  if (!same_plane(of_a.position[a], of_a.normal[a], of_b.position[b], of_b.normal[b], tolerance))
    return true;
  if (colors_differ(of_a.albedo[a], of_b.albedo[b])) return true;
  if (emissions_differ(of_a.emission[a], of_b.emission[b])) return true;
  return !of_a.metallic.empty() && std::abs(of_a.metallic[a] - of_b.metallic[b]) > kMetalStep;
}

/// Point `i` of `count` in the unit square: Hammersley's set, turned by two numbers.
Vec2 stratified_point(int i, int count, float turn_x, float turn_y) {
  float reversed = 0;
  float digit = 0.5f;
  for (int bits = i; bits > 0; bits >>= 1) {
    if (bits & 1) reversed += digit;
    digit *= 0.5f;
  }
  const float x = (static_cast<float>(i) + 0.5f) / static_cast<float>(count) + turn_x;
  const float y = reversed + turn_y;
  return {x - std::floor(x), y - std::floor(y)};
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
    each_pixel_around(entry, [&](size_t pixel) {
      const int32_t query = asked_.of_pixel[pixel];
      const size_t hit = view_.first + pixel;
      if (query != scene::kNone)
        candidates[count++] = {view_.hits.position[hit], view_.hits.normal[hit], query};
    });
    for (size_t s = first(entry); s < first(entry + 1); ++s) {
      if (!reflects(s)) continue;
      sub_.source[s] = nearest(s, std::span(candidates).first(count));
      if (sub_.source[s] == scene::kNone) open_[entry] = 1;
    }
  }

  /// For sub-hits that found none: the nearest query that a sub-hit before has added, in this pixel
  /// or next to it, or one more. In the order of the entries.
  void find_or_add(size_t entry) {
    own_[entry] = own_[entry + 1] = static_cast<int32_t>(queries_.size());
    if (!open_[entry]) return;
    collect_added(entry);
    for (size_t s = first(entry); s < first(entry + 1); ++s) {
      if (sub_.source[s] != scene::kNone || !reflects(s)) continue;
      sub_.source[s] = nearest(s, added_);
      if (sub_.source[s] != scene::kNone) continue;
      queries_.add(sub_.hits, s);
      added_.push_back(candidate(static_cast<int32_t>(queries_.size()) - 1));
      sub_.source[s] = added_.back().query;
    }
    own_[entry + 1] = static_cast<int32_t>(queries_.size());
  }

 private:
  struct Candidate {
    Vec3 position, normal;
    int32_t query = scene::kNone;
  };

  size_t first(size_t entry) const { return entry * static_cast<size_t>(sub_.per_pixel); }
  bool reflects(size_t s) const {
    return sub_.hits.mask[s] && max_component(sub_.hits.albedo[s]) > 0;
  }
  Candidate candidate(int32_t listed) const {
    const auto at = static_cast<size_t>(listed);
    return {queries_.position[at], queries_.normal[at], asked_.first_listed + listed};
  }

  template <typename Use>
  void each_pixel_around(size_t entry, const Use& use) const {
    const int pixel = sub_.pixel[entry], width = view_.width();
    const int x = pixel % width, y = pixel / width;
    use(static_cast<size_t>(pixel));
    for (const auto& [dx, dy] : kAround) {
      if (x + dx < 0 || x + dx >= width || y + dy < 0 || y + dy >= view_.height()) continue;
      use(static_cast<size_t>((y + dy) * width + x + dx));
    }
  }

  /// What sub-hits of entries before this one have added around it.
  void collect_added(size_t entry) {
    added_.clear();
    each_pixel_around(entry, [&](size_t pixel) {
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

}  // namespace

std::vector<int32_t> find_edges(const EdgeView& view) {
  const int width = view.width(), height = view.height();
  const auto inside = [&](int x, int y) { return x >= 0 && x < width && y < height; };
  const auto at = [&](int x, int y) {
    return static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
  };
  // A bit for each neighbour of kAfter that differs: each pair is looked at once.
  std::vector<uint8_t> differs(at(0, height));
  parallel_for(height, kRows, [&](int64_t begin, int64_t end) {
    for (auto y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (int x = 0; x < width; ++x) {
        const size_t i = view.first + at(x, y);
        unsigned bits = 0;
        for (size_t k = 0; k < kAfter.size(); ++k) {
          const auto& [dx, dy] = kAfter[k];
          if (inside(x + dx, y + dy) &&
              hits_differ(view.hits, i, view.hits, view.first + at(x + dx, y + dy),
                          view.pixel_size))
            bits |= 1u << k;
        }
        differs[at(x, y)] = static_cast<uint8_t>(bits);
      }
    }
  });
  std::vector<std::vector<int32_t>> found(static_cast<size_t>((height + kRows - 1) / kRows));
  parallel_for(height, kRows, [&](int64_t begin, int64_t end) {
    std::vector<int32_t>& edges = found[static_cast<size_t>(begin / kRows)];
    for (auto y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (int x = 0; x < width; ++x) {
        bool edge = differs[at(x, y)] != 0;
        for (size_t k = 0; k < kAfter.size() && !edge; ++k) {
          const auto& [dx, dy] = kAfter[k];
          if (y - dy >= 0 && inside(x - dx, y - dy))
            edge = (differs[at(x - dx, y - dy)] >> k & 1) != 0;
        }
        if (edge) edges.push_back(static_cast<int32_t>(at(x, y)));
      }
    }
  });
  std::vector<int32_t> out;
  for (const std::vector<int32_t>& edges : found) out.insert(out.end(), edges.begin(), edges.end());
  return out;
}

SubHits trace_sub_hits(const pathtrace::Bvh& bvh, const scene::Camera& camera,
                       const PictureRows& rows, std::vector<int32_t> pixels, int per_pixel) {
  SubHits out;
  out.pixel = std::move(pixels);
  out.per_pixel = per_pixel;
  const auto count = static_cast<size_t>(per_pixel);
  std::vector<Vec2> points(out.pixel.size() * count);
  parallel_for(static_cast<int64_t>(out.pixel.size()), 512, [&](int64_t begin, int64_t end) {
    for (auto entry = static_cast<size_t>(begin); entry < static_cast<size_t>(end); ++entry) {
      const int x = out.pixel[entry] % rows.width, y = rows.first + out.pixel[entry] / rows.width;
      Rng turn(static_cast<uint64_t>(y), static_cast<uint64_t>(x));
      const float turn_x = turn.uniform(), turn_y = turn.uniform();
      for (int i = 0; i < per_pixel; ++i) {
        const Vec2 within = stratified_point(i, per_pixel, turn_x, turn_y);
        points[entry * count + static_cast<size_t>(i)] = {static_cast<float>(x) + within.x,
                                                          static_cast<float>(y) + within.y};
      }
    }
  });
  out.hits = pathtrace::trace_image_points(bvh, camera, rows.width, rows.height, points);
  out.source.assign(points.size(), scene::kNone);
  return out;
}

void assign_sources(const EdgeView& view, const PixelQueries& asked, QuerySet* queries,
                    SubHits* sub) {
  SourceFinder finder(view, asked, queries, sub);
  parallel_for(static_cast<int64_t>(sub->pixel.size()), 512, [&](int64_t begin, int64_t end) {
    for (int64_t entry = begin; entry < end; ++entry)
      finder.find_pixels(static_cast<size_t>(entry));
  });
  for (size_t entry = 0; entry < sub->pixel.size(); ++entry) finder.find_or_add(entry);
}

}  // namespace lte::infer
