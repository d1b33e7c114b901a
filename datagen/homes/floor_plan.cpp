#include "datagen/homes/floor_plan.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "datagen/homes/openings.h"
#include "lte/base/check.h"

namespace lte::datagen::homes {
namespace {

constexpr int kAttempts = 2000;

struct Program {
  RoomType type;
  float area;
};

struct Limits {
  float area_low, area_high, shortest, aspect;
};

Limits limits_of(RoomType type) {
  switch (type) {
    case RoomType::Bedroom:
      return {11, 18, 2.9f, 1.8f};
    case RoomType::Living:
      return {17, 30, 3.4f, 1.9f};
    case RoomType::Kitchen:
      return {9, 15, 2.6f, 2.0f};
    case RoomType::Bathroom:
      return {5, 8.5f, 1.9f, 2.0f};
    case RoomType::Study:
      return {8, 13, 2.5f, 1.9f};
    case RoomType::Dining:
      return {11, 17, 3.0f, 1.8f};
    case RoomType::Corridor:
      return {0, 0, 1.1f, 100};
  }
  return {};
}

/// Chooses the rooms of a home of this many, without its corridor.
std::vector<RoomType> choose_types(int rooms, Rng* rng) {
  using enum RoomType;
  if (rooms == 1) {
    const RoomType alone[] = {Bedroom, Living, Kitchen, Bathroom, Study, Dining, Living, Bedroom};
    return {alone[rng->below(8)]};
  }
  std::vector<RoomType> types{Living};
  const std::vector<RoomType> further[] = {{Kitchen, Bedroom, Bathroom, Study},
                                           {Bedroom, Bathroom, Kitchen, Dining},
                                           {Dining, Kitchen, Bedroom, Bathroom},
                                           {Bedroom, Kitchen, Bathroom, Bedroom}};
  const auto& list = further[rng->below(4)];
  const int wanted = rooms >= 4 ? rooms - 1 : rooms;
  for (int i = 1; i < wanted; ++i) types.push_back(list[static_cast<size_t>(i - 1)]);
  for (size_t i = types.size(); i > 1; --i) std::swap(types[i - 1], types[rng->below(i)]);
  return types;
}

struct Cell {
  RoomType type;
  Rect rect;
};

/// Cuts `rect` across its longer side, in proportion to the areas of the rooms on either side,
/// until each part is one room.
void slice(const Rect& rect, const std::vector<Program>& rooms, std::vector<Cell>* out) {
  if (rooms.size() == 1) {
    out->push_back({rooms[0].type, rect});
    return;
  }
  const auto sum = [](auto first, auto last) {
    return std::accumulate(first, last, 0.0f, [](float s, const Program& p) { return s + p.area; });
  };
  const float total = sum(rooms.begin(), rooms.end());
  size_t cut = 1;
  for (size_t i = 1; i < rooms.size(); ++i) {
    const auto uneven = [&](size_t k) {
      return std::abs(2 * sum(rooms.begin(), rooms.begin() + static_cast<std::ptrdiff_t>(k)) -
                      total);
    };
    if (uneven(i) < uneven(cut)) cut = i;
  }
  const auto middle = rooms.begin() + static_cast<std::ptrdiff_t>(cut);
  const float share = sum(rooms.begin(), middle) / total;
  Rect first = rect, second = rect;
  if (rect.width() >= rect.depth()) {
    first.x1 = second.x0 = rect.x0 + share * rect.width();
  } else {
    first.z1 = second.z0 = rect.z0 + share * rect.depth();
  }
  slice(first, {rooms.begin(), middle}, out);
  slice(second, {middle, rooms.end()}, out);
}

/// Lays out rooms on both sides of a corridor, or, if there are fewer than four, side by side.
std::vector<Cell> lay_out(int rooms, Rng* rng) {
  std::vector<Program> programs;
  float area = 0;
  for (const RoomType type : choose_types(rooms, rng)) {
    const Limits limits = limits_of(type);
    programs.push_back({type, rng->uniform(limits.area_low, limits.area_high)});
    area += programs.back().area;
  }
  const float aspect = rooms >= 4 ? rng->uniform(0.4f, 1.7f) : rng->uniform(1.0f, 1.45f);
  Rect all{0, 0, std::sqrt(area * aspect), std::sqrt(area / aspect)};
  std::vector<Cell> cells;
  if (rooms < 4) {
    if (rng->below(2) == 0) std::swap(all.x1, all.z1);
    slice(all, programs, &cells);
    return cells;
  }
  const float corridor = rng->uniform(1.3f, 1.6f);
  const auto half =
      programs.begin() +
      static_cast<std::ptrdiff_t>(programs.size() / 2 + rng->below(2) * (programs.size() % 2));
  float north = 0;
  for (auto it = programs.begin(); it != half; ++it) north += it->area;
  const float split = all.z1 * north / area;
  slice({0, 0, all.x1, split}, {programs.begin(), half}, &cells);
  cells.push_back({RoomType::Corridor, {0, split, all.x1, split + corridor}});
  slice({0, split + corridor, all.x1, all.z1 + corridor}, {half, programs.end()}, &cells);
  if (rng->below(2) == 0)
    for (Cell& c : cells) c.rect = {c.rect.z0, c.rect.x0, c.rect.z1, c.rect.x1};
  return cells;
}

bool acceptable(const FloorPlan& plan) {
  for (const PlanRoom& room : plan.rooms) {
    const Limits limits = limits_of(room.type);
    const float a = room.inner.width(), b = room.inner.depth();
    if (std::min(a, b) < limits.shortest || std::max(a, b) > limits.aspect * std::min(a, b))
      return false;
    if (std::max(room.inner.x1, room.inner.z1) > kMaxHomeExtent - 2 * kRecess) return false;
  }
  return true;
}

}  // namespace

const char* room_name(RoomType type) {
  static constexpr const char* kNames[kRoomTypes] = {
      "bedroom", "living room", "kitchen", "bathroom", "study", "dining room", "corridor"};
  return kNames[static_cast<size_t>(type)];
}

Side opposite(Side side) {
  static constexpr Side kOther[] = {Side::PosX, Side::NegX, Side::PosZ, Side::NegZ};
  return kOther[static_cast<size_t>(side)];
}

float FloorPlan::face(int room, Side side) const {
  const Rect& r = rooms[static_cast<size_t>(room)].inner;
  const float faces[] = {r.x0, r.x1, r.z0, r.z1};
  return faces[static_cast<size_t>(side)];
}

std::vector<Opening> FloorPlan::openings_of(int room) const {
  std::vector<Opening> found;
  for (Opening opening : openings) {
    if (opening.other == room) {
      std::swap(opening.room, opening.other);
      opening.side = opposite(opening.side);
    }
    if (opening.room == room) found.push_back(opening);
  }
  return found;
}

FloorPlan make_floor_plan(int rooms, float height, Rng* rng) {
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    FloorPlan plan;
    plan.height = height;
    plan.wall = rng->uniform(0.1f, 0.16f);
    for (const Cell& cell : lay_out(rooms, rng)) {
      const float t = plan.wall / 2;
      plan.rooms.push_back(
          {cell.type, {cell.rect.x0 + t, cell.rect.z0 + t, cell.rect.x1 - t, cell.rect.z1 - t}});
    }
    if (acceptable(plan) && cut_doors(&plan, rng)) {
      cut_windows(&plan, rng);
      return plan;
    }
  }
  throw Error(concat("no floor plan of ", rooms, " rooms was found in ", kAttempts, " attempts"));
}

}  // namespace lte::datagen::homes
