#include "lte/bake/texels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "lte/bake/pixel_triangle.h"
#include "lte/base/check.h"
#include "lte/base/parallel_each.h"
#include "lte/scene/triangle.h"

namespace lte::bake {
namespace {

/// Smaller parts of a texel are rounding.
constexpr float kLeastArea = 1e-5f;
constexpr int64_t kDescribed = 4096;  ///< that a thread takes at a time

/// A convex polygon: a triangle cut by a square has 7 corners at most.
struct Polygon {
  std::array<Vec2, 10> corner;
  size_t size = 0;

  void add(const Vec2& p) { corner[size++] = p; }
  float twice_area() const {
    float sum = 0;
    for (size_t k = 0; k < size; ++k) {
      const Vec2 &a = corner[k], &b = corner[(k + 1) % size];
      sum += (a.x - corner[0].x) * (b.y - corner[0].y) - (a.y - corner[0].y) * (b.x - corner[0].x);
    }
    return std::abs(sum);
  }
};

/// The part of a polygon where sign * (coordinate - bound) <= 0.
Polygon cut(const Polygon& from, bool vertical, float sign, float bound) {
  Polygon out;
  const auto beyond = [&](const Vec2& p) { return sign * ((vertical ? p.y : p.x) - bound); };
  for (size_t k = 0; k < from.size; ++k) {
    const Vec2 &a = from.corner[k], &b = from.corner[(k + 1) % from.size];
    const float da = beyond(a), db = beyond(b);
    if (da <= 0) out.add(a);
    if ((da < 0 && db > 0) || (da > 0 && db < 0)) {
      const float t = da / (da - db);
      out.add({a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)});
    }
  }
  return out;
}

/// The part of a triangle inside a pixel, relative to the pixel's corner.
Polygon part_in(const std::array<Vec2, 3>& uv, int x, int y) {
  Polygon polygon;
  for (const Vec2& p : uv) polygon.add({p.x - static_cast<float>(x), p.y - static_cast<float>(y)});
  for (const bool vertical : {false, true}) {
    polygon = cut(polygon, vertical, 1, 1);
    polygon = cut(polygon, vertical, -1, 0);
  }
  return polygon;
}

struct PixelFragment {
  uint64_t order;  ///< block_order() of the pixel
  uint32_t pixel;
  int32_t chart;
  Fragment fragment;
};

/// What triangles have in pixels, in their order.
struct Parts {
  std::vector<PixelFragment> fragments;
  std::vector<Vec2> corners;
};

/// A number by which pixels stand in blocks of 8 x 8.
uint64_t block_order(uint32_t pixel, uint32_t width) {
  const uint32_t x = pixel % width, y = pixel / width;
  return ((uint64_t{y / 8} * ((width + 7) / 8) + x / 8) << 6) | ((y % 8) * 8 + x % 8);
}

void rasterize(const Atlas& atlas, size_t instance, size_t triangle, Parts* out) {
  const PixelTriangle shape(atlas.scene.meshes[instance], triangle, atlas.width, atlas.height);
  const auto width = static_cast<uint32_t>(atlas.width);
  shape.for_pixels(0, [&](int x, int y) {
    const Polygon part = part_in(shape.corners(), x, y);
    const float area = part.size < 3 ? 0 : 0.5f * part.twice_area();
    if (area < kLeastArea) return;
    const uint32_t pixel = static_cast<uint32_t>(y) * width + static_cast<uint32_t>(x);
    out->fragments.push_back(
        {block_order(pixel, width),
         pixel,
         atlas.chart[instance][triangle],
         {static_cast<int32_t>(instance), static_cast<uint32_t>(triangle), area,
          static_cast<uint32_t>(out->corners.size()), static_cast<uint32_t>(part.size)}});
    for (size_t k = 0; k < part.size; ++k) {
      const Vec2& p = part.corner[k];
      out->corners.push_back(
          shape.barycentric({p.x + static_cast<float>(x), p.y + static_cast<float>(y)}));
    }
  });
}

/// Of all instances, side by side.
Parts rasterize(const Atlas& atlas) {
  std::vector<Parts> each(atlas.scene.instances.size());
  parallel_each(each.size(), 1, [&](size_t i) {
    for (size_t t = 0; t < atlas.scene.meshes[i].triangles.size(); ++t)
      if (atlas.chart[i][t] != scene::kNone) rasterize(atlas, i, t, &each[i]);
  });
  Parts out;
  for (Parts& one : each) {
    const auto corners = static_cast<uint32_t>(out.corners.size());
    for (PixelFragment& f : one.fragments) f.fragment.first_corner += corners;
    out.fragments.insert(out.fragments.end(), one.fragments.begin(), one.fragments.end());
    out.corners.insert(out.corners.end(), one.corners.begin(), one.corners.end());
    one = {};
  }
  return out;
}

/// A place of a fragment's triangle.
TexelPlace place_on(const Atlas& atlas, const Fragment& f, const Vec2& uv) {
  const auto i = static_cast<size_t>(f.instance);
  const Affine& to_world = atlas.scene.instances[i].to_world;
  const scene::WorldTriangle t = scene::world_triangle(atlas.scene.meshes[i], to_world, f.triangle);
  const scene::AreaVector across = scene::area_vector(t);
  const double area = std::max(across.norm(), 1e-300);
  const double norm = to_world.determinant() < 0 ? -area : area;
  return {t.p0 * (1 - uv.x - uv.y) + t.p1 * uv.x + t.p2 * uv.y,
          {static_cast<float>(across.x / norm), static_cast<float>(across.y / norm),
           static_cast<float>(across.z / norm)}};
}

/// The chart with the most area in one pixel.
int32_t main_chart(std::span<const PixelFragment> all) {
  int32_t chart = scene::kNone;
  float most = -1;
  for (const PixelFragment& one : all) {
    float area = 0;
    for (const PixelFragment& other : all)
      if (other.chart == one.chart) area += other.fragment.area;
    if (area > most) {
      most = area;
      chart = one.chart;
    }
  }
  return chart;
}

/// Says what a texel is whose fragments are known.
void describe(const Atlas& atlas, size_t texel, Texels* out) {
  Vec3 position, normal;
  double world = 0, texels = 0;
  for (uint32_t k = out->first[texel]; k < out->first[texel + 1]; ++k) {
    const Fragment& f = out->fragments[k];
    const std::span<const Vec2> part = out->part_of(f);
    Vec2 center;
    for (const Vec2& corner : part) {
      center.x += corner.x / static_cast<float>(part.size());
      center.y += corner.y / static_cast<float>(part.size());
    }
    const TexelPlace place = place_on(atlas, f, center);
    position += place.position * f.area;
    normal += place.normal * f.area;
    const auto i = static_cast<size_t>(f.instance);
    const scene::Mesh& mesh = atlas.scene.meshes[i];
    const PixelTriangle shape(mesh, f.triangle, atlas.width, atlas.height);
    world +=
        double{f.area} *
        scene::area(scene::world_triangle(mesh, atlas.scene.instances[i].to_world, f.triangle)) /
        (0.5 * std::abs(double{shape.twice_area()}));
    texels += double{f.area};
  }
  out->position[texel] = position / static_cast<float>(texels);
  out->normal[texel] = normalize(normal);
  out->edge[texel] = static_cast<float>(std::sqrt(world / texels));
}

}  // namespace

Texels find_texels(const Atlas& atlas) {
  Parts parts = rasterize(atlas);
  std::vector<PixelFragment>& all = parts.fragments;
  LTE_CHECK(!all.empty(), "no triangle touches a texel of the atlas");
  std::stable_sort(all.begin(), all.end(), [](const PixelFragment& a, const PixelFragment& b) {
    return a.order < b.order;
  });
  Texels out;
  out.corners = std::move(parts.corners);
  out.first.push_back(0);
  for (size_t begin = 0, end = 0; begin < all.size(); begin = end) {
    while (end < all.size() && all[end].pixel == all[begin].pixel) ++end;
    const auto here = std::span(all).subspan(begin, end - begin);
    const int32_t chart = main_chart(here);
    for (const PixelFragment& one : here)
      if (one.chart == chart) out.fragments.push_back(one.fragment);
    out.pixel.push_back(here.front().pixel);
    out.chart.push_back(chart);
    out.first.push_back(static_cast<uint32_t>(out.fragments.size()));
  }
  out.position.resize(out.size());
  out.normal.resize(out.size());
  out.edge.resize(out.size());
  parallel_each(out.size(), kDescribed, [&](size_t i) { describe(atlas, i, &out); });
  return out;
}

TexelPlace place_in(const Atlas& atlas, const Texels& texels, size_t texel,
                    const std::array<float, 3>& u) {
  const auto parts =
      std::span(texels.fragments)
          .subspan(texels.first[texel], texels.first[texel + 1] - texels.first[texel]);
  float sum = 0;
  for (const Fragment& f : parts) sum += f.area;
  float left = u[0] * sum;
  size_t chosen = 0;
  while (chosen + 1 < parts.size() && left >= parts[chosen].area) left -= parts[chosen++].area;
  const Fragment& f = parts[chosen];
  // A triangle of the fan around the first corner, by area, and a place in it.
  const std::span<const Vec2> part = texels.part_of(f);
  const auto fan = [&](size_t k) {
    const Vec2 &o = part[0], &a = part[k], &b = part[k + 1];
    return std::abs((a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x));
  };
  float rest = 0;
  for (size_t k = 1; k + 1 < part.size(); ++k) rest += u[1] * fan(k);
  size_t k = 1;
  while (k + 2 < part.size() && rest >= fan(k)) rest -= fan(k++);
  const float along = fan(k) > 0 ? std::clamp(rest / fan(k), 0.0f, 1.0f) : 0.5f;
  const float root = std::sqrt(along), b1 = root * (1 - u[2]), b2 = root * u[2];
  const Vec2 &o = part[0], &a = part[k], &b = part[k + 1];
  return place_on(
      atlas, f,
      {o.x + b1 * (a.x - o.x) + b2 * (b.x - o.x), o.y + b1 * (a.y - o.y) + b2 * (b.y - o.y)});
}

}  // namespace lte::bake
