#include "lte/pathtrace/reach/reach_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "lte/base/parallel.h"
#include "lte/pathtrace/embree_scene.h"
#include "lte/pathtrace/lights/lights.h"
#include "lte/pathtrace/ray_offset.h"
#include "lte/pathtrace/reach/light_finder.h"
#include "lte/pathtrace/reach/place_grid.h"
#include "lte/scene/area_table.h"
#include "lte/scene/sampler.h"

namespace lte::pathtrace {
namespace {

constexpr std::array<int, kReachRounds> kPathsOfRounds{4, 16};
/// Paths that all places of a pocket have together, after which it counts as dark.
constexpr int64_t kPathsOfPocket = 256;
constexpr int64_t kGrain = 64;
constexpr int kMaxRays = 3;          // from a vertex to places nearby
constexpr size_t kLinkVertices = 5;  // of a place, from which others in the same pocket are sought
constexpr double kSearchRadius = 2;  // in units of the spacing of points
constexpr float kSamePlace = 1e-3f;  // of the scene's extent, to recall what was dark

bool overlap(const Bounds& a, const Bounds& b) {
  return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y && b.low.y <= a.high.y &&
         a.low.z <= b.high.z && b.low.z <= a.high.z;
}

/// Places that see one another, by union-find.
class Pockets {
 public:
  explicit Pockets(size_t places) : parent_(places) {
    std::iota(parent_.begin(), parent_.end(), uint32_t{0});
  }
  uint32_t of(uint32_t place) {
    while (parent_[place] != place) place = parent_[place] = parent_[parent_[place]];
    return place;
  }
  void join(uint32_t a, uint32_t b) {
    a = of(a);
    b = of(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<uint32_t> parent_;
};

/// Decides which points to keep, by the conditions of reach.h. The places of a point are its front
/// and, for Sides::Either, its back.
class ReachSearch {
 public:
  ReachSearch(const Bvh& bvh, std::span<const Vec3> positions, std::span<const Vec3> normals,
              Sides sides, const ReachOptions& options, const ReachRecall& recall)
      : bvh_(bvh),
        lights_(bvh.scene(), LightChoice::EachGroup),
        options_(options),
        recall_(recall),
        positions_(positions),
        sides_(sides == Sides::Front ? 1 : 2),
        places_(positions.size() * sides_),
        settled_(places_.size()) {
    const float half_extent = 0.5f * max_component(bvh.bounds().extent());
    for (size_t p = 0; p < places_.size(); ++p) {
      const size_t i = point_of(p);
      const Vec3 side = p < positions.size() ? normals[i] : -normals[i];
      places_[p].origin = offset_origin(positions[i], side, half_extent) - bvh.handles().origin;
      places_[p].side = side;
      places_[p].point = static_cast<uint32_t>(i);
    }
    const double area = std::max(scene::surface_area(bvh.scene()), 1e-30);
    const auto points = static_cast<double>(std::max<size_t>(1, positions.size()));
    radius_ = static_cast<float>(kSearchRadius * std::sqrt(area / points));
    recall_dark_points(2 * half_extent * kSamePlace);
  }

  std::vector<uint8_t> run() {
    if (lights_.empty()) return std::vector<uint8_t>(positions_.size(), kFrontLit);
    for (int round = 0; round < recall_.rounds; ++round) {
      if (round > 0) settle_pockets();
      trace(kPathsOfRounds[static_cast<size_t>(round)]);
      spread_from_lit();
    }
    if (recall_.now != nullptr) remember();
    std::vector<uint8_t> sides(positions_.size());
    for (size_t p = 0; p < places_.size(); ++p)
      if (places_[p].lit) sides[point_of(p)] |= p < positions_.size() ? kFrontLit : kBackLit;
    return sides;
  }

 private:
  size_t point_of(size_t place) const { return place % positions_.size(); }
  bool kept(size_t point) const {
    return places_[point].lit || (sides_ == 2 && places_[point + positions_.size()].lit);
  }

  /// Takes over what is still dark from the search of the same number.
  void recall_dark_points(float near) {
    const size_t number = recall_.now != nullptr ? recall_.now->searches.size() : 0;
    if (recall_.before == nullptr || number >= recall_.before->searches.size()) return;
    const ReachMemory::Search& before = recall_.before->searches[number];
    const Vec3 frame = bvh_.handles().origin;
    if (before.dark_of_point.size() != positions_.size() || !(before.frame == frame)) return;
    for (size_t i = 0; i < positions_.size(); ++i) {
      if (before.dark_of_point[i] < 0) continue;
      const auto& dark = before.dark[static_cast<size_t>(before.dark_of_point[i])];
      if (max_component(abs(dark.position - positions_[i])) > near) continue;
      const bool touched =
          std::any_of(recall_.changed.begin(), recall_.changed.end(), [&](const Bounds& box) {
            const Vec3 slack{near, near, near};
            const Bounds changed{box.low - frame - slack, box.high - frame + slack};
            return std::any_of(dark.places.begin(), dark.places.end(),
                               [&](const auto& place) { return overlap(place.bounds, changed); });
          });
      if (touched) continue;
      for (size_t side = 0; side < std::min(sides_, dark.places.size()); ++side) {
        const size_t p = i + side * positions_.size();
        places_[p].paths = dark.places[side].paths;
        places_[p].bounds = dark.places[side].bounds;
        places_[p].vertices = dark.places[side].vertices;
        settled_[p] = 1;
      }
    }
  }

  void remember() const {
    ReachMemory::Search& search = recall_.now->searches.emplace_back();
    search.frame = bvh_.handles().origin;
    search.dark_of_point.assign(positions_.size(), -1);
    for (size_t i = 0; i < positions_.size(); ++i) {
      if (kept(i)) continue;
      search.dark_of_point[i] = static_cast<int32_t>(search.dark.size());
      ReachMemory::DarkPoint& dark = search.dark.emplace_back();
      dark.position = positions_[i];
      for (size_t side = 0; side < sides_; ++side)
        dark.places.push_back(places_[i + side * positions_.size()]);
    }
  }

  /// Condition 1 for the sides of all points that are not kept.
  void trace(int paths) {
    std::vector<uint32_t> numbers;
    for (size_t p = 0; p < places_.size(); ++p)
      if (!settled_[p] && !kept(point_of(p))) numbers.push_back(static_cast<uint32_t>(p));
    find_light(bvh_, lights_, options_, paths, numbers, recall_.check, &places_);
  }

  /// Condition 2. Round by round, dark places look for those that the last round has lit; in the
  /// first one for all that are.
  void spread_from_lit() {
    std::vector<uint32_t> lit, dark;
    for (uint32_t p = 0; p < places_.size(); ++p) {
      if (places_[p].lit)
        lit.push_back(p);
      else if (!kept(point_of(p)))
        dark.push_back(p);
    }
    while (!lit.empty() && !dark.empty()) {
      const PlaceGrid grid(places_, lit, radius_);
      std::vector<uint8_t> found(dark.size());
      parallel_for(static_cast<int64_t>(dark.size()), kGrain, [&](int64_t begin, int64_t end) {
        for (auto k = static_cast<size_t>(begin); k < static_cast<size_t>(end); ++k) {
          const std::vector<PathVertex>& from = places_[dark[k]].vertices;
          found[k] = std::any_of(from.begin(), from.end(), [&](const PathVertex& vertex) {
            return seen_from(vertex, grid) != scene::kNone;
          });
        }
      });
      lit.clear();
      for (size_t k = 0; k < dark.size(); ++k) {
        if (!found[k]) continue;
        places_[dark[k]].lit = true;
        lit.push_back(dark[k]);
      }
      std::erase_if(dark, [&](uint32_t p) { return kept(point_of(p)); });
    }
  }

  /// Settles the dark places of pockets in which enough paths have found nothing.
  void settle_pockets() {
    std::vector<uint32_t> dark;
    for (uint32_t p = 0; p < places_.size(); ++p)
      if (!kept(point_of(p))) dark.push_back(p);
    const PlaceGrid grid(places_, dark, radius_);
    std::vector<std::array<int64_t, kLinkVertices>> links(dark.size());
    parallel_for(static_cast<int64_t>(dark.size()), kGrain, [&](int64_t begin, int64_t end) {
      for (auto k = static_cast<size_t>(begin); k < static_cast<size_t>(end); ++k) {
        const std::vector<PathVertex>& from = places_[dark[k]].vertices;
        links[k].fill(scene::kNone);
        for (size_t v = 0; v < std::min(kLinkVertices, from.size()); ++v)
          links[k][v] = seen_from(from[v], grid, dark[k]);
      }
    });
    Pockets pockets(places_.size());
    for (size_t k = 0; k < dark.size(); ++k)
      for (const int64_t other : links[k])
        if (other != scene::kNone) pockets.join(dark[k], static_cast<uint32_t>(other));
    std::vector<int64_t> paths(places_.size());
    for (const uint32_t p : dark) paths[pockets.of(p)] += places_[p].paths;
    for (const uint32_t p : dark)
      if (paths[pockets.of(p)] >= kPathsOfPocket) settled_[p] = 1;
  }

  /// Number of a place nearby that a vertex sees, or kNone.
  int64_t seen_from(const PathVertex& vertex, const PlaceGrid& grid,
                    int64_t except = scene::kNone) const {
    int64_t seen = scene::kNone;
    int rays = 0;
    grid.any_before(vertex, [&](uint32_t number) {
      if (number == except) return false;
      const Vec3 way = places_[number].origin - vertex.position;
      if (!occluded(bvh_.handles().top, vertex.position, way, 1)) seen = number;
      return seen != scene::kNone || ++rays == kMaxRays;
    });
    return seen;
  }

  const Bvh& bvh_;
  const Lights lights_;
  const ReachOptions& options_;
  const ReachRecall& recall_;
  std::span<const Vec3> positions_;
  const size_t sides_;            ///< of a point: 1 or 2
  std::vector<Place> places_;     ///< the fronts of all points, then their backs
  std::vector<uint8_t> settled_;  ///< [places] not worth tracing any more
  float radius_ = 0;
};

}  // namespace

std::vector<uint8_t> search_for_light(const Bvh& bvh, std::span<const Vec3> positions,
                                      std::span<const Vec3> normals, Sides sides,
                                      const ReachOptions& options, const ReachRecall& recall) {
  return ReachSearch(bvh, positions, normals, sides, options, recall).run();
}

}  // namespace lte::pathtrace
