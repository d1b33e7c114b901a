#include "datagen/homes/walkway.h"

#include <algorithm>
#include <cmath>

namespace lte::datagen::homes {
namespace {

constexpr float kOverhead = 1.9f, kStepOver = 0.03f;

float distance(const OrientedBox& box, const Vec2& p) {
  const float dx = p.x - box.centre.x, dz = p.y - box.centre.y;
  const float u = std::abs(dx * box.axis.x + dz * box.axis.y) - box.half.x;
  const float v = std::abs(-dx * box.axis.y + dz * box.axis.x) - box.half.y;
  return std::hypot(std::max(u, 0.0f), std::max(v, 0.0f));
}

}  // namespace

WalkGrid::WalkGrid(const Rect& room)
    : room_(room),
      columns_(static_cast<int>(room.width() / kWalkCell)),
      rows_(static_cast<int>(room.depth() / kWalkCell)),
      free_(static_cast<size_t>(columns_ * rows_), 0) {
  for (int cell = 0; cell < columns_ * rows_; ++cell) {
    const Vec2 p = middle(cell);
    const float wall = std::min({p.x - room.x0, room.x1 - p.x, p.y - room.z0, room.z1 - p.y});
    free_[static_cast<size_t>(cell)] = wall >= kWalkRadius;
  }
}

void WalkGrid::block(const OrientedBox& box) {
  if (box.low > kOverhead || box.high < kStepOver) return;
  for (int cell = 0; cell < columns_ * rows_; ++cell) {
    char& is_free = free_[static_cast<size_t>(cell)];
    if (is_free && distance(box, middle(cell)) < kWalkRadius) is_free = 0;
  }
}

bool WalkGrid::is_free(const Vec2& at) const {
  const int cell = index(at);
  return cell >= 0 && free_[static_cast<size_t>(cell)];
}

int WalkGrid::index(const Vec2& at) const {
  const int x = static_cast<int>(
      std::floor((at.x - room_.x0) / room_.width() * static_cast<float>(columns_)));
  const int z =
      static_cast<int>(std::floor((at.y - room_.z0) / room_.depth() * static_cast<float>(rows_)));
  return x < 0 || z < 0 || x >= columns_ || z >= rows_ ? -1 : z * columns_ + x;
}

Vec2 WalkGrid::middle(int cell) const {
  return {room_.x0 + room_.width() * (static_cast<float>(cell % columns_) + 0.5f) /
                         static_cast<float>(columns_),
          room_.z0 + room_.depth() * (static_cast<float>(cell / columns_) + 0.5f) /
                         static_cast<float>(rows_)};
}

std::vector<int> WalkGrid::flood(int start) const {
  std::vector<int> found;
  if (start < 0 || !free_[static_cast<size_t>(start)]) return found;
  std::vector<char> seen(free_.size(), 0);
  found.push_back(start);
  seen[static_cast<size_t>(start)] = 1;
  for (size_t i = 0; i < found.size(); ++i) {
    const int x = found[i] % columns_, z = found[i] / columns_;
    for (const auto& [dx, dz] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      const int nx = x + dx, nz = z + dz;
      if (nx < 0 || nz < 0 || nx >= columns_ || nz >= rows_) continue;
      const auto next = static_cast<size_t>(nz * columns_ + nx);
      if (seen[next] || !free_[next]) continue;
      seen[next] = 1;
      found.push_back(static_cast<int>(next));
    }
  }
  return found;
}

bool WalkGrid::connects(const std::vector<Vec2>& doors) const {
  if (doors.empty()) return true;
  const std::vector<int> cells = flood(index(doors[0]));
  return std::all_of(doors.begin(), doors.end(), [&](const Vec2& door) {
    return std::find(cells.begin(), cells.end(), index(door)) != cells.end();
  });
}

std::vector<Vec2> WalkGrid::reachable(const Vec2& start) const {
  std::vector<Vec2> points;
  for (const int cell : flood(index(start))) points.push_back(middle(cell));
  return points;
}

std::vector<Vec2> door_steps(const FloorPlan& plan, int room) {
  std::vector<Vec2> steps;
  for (const Opening& opening : plan.openings_of(room)) {
    if (opening.kind == OpeningKind::Window) continue;
    const float face = plan.face(room, opening.side), middle = (opening.from + opening.to) / 2;
    const bool high = opening.side == Side::PosX || opening.side == Side::PosZ;
    const float step = face + (high ? -0.35f : 0.35f);
    steps.push_back(along_z(opening.side) ? Vec2{step, middle} : Vec2{middle, step});
  }
  return steps;
}

}  // namespace lte::datagen::homes
