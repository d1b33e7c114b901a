#include "datagen/wild/plan.h"

#include <algorithm>
#include <cmath>

#include "datagen/wild/ceiling.h"

namespace lte::datagen::wild {
namespace {

/// Lays cells side by side. The order of its steps is the order of the random draws.
class PlanMaker {
 public:
  PlanMaker(int least, int most, float unit, Dice* dice) : least_(least), most_(most), dice_(dice) {
    plan_.unit = unit;
    height_ = unit * dice->draw(0.45f, 0.95f);
  }

  Plan make() {
    plan_.kind = draw_kind();
    switch (plan_.kind) {
      case PlanKind::Single:
        start(any_shape());
        break;
      case PlanKind::L:
      case PlanKind::T:
      case PlanKind::U:
        letter();
        break;
      case PlanKind::Corridor:
        corridor();
        break;
      case PlanKind::Alcoves:
        alcoves();
        break;
      case PlanKind::Round:
        start(regular(dice_->count(12, 28), 0.5f * side()));
        branch(dice_->count(0, 2));
        break;
      case PlanKind::Enfilade:
        enfilade();
        break;
      case PlanKind::Cluster:
        start(any_shape());
        branch(dice_->count(1, 4));
        break;
    }
    return std::move(plan_);
  }

 private:
  PlanKind draw_kind() {
    for (;;) {
      const auto kind = static_cast<PlanKind>(dice_->pick(kShares.plans));
      const bool single = kind == PlanKind::Single, round = kind == PlanKind::Round;
      if (!single && !round && most_ < (kind == PlanKind::U ? 3 : 2)) continue;
      if (least_ > 1 && single) continue;
      return kind;
    }
  }
  int cells() const { return static_cast<int>(plan_.cells.size()); }
  bool full() const { return cells() >= most_; }
  float side() { return plan_.unit * dice_->log_draw(0.6f, 1.7f); }

  Polygon any_shape();
  void start(Polygon outline) { add(std::move(outline), height_, 0, std::nullopt); }
  int add(Polygon outline, float height, float floor, std::optional<CeilingKind> ceiling);
  bool attach(int parent, size_t edge, const Polygon& local, float start, OpeningKind kind,
              bool same_height);
  void branch(int wanted);
  void letter();
  void corridor();
  void alcoves();
  void enfilade();

  int least_, most_;
  Dice* dice_;
  Plan plan_;
  float height_;
};

Polygon PlanMaker::any_shape() {
  const float w = side(), d = side(), kind = dice_->draw(0, 1);
  if (kind < 0.6f) return rectangle(w, d);
  if (kind < 0.75f) {  // a trapezoid
    const float left = dice_->draw(0, 0.35f) * w, right = dice_->draw(0, 0.35f) * w;
    return {{0, 0}, {w, 0}, {w - right, d}, {left, d}};
  }
  if (kind < 0.9f) return regular(dice_->count(5, 8), 0.55f * w);
  const float cut = dice_->draw(0.2f, 0.7f);  // a rectangle that lacks a corner
  return {{0, 0}, {w, 0}, {w, d * (1 - cut)}, {w * (1 - cut), d}, {0, d}};
}

int PlanMaker::add(Polygon outline, float height, float floor, std::optional<CeilingKind> ceiling) {
  Cell cell;
  const auto kind = ceiling ? *ceiling : static_cast<CeilingKind>(dice_->pick(kShares.ceilings));
  cell.outline = std::move(outline);
  cell.floor = floor;
  cell.ceiling = make_ceiling(kind, cell.outline, floor + height, dice_);
  cell.holes.resize(cell.outline.size());
  plan_.cells.push_back(std::move(cell));
  return cells() - 1;
}

/// Puts a cell outside an edge of another.
/// @param local  its first edge runs from the origin along x
/// @param start  metres from the first corner of the parent's edge to its near end
/// @return  false if it would overlap a third cell or share too little with the parent
bool PlanMaker::attach(int parent, size_t index, const Polygon& local, float start,
                       OpeningKind kind, bool same_height) {
  if (full()) return false;
  const Edge edge = edge_of(plan_.cells[static_cast<size_t>(parent)].outline, index);
  const float width = edge_of(local, 0).length;
  const float u0 = std::max(0.0f, start), u1 = std::min(edge.length, start + width);
  if (u1 - u0 < 0.3f * std::min(width, edge.length)) return false;
  const std::vector<Vec2> top = plan_.cells[static_cast<size_t>(parent)].top_of(index);
  const bool level = std::all_of(
      top.begin(), top.end(), [&](const Vec2& p) { return std::abs(p.y - top.front().y) < 1e-4f; });
  const bool sheet = level && (same_height || dice_->chance(kShares.sheet_walls));
  const float thickness =
      sheet ? 0 : dice_->log_draw(kShares.thickness_m[0], kShares.thickness_m[1]);
  const Vec2 origin = edge.at(start + width) - edge.inward * thickness;
  Polygon outline;
  for (const Vec2& p : local) outline.push_back(origin - edge.along * p.x - edge.inward * p.y);
  for (int i = 0; i < cells(); ++i) {
    const Polygon& other = plan_.cells[static_cast<size_t>(i)].outline;
    if (!apart(outline, other, i == parent ? thickness - 1e-3f : 0.03f)) return false;
  }
  const Cell& from = plan_.cells[static_cast<size_t>(parent)];
  float height = from.ceiling.eaves - from.floor, floor = from.floor;
  std::optional<CeilingKind> ceiling;
  if (same_height) {
    if (from.ceiling.kind == CeilingKind::Flat) ceiling = CeilingKind::Flat;
  } else {
    if (dice_->chance(kShares.other_height)) height = height_ * dice_->draw(0.7f, 1.5f);
    if (dice_->chance(kShares.step)) floor += 0.1f * plan_.unit * dice_->draw(-1, 1);
  }
  const int child = add(std::move(outline), height, floor, ceiling);
  plan_.links.push_back({parent, child, index, u0, u1, thickness, kind});
  return true;
}

void PlanMaker::branch(int wanted) {
  for (int i = 0, tries = 0; i < wanted && tries < 12; ++tries) {
    const int parent = dice_->count(0, cells() - 1);
    const Polygon& outline = plan_.cells[static_cast<size_t>(parent)].outline;
    const size_t edge = dice_->rng.below(outline.size());
    const Polygon local = any_shape();
    const float room = edge_of(outline, edge).length - edge_of(local, 0).length;
    const auto joint = static_cast<OpeningKind>(dice_->pick(kShares.joints));
    if (attach(parent, edge, local, room * dice_->draw(-0.1f, 1.1f), joint, false)) ++i;
  }
}

/// A bar and one or two legs on its far side, joined by all that they share.
void PlanMaker::letter() {
  const float bar = 1.3f * side(), breadth = side() * 0.8f;
  start(rectangle(bar, breadth));
  const bool same = dice_->chance(0.75f), u = plan_.kind == PlanKind::U;
  const bool narrowed = !same && dice_->chance(0.5f);
  const OpeningKind joint = narrowed ? OpeningKind::Wide : OpeningKind::Whole;
  const float leg = bar * dice_->draw(0.2f, u ? 0.4f : 0.6f);
  const auto add_leg = [&](float at, float width) {
    attach(0, 2, rectangle(width, side()), at * (bar - width), joint, same);
  };
  if (plan_.kind == PlanKind::T) {
    add_leg(dice_->draw(0.3f, 0.7f), leg);
  } else {
    add_leg(dice_->chance(0.5f) || u ? 0.0f : 1.0f, leg);
    if (u) add_leg(1, bar * dice_->draw(0.2f, 0.4f));
  }
}

void PlanMaker::corridor() {
  const float width = plan_.unit * dice_->draw(0.22f, 0.45f), length = 1.5f * side() + width;
  start(rectangle(length, width));
  int last = 0;
  if (dice_->chance(0.5f)) {  // round a corner
    const float turn = std::max(width, plan_.unit * dice_->draw(0.22f, 0.45f));
    if (attach(0, 2, rectangle(turn, side()), dice_->chance(0.5f) ? 0 : length - turn,
               OpeningKind::Whole, true))
      last = 1;
  }
  const int rooms = dice_->count(last == 0 ? 1 : 0, 4);
  for (int i = 0, tries = 0; i < rooms && tries < 12; ++tries) {
    const int parent = dice_->count(0, last);
    const size_t edge = dice_->rng.below(4);
    const Edge wall = edge_of(plan_.cells[static_cast<size_t>(parent)].outline, edge);
    const float w = side(), room = wall.length - w;
    const auto joint = static_cast<OpeningKind>(dice_->pick(kShares.joints));
    if (attach(parent, edge, rectangle(w, side()), room * dice_->draw(0, 1), joint, false)) ++i;
  }
}

void PlanMaker::alcoves() {
  start(rectangle(1.2f * side(), side()));
  const int wanted = dice_->count(1, 3);
  for (int i = 0, tries = 0; i < wanted && tries < 9; ++tries) {
    const size_t edge = dice_->rng.below(4);
    const float length = edge_of(plan_.cells[0].outline, edge).length;
    const float width = length * dice_->draw(0.2f, 0.6f),
                depth = plan_.unit * dice_->draw(0.08f, 0.4f);
    const bool same = dice_->chance(0.5f);
    const OpeningKind joint = dice_->chance(0.7f) ? OpeningKind::Whole : OpeningKind::Arch;
    if (attach(0, edge, rectangle(width, depth), dice_->draw(0, 1) * (length - width), joint, same))
      ++i;
  }
}

void PlanMaker::enfilade() {
  start(rectangle(side(), side()));
  const int wanted = dice_->count(1, 4);
  for (int i = 0; i < wanted; ++i) {
    const float length = edge_of(plan_.cells.back().outline, 2).length, w = side();
    const auto joint = static_cast<OpeningKind>(dice_->pick(kShares.joints));
    attach(cells() - 1, 2, rectangle(w, side()), (length - w) * dice_->draw(0.2f, 0.8f), joint,
           false);
  }
}

}  // namespace

bool Cell::rectangular() const {
  if (outline.size() != 4) return false;
  for (size_t i = 0; i < 4; ++i)
    if (std::abs(dot(edge_of(outline, i).along, edge_of(outline, (i + 1) % 4).along)) > 1e-3f)
      return false;
  return true;
}

bool Cell::is_wall(size_t edge, float u0, float u1, float low, float high, float margin) const {
  return std::none_of(holes[edge].begin(), holes[edge].end(), [&](const Hole& hole) {
    float top = hole.low;
    for (const Vec2& p : hole.top) top = std::max(top, p.y);
    return hole.u0 < u1 + margin && hole.u1 > u0 - margin && hole.low < high + margin &&
           top > low - margin;
  });
}

float Plan::floor_area() const {
  float sum = 0;
  for (const Cell& cell : cells) sum += area_of(cell.outline);
  return sum;
}

Plan make_plan(int min_cells, int max_cells, float unit, Dice* dice) {
  return PlanMaker(min_cells, max_cells, unit, dice).make();
}

}  // namespace lte::datagen::wild
