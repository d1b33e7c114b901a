#include "infer/bench/pareto/texel_atlas.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

#include "lte/base/check.h"

namespace lte::infer {
namespace {

constexpr int kApart = 2;       // texels between charts
constexpr float kReach = 1.0f;  // texels beyond its surface that a texel may lie
constexpr int64_t kMostTexels = int64_t{1} << 26;

struct Triangle {
  std::array<Vec3, 3> corner;  ///< world
  Vec3 normal;                 ///< unit, front
  double area = 0;
  int axis = 0;  ///< 2 * axis, and 1 more where the normal points down it
};

/// One instance's triangles that have an area.
std::vector<Triangle> triangles_of(const scene::Scene& scene, const scene::Instance& instance) {
  const scene::Mesh& mesh = scene.meshes[static_cast<size_t>(instance.mesh)];
  const bool mirrored = instance.to_world.determinant() < 0;
  std::vector<Triangle> out;
  for (const auto& corners : mesh.triangles) {
    Triangle t;
    for (size_t k = 0; k < 3; ++k)
      t.corner[k] = instance.to_world.point(mesh.positions[corners[k]]);
    if (mirrored) std::swap(t.corner[1], t.corner[2]);
    const Vec3 across = cross(t.corner[1] - t.corner[0], t.corner[2] - t.corner[0]);
    const float twice = length(across);
    if (!(twice > 0) || !std::isfinite(twice)) continue;
    t.area = 0.5 * double{twice};
    t.normal = across * (1 / twice);
    for (int k = 1; k < 3; ++k)
      if (std::fabs(t.normal[k]) > std::fabs(t.normal[t.axis])) t.axis = k;
    t.axis = 2 * t.axis + (t.normal[t.axis] < 0 ? 1 : 0);
    out.push_back(t);
  }
  return out;
}

/// The chart of each triangle, numbered from 0: those that share corners and the axis.
std::vector<int> connect(const std::vector<Triangle>& triangles) {
  std::vector<int> parent(triangles.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int i) {
    while (parent[static_cast<size_t>(i)] != i) {
      int& up = parent[static_cast<size_t>(i)];
      up = parent[static_cast<size_t>(up)];
      i = up;
    }
    return i;
  };
  std::map<std::tuple<float, float, float, int>, int> first;
  for (size_t i = 0; i < triangles.size(); ++i) {
    for (const Vec3& p : triangles[i].corner) {
      const auto [at, is_new] =
          first.try_emplace({p.x, p.y, p.z, triangles[i].axis}, static_cast<int>(i));
      if (!is_new) parent[static_cast<size_t>(root(static_cast<int>(i)))] = root(at->second);
    }
  }
  std::map<int, int> number;
  std::vector<int> out;
  for (size_t i = 0; i < triangles.size(); ++i) {
    const int chart = root(static_cast<int>(i));
    out.push_back(number.try_emplace(chart, static_cast<int>(number.size())).first->second);
  }
  return out;
}

struct Chart {
  int axis = 0;
  std::vector<Triangle> triangles;
  float low_u = INFINITY, low_v = INFINITY, high_u = -INFINITY, high_v = -INFINITY;
  int width = 0, height = 0, x = 0, y = 0;  ///< in the atlas

  /// Along the two other axes.
  Vec2 flat(const Vec3& p) const { return {p[(axis / 2 + 1) % 3], p[(axis / 2 + 2) % 3]}; }
};

std::vector<Chart> charts_of(const scene::Scene& scene, double* area) {
  std::vector<Chart> out;
  for (const scene::Instance& instance : scene.instances) {
    const std::vector<Triangle> triangles = triangles_of(scene, instance);
    const std::vector<int> numbers = connect(triangles);
    const size_t first = out.size();
    for (size_t i = 0; i < triangles.size(); ++i) {
      const size_t at = first + static_cast<size_t>(numbers[i]);
      if (at >= out.size()) out.resize(at + 1);
      Chart& chart = out[at];
      chart.axis = triangles[i].axis;
      chart.triangles.push_back(triangles[i]);
      *area += triangles[i].area;
      for (const Vec3& p : triangles[i].corner) {
        const Vec2 q = chart.flat(p);
        chart.low_u = std::min(chart.low_u, q.x);
        chart.low_v = std::min(chart.low_v, q.y);
        chart.high_u = std::max(chart.high_u, q.x);
        chart.high_v = std::max(chart.high_v, q.y);
      }
    }
  }
  return out;
}

/// Puts charts onto shelves, the highest first.
void pack(float edge, std::vector<Chart>* charts, TexelAtlas* atlas) {
  int64_t area = 0;
  int widest = 1;
  for (Chart& chart : *charts) {
    chart.width = static_cast<int>(std::ceil((chart.high_u - chart.low_u) / edge)) + 1;
    chart.height = static_cast<int>(std::ceil((chart.high_v - chart.low_v) / edge)) + 1;
    area += int64_t{chart.width + kApart} * (chart.height + kApart);
    widest = std::max(widest, chart.width);
  }
  LTE_CHECK(area <= kMostTexels, "a light map of ", area, " texels is too large: at most ",
            kMostTexels);
  atlas->width = std::max(widest + kApart, static_cast<int>(std::sqrt(static_cast<double>(area))));
  std::vector<Chart*> order;
  for (Chart& chart : *charts) order.push_back(&chart);
  std::stable_sort(order.begin(), order.end(),
                   [](const Chart* a, const Chart* b) { return a->height > b->height; });
  int x = 0, shelf = 0, tall = 0;
  for (Chart* chart : order) {
    if (x + chart->width > atlas->width) {
      shelf += tall + kApart;
      x = tall = 0;
    }
    chart->x = x;
    chart->y = shelf;
    x += chart->width + kApart;
    tall = std::max(tall, chart->height);
  }
  atlas->height = shelf + tall;
}

/// The barycentrics of the point of a flat triangle that is nearest to `p`, and its squared
/// distance.
float nearest_point(const std::array<Vec2, 3>& flat, const Vec2& p, std::array<float, 3>* weight) {
  const auto cross2 = [](const Vec2& a, const Vec2& b) { return a.x * b.y - a.y * b.x; };
  const auto minus = [](const Vec2& a, const Vec2& b) { return Vec2{a.x - b.x, a.y - b.y}; };
  const float whole = cross2(minus(flat[1], flat[0]), minus(flat[2], flat[0]));
  std::array<float, 3> inside{};
  bool is_inside = whole != 0;
  for (size_t k = 0; k < 3 && is_inside; ++k) {
    const Vec2 &a = flat[(k + 1) % 3], &b = flat[(k + 2) % 3];
    inside[k] = cross2(minus(b, a), minus(p, a)) / whole;
    is_inside = inside[k] >= 0;
  }
  if (is_inside) {
    *weight = inside;
    return 0;
  }
  float best = INFINITY;
  for (size_t k = 0; k < 3; ++k) {
    const Vec2 &a = flat[k], &b = flat[(k + 1) % 3];
    const Vec2 along = minus(b, a), to = minus(p, a);
    const float squared = along.x * along.x + along.y * along.y;
    const float t =
        squared > 0 ? std::clamp((along.x * to.x + along.y * to.y) / squared, 0.0f, 1.0f) : 0.0f;
    const Vec2 off{to.x - t * along.x, to.y - t * along.y};
    const float distance = off.x * off.x + off.y * off.y;
    if (distance >= best) continue;
    best = distance;
    *weight = {};
    (*weight)[k] = 1 - t;
    (*weight)[(k + 1) % 3] = t;
  }
  return best;
}

/// The texels of a chart: of its triangles, the nearest to each.
void fill(const Chart& chart, TexelAtlas* atlas) {
  struct Texel {
    float distance = INFINITY;
    Vec3 position, normal;
  };
  const float edge = atlas->edge;
  std::vector<Texel> texels(static_cast<size_t>(chart.width) * static_cast<size_t>(chart.height));
  const auto column = [&](float at, float low, int count) {
    return std::clamp(static_cast<int>(std::floor((at - low) / edge)), 0, count - 1);
  };
  for (const Triangle& t : chart.triangles) {
    const std::array<Vec2, 3> flat{chart.flat(t.corner[0]), chart.flat(t.corner[1]),
                                   chart.flat(t.corner[2])};
    const auto [u0, u1] = std::minmax({flat[0].x, flat[1].x, flat[2].x});
    const auto [v0, v1] = std::minmax({flat[0].y, flat[1].y, flat[2].y});
    for (int j = column(v0 - edge, chart.low_v, chart.height);
         j <= column(v1 + edge, chart.low_v, chart.height); ++j) {
      for (int i = column(u0 - edge, chart.low_u, chart.width);
           i <= column(u1 + edge, chart.low_u, chart.width); ++i) {
        const Vec2 centre{chart.low_u + (static_cast<float>(i) + 0.5f) * edge,
                          chart.low_v + (static_cast<float>(j) + 0.5f) * edge};
        std::array<float, 3> weight;
        const float distance = nearest_point(flat, centre, &weight);
        Texel& texel = texels[static_cast<size_t>(j * chart.width + i)];
        if (!(distance < texel.distance) || distance > kReach * kReach * edge * edge) continue;
        texel = {distance,
                 t.corner[0] * weight[0] + t.corner[1] * weight[1] + t.corner[2] * weight[2],
                 t.normal};
      }
    }
  }
  for (int j = 0; j < chart.height; ++j) {
    for (int i = 0; i < chart.width; ++i) {
      const Texel& texel = texels[static_cast<size_t>(j * chart.width + i)];
      if (!std::isfinite(texel.distance)) continue;
      atlas->place.push_back(static_cast<uint32_t>((chart.y + j) * atlas->width + chart.x + i));
      atlas->position.push_back(texel.position);
      atlas->normal.push_back(texel.normal);
    }
  }
}

}  // namespace

image::Image TexelAtlas::picture(const std::vector<Vec3>& values) const {
  image::Image out(width, height, 3);
  for (size_t i = 0; i < place.size(); ++i) {
    const auto at = static_cast<int>(place[i]);
    out.set_rgb(at % width, at / width, values[i]);
  }
  return out;
}

TexelAtlas make_texel_atlas(const scene::Scene& scene, int64_t count) {
  LTE_CHECK(count >= 1, "a light map needs a texel at least, got ", count);
  double area = 0;
  std::vector<Chart> charts = charts_of(scene, &area);
  LTE_CHECK(area > 0, scene.name, ": a light map of a scene without surface");
  TexelAtlas atlas;
  atlas.edge = static_cast<float>(std::sqrt(area / static_cast<double>(count)));
  pack(atlas.edge, &charts, &atlas);
  for (const Chart& chart : charts) fill(chart, &atlas);
  return atlas;
}

}  // namespace lte::infer
