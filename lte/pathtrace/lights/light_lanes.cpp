#include "lte/pathtrace/lights/light_lanes.h"

#include <algorithm>
#include <span>

namespace lte::pathtrace {

void sample_light_lanes(const Lights& lights, const Lanes3& position, const Lanes3& normal,
                        const LightNumbers& numbers, int count, LightBlock* out) {
  const std::vector<EmissiveTriangle>& triangles = lights.triangles_;
  const float environment_share = lights.environment_share_;
  alignas(64) uint32_t entry[kBlock] = {};
  alignas(64) float probability[kBlock] = {};
  int others[kBlock], other_count = 0;
  if (!lights.uses_tree_ && lights.only_plain_triangles_ && environment_share == 0) {
    draw_entries(lights.table_.columns(), numbers.choice, count, entry, probability);
  } else {
    thread_local LightTreeWalk walk;
    Vec3 point, side;
    for (int lane = 0; lane < count; ++lane) {
      if (lane == 0 || position.at(lane) != point || normal.at(lane) != side) {
        point = position.at(lane);
        side = normal.at(lane);
        walk.start(lights.tree_, point, side);
      }
      double u = numbers.choice[lane] * 0x1p-32;
      bool other = u < environment_share;
      if (!other) {
        u = (u - environment_share) / (1 - environment_share);
        const bool chosen = !lights.table_.empty() &&
                            lights.choose(point, side, u, &entry[lane], &probability[lane], &walk);
        other = chosen && (entry[lane] >= triangles.size() || triangles[entry[lane]].textured);
        probability[lane] *= 1 - environment_share;
        if (chosen && !other) continue;
      }
      if (other) others[other_count++] = lane;  // drawn again below, from the same numbers
      entry[lane] = 0;
      probability[lane] = 0;
    }
  }
  if (triangles.empty()) {
    std::fill_n(out->pdf, count, 0.0f);
  } else {
    sample_triangles(lights.triangle_lights_.data(), entry, probability, numbers.point_x,
                     numbers.point_y, count, position, out);
    for (int lane = 0; lane < count; ++lane)
      out->light_group[lane] = triangles[entry[lane]].light_group;
  }
  for (const int lane : std::span(others, static_cast<size_t>(other_count))) {
    const LightSample light =
        lights.sample_in_frame(position.at(lane), normal.at(lane), numbers.choice[lane] * 0x1p-32,
                               {to_unit(numbers.point_x[lane]), to_unit(numbers.point_y[lane])});
    out->direction.put(lane, light.direction);
    out->radiance.put(lane, light.radiance);
    out->distance[lane] = light.distance;
    out->pdf[lane] = !(light.pdf > 0) ? 0.0f : light.delta ? -light.pdf : light.pdf;
    out->light_group[lane] = light.light_group;
  }
}

}  // namespace lte::pathtrace
