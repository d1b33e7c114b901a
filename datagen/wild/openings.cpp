#include "datagen/wild/openings.h"

#include <algorithm>
#include <cmath>

namespace lte::datagen::wild {
namespace {

struct Frame {
  float u0, u1, low, high;
};

std::vector<Vec2> arch_top(const Frame& f) {
  constexpr int kSteps = 10;
  const float middle = 0.5f * (f.u0 + f.u1), half = 0.5f * (f.u1 - f.u0),
              rise = std::min(half, 0.7f * (f.high - f.low));
  std::vector<Vec2> top;
  for (int i = 0; i <= kSteps; ++i) {
    const float a = kPi * (1 - static_cast<float>(i) / kSteps);
    top.push_back({middle + half * std::cos(a), f.high - rise + rise * std::sin(a)});
  }
  top.front().x = f.u0;
  top.back().x = f.u1;
  top.front().y = top.back().y = f.high - rise;
  return top;
}

/// Draws where an opening of a kind is within the part of a wall that is free for it.
Frame draw_frame(OpeningKind kind, const Frame& room, float unit, Dice* dice) {
  const float width = room.u1 - room.u0, height = room.high - room.low, scale = unit / 4;
  float w = width, h = height, low = room.low;
  switch (kind) {
    case OpeningKind::Wide:
      w = width * dice->draw(0.4f, 0.95f);
      if (dice->chance(0.5f)) h = height * dice->draw(0.75f, 0.97f);
      break;
    case OpeningKind::Door:
    case OpeningKind::Ajar:
      w = scale * dice->draw(0.7f, 1.1f);
      h = std::min(height * 0.97f, scale * dice->draw(1.9f, 2.3f));
      break;
    case OpeningKind::Arch:
      w = width * dice->draw(0.3f, 0.9f);
      h = height * dice->draw(0.6f, 0.95f);
      break;
    case OpeningKind::Slit:
      if (dice->chance(0.7f)) {
        w = scale * dice->log_draw(0.03f, 0.3f);
        h = height * dice->draw(0.5f, 0.95f);
        low += dice->draw(0, height - h);
      } else {
        w = width * dice->draw(0.4f, 0.9f);
        h = scale * dice->log_draw(0.03f, 0.3f);
        low += dice->draw(0.1f, 0.9f) * (height - h);
      }
      break;
    case OpeningKind::Hatch:
    case OpeningKind::Window:
      w = width * dice->draw(0.15f, 0.85f);
      h = height * dice->draw(0.25f, 0.75f);
      low += dice->draw(0.1f, 0.9f) * (height - h);
      break;
    case OpeningKind::Whole:
    case OpeningKind::Missing:
      break;
  }
  w = std::min(w, width);
  h = std::min(h, height);
  const float at = room.u0 + dice->draw(0, 1) * (width - w);
  return {at, at + w, low, low + h};
}

Hole hole_of(OpeningKind kind, const Frame& frame) {
  Hole hole;
  hole.kind = kind;
  hole.u0 = frame.u0;
  hole.u1 = frame.u1;
  hole.low = frame.low;
  hole.top = kind == OpeningKind::Arch
                 ? arch_top(frame)
                 : std::vector<Vec2>{{frame.u0, frame.high}, {frame.u1, frame.high}};
  return hole;
}

float lowest(const std::vector<Vec2>& line, float u0, float u1) {
  float low = std::min(height_on(line, u0), height_on(line, u1));
  for (const Vec2& p : line)
    if (p.x > u0 && p.x < u1) low = std::min(low, p.y);
  return low;
}

/// The same hole, seen from the other side: u counts from the other corner.
Hole mirrored(const Hole& hole, float sum) {
  Hole out = hole;
  out.u0 = sum - hole.u1;
  out.u1 = sum - hole.u0;
  out.top.clear();
  for (auto p = hole.top.rbegin(); p != hole.top.rend(); ++p) out.top.push_back({sum - p->x, p->y});
  out.reveal = false;
  return out;
}

void join(const Link& link, Plan* plan, Dice* dice) {
  Cell &a = plan->cells[static_cast<size_t>(link.a)], &b = plan->cells[static_cast<size_t>(link.b)];
  const Edge wall = edge_of(a.outline, link.edge), back = edge_of(b.outline, 0);
  // u of b is sum − u of a.
  const float sum = dot(back.from - wall.from, wall.along);
  const std::vector<Vec2> top_a = a.top_of(link.edge), top_b = b.top_of(0);
  const float high = std::min(lowest(top_a, link.u0, link.u1),
                              lowest(top_b, sum - link.u1, sum - link.u0)),
              low = std::max(a.floor, b.floor);
  if (high - low > 0.05f * plan->unit) {
    Hole hole =
        hole_of(link.kind, draw_frame(link.kind, {link.u0, link.u1, low, high}, plan->unit, dice));
    hole.depth = link.thickness;
    hole.other = link.b;
    hole.reveal = link.thickness > 0;
    a.holes[link.edge].push_back(hole);
    hole.other = link.a;
    if (link.thickness > 0) b.holes[0].push_back(mirrored(hole, sum));
  }
  if (link.thickness > 0) return;
  Hole gone = hole_of(OpeningKind::Whole, {link.u0, link.u1, a.floor, top_a.front().y});
  gone.other = link.a;
  b.holes[0].push_back(mirrored(gone, sum));
}

/// The parts of an edge of `cell` that no other cell lies behind.
bool is_outer(const Plan& plan, size_t cell, size_t edge) {
  for (const Link& link : plan.links) {
    if (static_cast<size_t>(link.a) == cell && link.edge == edge) return false;
    if (static_cast<size_t>(link.b) == cell && edge == 0) return false;
  }
  // Not into the wall of a neighbour that happens to stand there.
  const Edge wall = edge_of(plan.cells[cell].outline, edge);
  const float out = 0.25f * plan.unit;
  for (const Cell& other : plan.cells) {
    if (&other == &plan.cells[cell]) continue;
    for (const float t : {0.02f, 0.25f, 0.5f, 0.75f, 0.98f})
      for (const float d : {0.1f, 0.5f, 1.0f})
        if (inside(other.outline, wall.at(t * wall.length) - wall.inward * (d * out), 0))
          return false;
  }
  return true;
}

void open_outwards(bool sky, size_t index, Plan* plan, Dice* dice) {
  Cell& cell = plan->cells[index];
  const bool lacks_wall = dice->chance(kShares.missing_wall * (sky ? 2.0f : 1.0f));
  const size_t missing = dice->rng.below(cell.outline.size());
  const bool round = cell.outline.size() > 8;
  for (size_t e = 0; e < cell.outline.size(); ++e) {
    const float share = (sky ? 0.6f : kShares.window) * (round ? 0.3f : 1.0f);
    const bool window = dice->chance(share), wanted = window || (lacks_wall && e == missing);
    if (!wanted || !is_outer(*plan, index, e)) continue;
    const std::vector<Vec2> top = cell.top_of(e);
    const Edge wall = edge_of(cell.outline, e);
    if (lacks_wall && e == missing) {
      Hole hole = hole_of(OpeningKind::Missing, {0, wall.length, cell.floor, 0});
      hole.top = top;
      cell.holes[e].push_back(hole);
      continue;
    }
    const float margin = 0.03f * wall.length;
    const Frame room{margin, wall.length - margin, cell.floor,
                     lowest(top, margin, wall.length - margin) - 0.02f * plan->unit};
    if (room.high - room.low < 0.15f * plan->unit) continue;
    const std::array<float, 3> kinds{0.7f, 0.15f, 0.15f};
    constexpr OpeningKind kKinds[] = {OpeningKind::Window, OpeningKind::Arch, OpeningKind::Slit};
    const OpeningKind kind = kKinds[dice->pick(kinds)];
    Hole hole = hole_of(kind, draw_frame(kind, room, plan->unit, dice));
    hole.depth = dice->chance(0.3f) ? 0 : plan->unit * dice->draw(0.01f, 0.1f);
    hole.reveal = hole.depth > 0;
    cell.holes[e].push_back(hole);
  }
}

}  // namespace

void cut_openings(bool sky, Plan* plan, Dice* dice) {
  for (const Link& link : plan->links) join(link, plan, dice);
  for (size_t i = 0; i < plan->cells.size(); ++i) open_outwards(sky, i, plan, dice);
}

}  // namespace lte::datagen::wild
