#include "datagen/homes/cameras.h"

#include <algorithm>
#include <cmath>

#include "datagen/homes/walkway.h"

namespace lte::datagen::homes {
namespace {

constexpr float kEye = 1.5f, kLook = 0.85f, kVfov = 58;

float weight_of(const PlacedPiece& piece) {
  return piece.box.half.x * piece.box.half.y * (piece.box.high - piece.box.low);
}

/// The share, by volume, of the furniture of a room that is in view.
float share_in_view(const HomePlan& plan, int room, const Vec2& eye, const Vec2& at) {
  constexpr float kHalfWidth = 0.6f;  // radians
  const float middle = std::atan2(at.y - eye.y, at.x - eye.x);
  float seen = 0, total = 0;
  for (const PlacedPiece& piece : plan.pieces) {
    if (piece.room != room || piece.parent >= 0) continue;
    const float weight = weight_of(piece);
    const Vec2 to{piece.box.centre.x - eye.x, piece.box.centre.y - eye.y};
    const float angle = std::remainder(std::atan2(to.y, to.x) - middle, 2 * kPi);
    total += weight;
    if (std::abs(angle) < kHalfWidth && std::hypot(to.x, to.y) > 0.8f) seen += weight;
  }
  return total > 0 ? seen / total : 0;
}

/// Where to look: between the middle of the room and that of its furniture, weighted by volume.
Vec2 subject(const HomePlan& plan, int room) {
  Vec2 sum{};
  float total = 0;
  for (const PlacedPiece& piece : plan.pieces) {
    if (piece.room != room || piece.parent >= 0) continue;
    const float weight = weight_of(piece);
    sum = {sum.x + weight * piece.box.centre.x, sum.y + weight * piece.box.centre.y};
    total += weight;
  }
  const Rect& r = plan.floor.rooms[static_cast<size_t>(room)].inner;
  const Vec2 middle{(r.x0 + r.x1) / 2, (r.z0 + r.z1) / 2};
  if (total <= 0) return middle;
  return {(sum.x / total + middle.x) / 2, (sum.y / total + middle.y) / 2};
}

/// Things that block the view at eye height.
std::vector<OrientedBox> tall_things(const HomePlan& plan, int room) {
  std::vector<OrientedBox> found;
  for (const PlacedPiece& piece : plan.pieces)
    if (piece.room == room && piece.box.high > kEye - 0.35f && piece.box.low < kEye + 0.3f)
      found.push_back(piece.box);
  return found;
}

/// How far one sees from `eye` before the view meets a wall or a tall thing.
float free_distance(const Rect& r, const std::vector<OrientedBox>& tall, const Vec2& eye,
                    float angle) {
  constexpr float kStep = 0.15f;
  for (float t = kStep;; t += kStep) {
    const Vec2 p{eye.x + t * std::cos(angle), eye.y + t * std::sin(angle)};
    if (p.x < r.x0 || p.x > r.x1 || p.y < r.z0 || p.y > r.z1) return t;
    const OrientedBox probe{p, {0.02f, 0.02f}, {1, 0}, 0, kEye};
    for (const OrientedBox& box : tall)
      if (!apart(probe, box, 0)) return t;
  }
}

/// Rates a view: a good one reaches far all over its width, and nothing stands right before the
/// eye.
float view_score(const Rect& r, const std::vector<OrientedBox>& tall, const Vec2& eye,
                 const Vec2& at) {
  const float middle = std::atan2(at.y - eye.y, at.x - eye.x);
  float sum = 0, nearest = INFINITY;
  constexpr int kRays = 11;
  for (int i = 0; i < kRays; ++i) {
    const float angle = middle + 0.75f * (2 * static_cast<float>(i) / (kRays - 1) - 1);
    const float distance = free_distance(r, tall, eye, angle);
    sum += std::min(distance, 6.0f);
    nearest = std::min(nearest, distance);
  }
  return sum / kRays + 2 * std::min(nearest, 0.9f) + 0.5f * std::hypot(at.x - eye.x, at.y - eye.y);
}

}  // namespace

std::vector<scene::Camera> room_cameras(const HomePlan& plan) {
  std::vector<int> order;
  for (int room = 0; room < static_cast<int>(plan.floor.rooms.size()); ++room)
    order.push_back(room);
  const auto area = [&](int room) {
    const PlanRoom& r = plan.floor.rooms[static_cast<size_t>(room)];
    return r.type == RoomType::Corridor ? 0 : r.inner.area();
  };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return area(a) > area(b); });
  std::vector<scene::Camera> cameras;
  for (const int room : order) {
    const PlanRoom& r = plan.floor.rooms[static_cast<size_t>(room)];
    WalkGrid grid(r.inner);
    for (const PlacedPiece& piece : plan.pieces)
      if (piece.room == room) grid.block(piece.box);
    const std::vector<Vec2> steps = door_steps(plan.floor, room);
    const Vec2 at = subject(plan, room);
    const std::vector<OrientedBox> tall = tall_things(plan, room);
    float best = 0;
    Vec2 eye{};
    for (const Vec2& p : steps.empty() ? std::vector<Vec2>{} : grid.reachable(steps[0])) {
      if (std::hypot(p.x - at.x, p.y - at.y) < 0.5f) continue;
      const float score = view_score(r.inner, tall, p, at) + 4 * share_in_view(plan, room, p, at);
      if (score <= best) continue;
      best = score;
      eye = p;
    }
    if (best == 0) continue;
    cameras.push_back(
        {room_name(r.type), {eye.x, kEye, eye.y}, {at.x, kLook, at.y}, {0, 1, 0}, kVfov});
  }
  return cameras;
}

}  // namespace lte::datagen::homes
