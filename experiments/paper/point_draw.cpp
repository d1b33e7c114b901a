#include "experiments/paper/point_draw.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <ATen/ATen.h>

#include "lte/data/light_groups.h"
#include "lte/ops/farthest_point.h"
#include "lte/ops/knn.h"
#include "lte/pathtrace/light_estimates.h"

namespace lte::experiments {
namespace {

constexpr int kPaths = 8;          // a side of a candidate, of Light
constexpr double kMinLight = 0.1;  // of the mean, so that dark places are not empty

using Samples = scene::SurfaceSamples;

double triangle_area(const scene::Scene& scene, int instance, uint32_t triangle) {
  const scene::Instance& placed = scene.instances[static_cast<size_t>(instance)];
  const scene::Mesh& mesh = scene.meshes[static_cast<size_t>(placed.mesh)];
  const auto& corners = mesh.triangles[triangle];
  const auto corner = [&](size_t i) { return placed.to_world.point(mesh.positions[corners[i]]); };
  const Vec3 p = corner(0);
  return 0.5 * length(cross(corner(1) - p, corner(2) - p));
}

double instance_area(const scene::Scene& scene, int instance) {
  const scene::Instance& placed = scene.instances[static_cast<size_t>(instance)];
  double sum = 0;
  for (size_t i = 0; i < scene.meshes[static_cast<size_t>(placed.mesh)].triangles.size(); ++i)
    sum += triangle_area(scene, instance, static_cast<uint32_t>(i));
  return sum;
}

/// The hit on the surface that a candidate was drawn on.
pathtrace::Hit under(const pathtrace::Bvh& bvh, const Vec3& position, const Vec3& normal) {
  const float reach = 1e-3f;
  return bvh.intersect({position + normal * reach, normal * -1.0f, 0, 2 * reach});
}

/// Of Triangles and SmallObjects: over an area, which the density by area is then in proportion to.
std::vector<double> area_weights(PointDraw draw, const pathtrace::Bvh& bvh, const Samples& points,
                                 std::span<const size_t> rows) {
  const scene::Scene& scene = bvh.scene();
  std::vector<double> objects(scene.instances.size(), 0), out;
  for (const size_t i : rows) {
    const pathtrace::Hit hit = under(bvh, points.position[i], points.normal[i]);
    if (!hit.valid()) {
      out.push_back(0);  // filled in below: a crack between triangles
    } else if (draw == PointDraw::Triangles) {
      out.push_back(1 / std::max(1e-8, triangle_area(scene, hit.instance, hit.triangle)));
    } else {
      double& area = objects[static_cast<size_t>(hit.instance)];
      if (area == 0) area = std::max(1e-8, instance_area(scene, hit.instance));
      out.push_back(1 / std::sqrt(area));
    }
  }
  const double mean =
      std::accumulate(out.begin(), out.end(), 0.0) / static_cast<double>(out.size());
  for (double& weight : out) weight = weight > 0 ? weight : mean;
  return out;
}

std::vector<double> light_weights(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                                  const Samples& points, std::span<const size_t> rows,
                                  uint64_t seed) {
  const pathtrace::LightEstimates light =
      pathtrace::estimate_light(bvh, lights, points.position, points.normal, points.emission,
                                {.paths = kPaths, .max_depth = 5, .seed = seed});
  const std::vector<Rgb> direct = data::sum_groups(light.direct, lights.groups(), 1),
                         indirect = data::sum_groups(light.indirect, lights.groups(), 1);
  std::vector<double> out;
  for (const size_t i : rows) out.push_back(luminance(direct[i] + indirect[i]));
  const double mean =
      std::accumulate(out.begin(), out.end(), 0.0) / static_cast<double>(out.size());
  for (double& weight : out) weight = mean > 0 ? weight + kMinLight * mean : 1;
  return out;
}

at::Tensor positions_of(const Samples& points, std::span<const size_t> rows) {
  at::Tensor out = at::empty({static_cast<int64_t>(rows.size()), 3}, at::kFloat);
  auto* to = reinterpret_cast<Vec3*>(out.data_ptr<float>());
  for (size_t i = 0; i < rows.size(); ++i) to[i] = points.position[rows[i]];
  return out;
}

/// Rows that farthest point sampling picks, and the area of the candidates nearest to each.
std::vector<std::pair<size_t, float>> farthest(const Samples& points, std::span<const size_t> rows,
                                               int64_t count) {
  const at::Tensor position = positions_of(points, rows);
  const at::Tensor picks = std::get<0>(
      ops::farthest_point_sampling(position, std::min(count, static_cast<int64_t>(rows.size()))));
  const at::Tensor nearest =
      std::get<0>(ops::knn(position, position.index_select(0, picks), 1)).select(1, 0);
  std::vector<std::pair<size_t, float>> out;
  for (int64_t i = 0; i < picks.size(0); ++i)
    out.emplace_back(rows[static_cast<size_t>(picks[i].item<int64_t>())], 0.0f);
  const auto owner = nearest.accessor<int64_t, 1>();
  for (size_t i = 0; i < rows.size(); ++i)
    out[static_cast<size_t>(owner[static_cast<int64_t>(i)])].second += points.area[rows[i]];
  return out;
}

/// Rows with the area that each stands for.
std::vector<std::pair<size_t, float>> thinned(const Samples& points, std::span<const size_t> rows,
                                              std::span<const double> weights, int64_t count,
                                              Rng* rng) {
  std::vector<std::pair<size_t, float>> out;
  if (rows.empty()) return out;
  std::vector<double> probability;
  for (const size_t pick : draw_weighted(weights, count, rng, &probability))
    out.emplace_back(rows[pick], static_cast<float>(points.area[rows[pick]] / probability[pick]));
  return out;
}

}  // namespace

std::vector<size_t> draw_weighted(std::span<const double> weights, int64_t count, Rng* rng,
                                  std::vector<double>* probability) {
  // The factor that brings the sum of min(1, factor · weight) to the count.
  probability->assign(weights.size(), 1);
  std::vector<size_t> picks;
  if (count < static_cast<int64_t>(weights.size())) {
    double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    double room = static_cast<double>(count);
    std::vector<bool> certain(weights.size(), false);
    for (bool changed = true; changed && sum > 0;) {
      changed = false;
      const double factor = room / sum;
      for (size_t i = 0; i < weights.size(); ++i) {
        if (certain[i] || factor * weights[i] < 1) continue;
        certain[i] = changed = true;
        sum -= weights[i];
        room -= 1;
      }
    }
    for (size_t i = 0; i < weights.size(); ++i)
      if (!certain[i]) (*probability)[i] = sum > 0 ? room / sum * weights[i] : 0;
  }
  double passed = rng->uniform();
  for (size_t i = 0; i < weights.size(); ++i) {
    passed += (*probability)[i];
    if (passed < 1) continue;
    passed -= 1;
    picks.push_back(i);
  }
  return picks;
}

scene::SurfaceSamples draw_points(PointDraw draw, const pathtrace::Bvh& bvh,
                                  const pathtrace::Lights& lights,
                                  const scene::SurfaceSamples& candidates, int64_t count,
                                  uint64_t seed) {
  std::vector<size_t> surfaces, luminaires;
  for (size_t i = 0; i < candidates.position.size(); ++i)
    (candidates.light_group[i] == scene::kNone ? surfaces : luminaires).push_back(i);
  const double kept =
      std::min(1.0, static_cast<double>(count) / static_cast<double>(candidates.position.size()));
  const auto share = [&](const std::vector<size_t>& rows) {
    return std::llround(kept * static_cast<double>(rows.size()));
  };
  Rng rng(seed);
  std::vector<std::pair<size_t, float>> rows =
      thinned(candidates, luminaires, std::vector<double>(luminaires.size(), 1),
              std::max<int64_t>(1, share(luminaires)), &rng);
  std::vector<std::pair<size_t, float>> more;
  if (draw == PointDraw::Farthest) {
    more = farthest(candidates, surfaces, share(surfaces));
  } else {
    std::vector<double> weights(surfaces.size(), 1);
    if (draw == PointDraw::Light) {
      weights = light_weights(bvh, lights, candidates, surfaces, seed);
    } else if (draw != PointDraw::Area) {
      weights = area_weights(draw, bvh, candidates, surfaces);
    }
    more = thinned(candidates, surfaces, weights, share(surfaces), &rng);
  }
  rows.insert(rows.end(), more.begin(), more.end());
  std::ranges::sort(rows);
  std::vector<size_t> order;
  for (const auto& row : rows) order.push_back(row.first);
  scene::SurfaceSamples out = candidates;
  out.keep(order);
  for (size_t i = 0; i < rows.size(); ++i) out.area[i] = rows[i].second;
  return out;
}

}  // namespace lte::experiments
