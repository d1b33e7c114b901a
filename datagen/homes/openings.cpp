#include "datagen/homes/openings.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lte::datagen::homes {
namespace {

constexpr float kDoorTop = 2.06f, kCornerGap = 0.16f;

/// The wall that two rooms share: which side of the first, and its extent.
struct Shared {
  int a, b;
  Side side;
  float from, to, cost;
};

bool is(RoomType type, std::initializer_list<RoomType> list) {
  return std::find(list.begin(), list.end(), type) != list.end();
}

/// The cost of a door between two rooms: the higher, the less it is wanted.
float door_cost(RoomType a, RoomType b) {
  using enum RoomType;
  if (a == Corridor || b == Corridor) return 0;
  if (a == Bathroom || b == Bathroom) return is(a, {Bedroom}) || is(b, {Bedroom}) ? 3.0f : 5.0f;
  if (is(a, {Kitchen, Dining, Living}) && is(b, {Kitchen, Dining, Living})) return 1;
  if (a == Living || b == Living) return 2;
  return a == Bedroom && b == Bedroom ? 8.0f : 4.0f;
}

std::vector<Shared> shared_walls(const FloorPlan& plan, Rng* rng) {
  std::vector<Shared> found;
  const int n = static_cast<int>(plan.rooms.size());
  for (int a = 0; a < n; ++a) {
    for (int b = 0; b < n; ++b) {
      const PlanRoom &first = plan.rooms[static_cast<size_t>(a)],
                     &second = plan.rooms[static_cast<size_t>(b)];
      for (const Side side : {Side::PosX, Side::PosZ}) {
        if (std::abs(plan.face(a, side) + plan.wall - plan.face(b, opposite(side))) > 1e-3f)
          continue;
        const bool z = along_z(side);
        const float from =
            std::max(z ? first.inner.z0 : first.inner.x0, z ? second.inner.z0 : second.inner.x0);
        const float to =
            std::min(z ? first.inner.z1 : first.inner.x1, z ? second.inner.z1 : second.inner.x1);
        if (a == b || to - from < 1 + 2 * kCornerGap) continue;
        found.push_back(
            {a, b, side, from, to, door_cost(first.type, second.type) + 0.9f * rng->uniform()});
      }
    }
  }
  std::sort(found.begin(), found.end(),
            [](const Shared& p, const Shared& q) { return p.cost < q.cost; });
  return found;
}

void cut_door(FloorPlan* plan, const Shared& wall, bool wide, Rng* rng) {
  const float length = wall.to - wall.from - 2 * kCornerGap;
  const float width = std::min(length, wide ? rng->uniform(1.2f, 1.8f) : rng->uniform(0.8f, 0.92f));
  // Near a corner, most often: that leaves long walls to furniture.
  const float place[] = {0, 1, rng->uniform()};
  const float from = wall.from + kCornerGap + place[wide ? 2 : rng->below(3)] * (length - width);
  plan->openings.push_back({OpeningKind::Doorway, wall.a, wall.b, wall.side, from, from + width, 0,
                            kDoorTop, plan->wall});
}

/// The part of a wall that is on the outside of the home; empty for inner walls.
bool is_outer(const FloorPlan& plan, int room, Side side) {
  float extreme = plan.face(room, side);
  for (size_t other = 0; other < plan.rooms.size(); ++other) {
    const float face = plan.face(static_cast<int>(other), side);
    const bool beyond =
        side == Side::PosX || side == Side::PosZ ? face > extreme + 1e-3f : face < extreme - 1e-3f;
    if (beyond) return false;
  }
  return true;
}

std::pair<float, float> wall_span(const PlanRoom& room, Side side) {
  return along_z(side) ? std::pair{room.inner.z0, room.inner.z1}
                       : std::pair{room.inner.x0, room.inner.x1};
}

bool cut_entrance(FloorPlan* plan, Rng* rng) {
  using enum RoomType;
  for (const auto& wanted : {std::initializer_list<RoomType>{Corridor},
                             {Living},
                             {Kitchen, Dining, Study, Bedroom, Bathroom}}) {
    for (size_t r = 0; r < plan->rooms.size(); ++r) {
      if (!is(plan->rooms[r].type, wanted)) continue;
      for (const Side side : kSides) {
        const auto [low, high] = wall_span(plan->rooms[r], side);
        const float width = 0.9f, room = high - low - 2 * kCornerGap - width;
        if (!is_outer(*plan, static_cast<int>(r), side) || room < 0) continue;
        const float ends[] = {0.0f, 1.0f};
        const float from = low + kCornerGap +
                           room * (plan->rooms[r].type == Corridor ? 0.5f : ends[rng->below(2)]);
        plan->openings.push_back({OpeningKind::Entrance, static_cast<int>(r), -1, side, from,
                                  from + width, 0, kDoorTop, kRecess / 2});
        return true;
      }
    }
  }
  return false;
}

void cut_window(FloorPlan* plan, int room, Side side, Rng* rng) {
  const RoomType type = plan->rooms[static_cast<size_t>(room)].type;
  const auto [low, high] = wall_span(plan->rooms[static_cast<size_t>(room)], side);
  const bool small = type == RoomType::Bathroom;
  const float margin = 0.3f, free = high - low - 2 * margin;
  const float width = std::min(free, small ? rng->uniform(0.5f, 0.8f) : rng->uniform(1.2f, 2.5f));
  const float tall =
      type == RoomType::Living ? rng->uniform(0.35f, 0.9f) : rng->uniform(0.85f, 0.95f);
  const float sill = small ? 1.4f : (type == RoomType::Kitchen ? 1.08f : tall);
  const float top = std::min(plan->height - 0.22f, rng->uniform(2.1f, 2.35f));
  const float from = low + margin + rng->uniform(0.2f, 0.8f) * (free - width);
  if (width < 0.5f) return;
  for (const Opening& other : plan->openings_of(room))
    if (other.side == side && other.from < from + width + 0.3f && from < other.to + 0.3f) return;
  plan->openings.push_back(
      {OpeningKind::Window, room, -1, side, from, from + width, sill, top, kRecess});
}

}  // namespace

bool cut_doors(FloorPlan* plan, Rng* rng) {
  const size_t n = plan->rooms.size();
  std::vector<size_t> group(n);
  std::iota(group.begin(), group.end(), size_t{0});
  size_t joined = 1;
  using enum RoomType;
  for (const Shared& wall : shared_walls(*plan, rng)) {
    const auto a = static_cast<size_t>(wall.a), b = static_cast<size_t>(wall.b);
    const bool living = is(plan->rooms[a].type, {Kitchen, Dining, Living}) &&
                        is(plan->rooms[b].type, {Kitchen, Dining, Living});
    const bool link = group[a] != group[b];
    if (link || (living && rng->below(2) == 0))
      cut_door(plan, wall, living && rng->below(2) == 0, rng);
    if (!link) continue;
    const size_t from = group[b], to = group[a];
    std::replace(group.begin(), group.end(), from, to);
    ++joined;
  }
  return joined == n && cut_entrance(plan, rng);
}

void cut_windows(FloorPlan* plan, Rng* rng) {
  for (int room = 0; room < static_cast<int>(plan->rooms.size()); ++room) {
    if (plan->rooms[static_cast<size_t>(room)].type == RoomType::Corridor) continue;
    int left = 1 + static_cast<int>(rng->below(2));
    const auto first = static_cast<size_t>(rng->below(4));
    for (size_t i = 0; i < 4 && left > 0; ++i) {
      const Side side = kSides[(first + i) % 4];
      if (!is_outer(*plan, room, side)) continue;
      cut_window(plan, room, side, rng);
      --left;
    }
  }
}

}  // namespace lte::datagen::homes
