#include "lte/pathtrace/placement/room_places.h"

#include <algorithm>
#include <cmath>

#include "lte/base/random.h"

namespace lte::pathtrace {
namespace {

constexpr int kCandidates = 256;  ///< in one go
constexpr int kMaxGoes = 16;      ///< until enough of them are indoors: a small house in a field
/// Share of probes that must hit in a room with all its walls.
constexpr float kIndoors = 0.85f;
constexpr float kMinFrontShare = 0.5f;
constexpr float kHighestCeiling = 20;  ///< units above the eye; a dome of sky is farther away
/// Probes so near the horizon ask for walls: windows take some of a room's, a garden has few.
constexpr float kNearHorizon = 0.35f;
constexpr float kWalls = 0.75f;
/// Units: what is farther away, such as all that a door or a window shows, counts as so far.
constexpr float kFarthest = 10;
/// Share of a room's surfaces that are level or upright. A vessel has less, and a house has both.
constexpr float kSquare = 0.5f;
/// Units; what rises by so much over the floor stands on it and is not one.
constexpr float kLowestFurniture = 0.05f, kHighestFurniture = 1.3f;

struct Search {
  const Bvh& bvh;
  const FreeSpace& space;
  bool outward;      ///< the scene shows its front faces to those outside
  bool surrounded;   ///< the scene has walls around it
  bool no_ceilings;  ///< in the whole scene: walls alone will do
};

/// Looks around from the eye and fills the rest. @return the height of the lowest level surface in
/// sight
float look_around(const Search& search, RoomPlace* place) {
  const float unit = search.space.unit;
  int hits = 0, fronts = 0, level = 0, walls = 0, square = 0;
  float log_sum = 0, lowest_floor = INFINITY;
  place->surroundings = Surroundings::Open;
  for (int i = 0; i < kProbes; ++i) {
    const Vec3 direction = probe_direction(i);
    const Hit hit = search.bvh.intersect({place->eye, direction});
    if (hit.valid() && hit.t < 0.3f * unit) return lowest_floor;
    hits += hit.valid() ? 1 : 0;
    fronts += hit.valid() && dot(hit.normal, direction) < 0 ? 1 : 0;
    log_sum += std::log(std::min(hit.t, kFarthest * unit));
    const float rise = std::fabs(hit.normal.y);
    square += hit.valid() && (rise > 0.98f || rise < 0.05f) ? 1 : 0;
    if (hit.valid() && direction.y < 0 && hit.normal.y > 0.9f)
      lowest_floor = std::min(lowest_floor, place->eye.y + hit.t * direction.y);
    if (std::fabs(direction.y) > kNearHorizon) continue;
    ++level;
    walls += hit.valid() ? 1 : 0;
  }
  place->free_distance = std::exp(log_sum / kProbes);
  const auto share = [](int part, int whole) {
    return static_cast<float>(part) / static_cast<float>(std::max(1, whole));
  };
  place->sees_sky = hits < kProbes;
  if (share(fronts, hits) < kFronts) return lowest_floor;
  if (search.outward && share(square, hits) < kSquare) return lowest_floor;
  const float enclosed = share(hits, kProbes);
  const Hit ceiling = search.bvh.intersect({place->eye, {0, 1, 0}});
  if (enclosed >= kIndoors && share(walls, level) >= kWalls &&
      share(fronts, hits) >= kMinFrontShare && ceiling.valid() &&
      ceiling.t <= kHighestCeiling * unit) {
    place->surroundings = Surroundings::Indoors;
  } else if (search.surrounded && enclosed >= kEnclosed) {
    place->surroundings = Surroundings::Enclosed;
  } else if (search.surrounded && search.no_ceilings && share(walls, level) >= kIndoors) {
    place->surroundings = Surroundings::BetweenWalls;
  }
  return lowest_floor;
}

void add_places(const Search& search, Rng* rng, std::vector<RoomPlace>* places) {
  const Bounds& bounds = search.bvh.bounds();
  const Vec3 extent = bounds.extent();
  const float unit = search.space.unit;
  for (int i = 0; i < kCandidates; ++i) {
    const Vec3 start{bounds.low.x + rng->uniform() * extent.x,
                     bounds.low.y + rng->uniform() * extent.y,
                     bounds.low.z + rng->uniform() * extent.z};
    const float height = rng->uniform(1.2f, 1.7f) * unit;
    const Vec3 down{0, -1, 0};
    const Hit floor = search.bvh.intersect({start, down});
    if (!floor.valid() || std::fabs(floor.normal.y) < 0.7f) continue;
    RoomPlace place{start + down * (floor.t - height)};
    if (floor.t < height && search.bvh.occluded({start, {0, 1, 0}, 0, height - floor.t})) continue;
    const float lowest_floor = look_around(search, &place);
    // What the point is above may be a table, with the floor in sight beside it.
    const float drop = place.eye.y - height - lowest_floor;
    if (drop > kLowestFurniture * unit && drop < kHighestFurniture * unit) {
      place.eye.y -= drop;
      look_around(search, &place);
    }
    if (place.surroundings != Surroundings::Open) places->push_back(place);
  }
}

}  // namespace

std::vector<RoomPlace> find_room_places(const Bvh& bvh, const FreeSpace& space, uint64_t seed,
                                        int enough) {
  std::vector<RoomPlace> places;
  if (bvh.bounds().empty() || !(space.unit > 0) || !space.has_rooms()) return places;
  if (bvh.bounds().extent().y < kLowestRoom && !space.closed()) return places;
  const Search search{bvh, space, space.shows_outside(), space.surrounded(),
                      space.above() >= kOpen / 2};
  Rng rng(seed, 0xca3e7a);
  const auto indoors = [](const RoomPlace& place) {
    return place.surroundings == Surroundings::Indoors;
  };
  for (int go = 0; go < kMaxGoes; ++go) {
    add_places(search, &rng, &places);
    if (std::count_if(places.begin(), places.end(), indoors) >= enough) break;
  }
  Surroundings best = Surroundings::Open;
  for (const RoomPlace& place : places) best = std::max(best, place.surroundings);
  std::erase_if(places, [&](const RoomPlace& place) { return place.surroundings != best; });
  return places;
}

}  // namespace lte::pathtrace
