#include "datagen/wild/lamps.h"

#include <algorithm>
#include <cmath>

#include "datagen/wild/lamp_maker.h"
#include "datagen/wild/shell.h"

namespace lte::datagen::wild {
namespace {

constexpr int kTries = 24;  // of kind and place, for one lamp

/// A cell, larger ones more often.
int draw_cell(const Plan& plan, Dice* dice) {
  float target = dice->draw(0, plan.floor_area());
  for (size_t i = 0; i + 1 < plan.cells.size(); ++i)
    if ((target -= area_of(plan.cells[i].outline)) < 0) return static_cast<int>(i);
  return static_cast<int>(plan.cells.size()) - 1;
}

}  // namespace

void place_lamps(int wanted, Builder* builder, homes::Kit* kit, Dice* dice) {
  LampMaker maker(builder, kit, dice);
  const Plan& plan = *builder->plan;
  const bool one_cell = plan.cells.size() > 1 && dice->chance(kShares.elsewhere);
  const int only = static_cast<int>(dice->rng.below(plan.cells.size()));
  // Many lamps of one kind, as in a hall, or each of its own.
  const bool alike = wanted > 3 && dice->chance(0.5f);
  const auto same = static_cast<LampKind>(dice->pick(kShares.lamps));
  for (int i = 0; i < wanted; ++i) {
    builder->next_group();
    bool placed = false;
    for (int tries = 0; tries < kTries && !placed; ++tries) {
      const auto kind =
          alike && tries < kTries / 2 ? same : static_cast<LampKind>(dice->pick(kShares.lamps));
      placed = maker.place(kind, one_cell ? only : draw_cell(plan, dice));
    }
    if (!placed) builder->drop_group();
  }
  builder->group = scene::kNone;
}

void set_powers(float watts, Builder* builder, Dice* dice) {
  std::vector<float> shares;
  float sum = 0;
  for (size_t i = 0; i < builder->lamps.size(); ++i) {
    shares.push_back(dice->log_draw(1 / kShares.unequal, kShares.unequal));
    sum += shares.back();
  }
  for (size_t i = 0; i < builder->lamps.size(); ++i) {
    const Lamp& lamp = builder->lamps[i];
    if (lamp.power <= 0) continue;
    const float factor = watts * shares[i] / sum / lamp.power;
    for (const int m : lamp.materials)
      builder->scene->materials[static_cast<size_t>(m)].emission *= factor;
    for (const size_t light : lamp.lights) builder->scene->lights[light].intensity *= factor;
  }
}

void close_windows(Builder* builder, Dice* dice) {
  for (Cell& cell : builder->plan->cells) {
    for (size_t e = 0; e < cell.holes.size(); ++e) {
      for (Hole& hole : cell.holes[e]) {
        if (hole.other >= 0 || hole.kind == OpeningKind::Missing || hole.closed) continue;
        if (!dice->chance(0.7f)) continue;
        hole.closed = true;
        builder->add(pane_mesh(edge_of(cell.outline, e), hole), builder->materials->thing(), {},
                     "pane");
      }
    }
  }
}

}  // namespace lte::datagen::wild
