#include "datagen/wild/sky.h"

#include <algorithm>
#include <cmath>

#include "datagen/common/daylight.h"

namespace lte::datagen::wild {
namespace {

/// Horizontal directions out of the openings.
std::vector<Vec3> ways_out(const Plan& plan) {
  std::vector<Vec3> out;
  for (const Cell& cell : plan.cells) {
    for (size_t e = 0; e < cell.holes.size(); ++e)
      for (const Hole& hole : cell.holes[e])
        if (hole.other < 0 && !hole.closed)
          out.push_back(in_space(edge_of(cell.outline, e).inward * -1.0f, 0));
    if (cell.ceiling.kind == CeilingKind::None)
      out.push_back(in_space(edge_of(cell.outline, 0).inward, 0));
  }
  return out;
}

}  // namespace

bool is_open(const Plan& plan) { return !ways_out(plan).empty(); }

void add_sky_and_sun(Builder* builder, Dice* dice) {
  const std::vector<Vec3> ways = ways_out(*builder->plan);
  const Vec3 out = ways.at(dice->rng.below(ways.size()));
  const Rgb radiance = light_tint(dice->draw(0, 0.5f)) * dice->log_draw(1, 30);
  Daylight light = daylight(radiance, out, &dice->rng);
  if (dice->chance(kShares.sun)) add_sun(&light, &dice->rng, builder->scene);
  add_sky(light, kShares.sky_picture, &dice->rng, builder->scene);
}

}  // namespace lte::datagen::wild
