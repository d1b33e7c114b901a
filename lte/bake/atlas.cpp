#include "lte/bake/atlas.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "lte/bake/charts.h"
#include "lte/bake/unique_name.h"
#include "lte/base/check.h"
#include "lte/scene/triangle.h"

namespace lte::bake {
namespace {

/// Edge of the raster that tells whether triangles overlap.
constexpr int kRaster = 2048;
/// How far inside a triangle a pixel's center has to lie to count, in barycentric coordinates:
/// rounding along a common edge is no overlap.
constexpr double kInside = 1e-3;

/// Calls use(x, y) for the pixels of a picture whose centers lie inside a triangle of it.
template <typename Use>
void for_pixels_inside(const std::array<Vec2, 3>& uv, int size, const Use& use) {
  const auto cross = [](double ax, double ay, double bx, double by) { return ax * by - ay * bx; };
  std::array<double, 3> x{}, y{};
  for (size_t k = 0; k < 3; ++k) {
    x[k] = double{uv[k].x} * size;
    y[k] = double{uv[k].y} * size;
  }
  const double twice = cross(x[1] - x[0], y[1] - y[0], x[2] - x[0], y[2] - y[0]);
  if (twice == 0) return;
  const auto low = [&](const std::array<double, 3>& v) {
    return std::clamp(static_cast<int>(*std::min_element(v.begin(), v.end())), 0, size - 1);
  };
  const auto high = [&](const std::array<double, 3>& v) {
    return std::clamp(static_cast<int>(*std::max_element(v.begin(), v.end())), 0, size - 1);
  };
  for (int py = low(y); py <= high(y); ++py) {
    for (int px = low(x); px <= high(x); ++px) {
      const double dx = px + 0.5 - x[0], dy = py + 0.5 - y[0];
      const double u = cross(dx, dy, x[2] - x[0], y[2] - y[0]) / twice;
      const double v = cross(x[1] - x[0], y[1] - y[0], dx, dy) / twice;
      if (u > kInside && v > kInside && u + v < 1 - kInside) use(px, py);
    }
  }
}

std::array<Vec2, 3> uv_of(const scene::Mesh& mesh, size_t triangle) {
  const std::array<uint32_t, 3>& corner = mesh.triangles[triangle];
  return {mesh.uvs[1][corner[0]], mesh.uvs[1][corner[1]], mesh.uvs[1][corner[2]]};
}

/// Why TEXCOORD_1 will not do as an atlas; empty where it will.
std::string fault_of_uvs(const scene::Scene& scene) {
  std::vector<uint8_t> taken(size_t{kRaster} * kRaster);
  for (const scene::Instance& instance : scene.instances) {
    const scene::Mesh& mesh = scene.meshes[static_cast<size_t>(instance.mesh)];
    if (mesh.uvs[1].empty()) return concat("mesh \"", mesh.name, "\" has no TEXCOORD_1");
    for (const Vec2& uv : mesh.uvs[1]) {
      const bool inside = uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1;
      if (!inside)
        return concat("TEXCOORD_1 of mesh \"", mesh.name, "\" leaves [0, 1]: ", uv.x, ", ", uv.y);
    }
    bool overlaps = false;
    for (size_t t = 0; t < mesh.triangles.size() && !overlaps; ++t) {
      for_pixels_inside(uv_of(mesh, t), kRaster, [&](int x, int y) {
        uint8_t& pixel = taken[static_cast<size_t>(y) * kRaster + static_cast<size_t>(x)];
        overlaps = overlaps || pixel != 0;
        pixel = 1;
      });
    }
    if (overlaps) return concat("TEXCOORD_1 of mesh \"", mesh.name, "\" overlaps");
  }
  return "";
}

/// The scene's own TEXCOORD_1, in pixels, and a mesh for each instance.
Atlas keep_uvs(const scene::Scene& scene, const AtlasOptions& options) {
  Atlas out;
  out.kept_uvs = true;
  out.scene = scene;
  out.scene.meshes.clear();
  double area = 0, share = 0;
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    const scene::Instance& instance = scene.instances[i];
    out.scene.meshes.push_back(scene.meshes[static_cast<size_t>(instance.mesh)]);
    out.scene.instances[i].mesh = static_cast<int>(i);
    const scene::Mesh& mesh = out.scene.meshes.back();
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
      area += scene::area(scene::world_triangle(mesh, instance.to_world, static_cast<uint32_t>(t)));
      const auto [a, b, c] = uv_of(mesh, t);
      share += 0.5 * std::abs(double{b.x - a.x} * (c.y - a.y) - double{b.y - a.y} * (c.x - a.x));
    }
  }
  LTE_CHECK(area > 0 && share > 0, "no triangle has an area, so there is nothing to bake");
  const double edge = options.texels_per_metre * std::sqrt(area / share);
  LTE_CHECK(options.size > 0 || edge <= kMaxAtlas, "--texels-per-metre ", options.texels_per_metre,
            ": the atlas would be ", edge, " texels wide, more than ", kMaxAtlas);
  out.width = out.height = options.size > 0 ? options.size : std::max(4, static_cast<int>(edge));
  out.texels_per_metre = out.width * std::sqrt(share / area);
  for (scene::Mesh& mesh : out.scene.meshes) {
    for (Vec2& uv : mesh.uvs[1])
      uv = {uv.x * static_cast<float>(out.width), uv.y * static_cast<float>(out.height)};
  }
  return out;
}

/// Sets of numbers that are joined one by one.
struct Sets {
  std::vector<uint32_t> parent;
  explicit Sets(size_t count) : parent(count) {
    for (size_t i = 0; i < count; ++i) parent[i] = static_cast<uint32_t>(i);
  }
  uint32_t find(uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  }
  void join(uint32_t a, uint32_t b) { parent[find(a)] = find(b); }
};

/// Triangles that share corners of one place in the atlas make a chart.
std::vector<int32_t> charts_of(const scene::Mesh& mesh, int32_t* charts) {
  std::map<std::pair<float, float>, uint32_t> first;
  Sets sets(mesh.uvs[1].size());
  for (uint32_t v = 0; v < mesh.uvs[1].size(); ++v) {
    const auto [at, isnew] = first.try_emplace({mesh.uvs[1][v].x, mesh.uvs[1][v].y}, v);
    if (!isnew) sets.join(v, at->second);
  }
  for (const auto& corner : mesh.triangles) {
    sets.join(corner[0], corner[1]);
    sets.join(corner[1], corner[2]);
  }
  std::map<uint32_t, int32_t> number;
  std::vector<int32_t> out;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = uv_of(mesh, t);
    const double twice =
        double{b.x - a.x} * double{c.y - a.y} - double{b.y - a.y} * double{c.x - a.x};
    if (!(std::abs(twice) > 0)) {
      out.push_back(scene::kNone);
      continue;
    }
    const auto [at, isnew] = number.try_emplace(sets.find(mesh.triangles[t][0]), *charts);
    if (isnew) ++*charts;
    out.push_back(at->second);
  }
  return out;
}

/// uvs[1] from pixels to [0, 1].
void bring_to_unit(Atlas* atlas) {
  for (scene::Mesh& mesh : atlas->scene.meshes) {
    for (Vec2& uv : mesh.uvs[1]) {
      uv = {std::clamp(uv.x / static_cast<float>(atlas->width), 0.0f, 1.0f),
            std::clamp(uv.y / static_cast<float>(atlas->height), 0.0f, 1.0f)};
    }
  }
}

/// Gives names and rectangles.
void place(const scene::Scene& source, Atlas* atlas) {
  std::set<std::string> names;
  for (size_t i = 0; i < atlas->scene.meshes.size(); ++i) {
    scene::Mesh& mesh = atlas->scene.meshes[i];
    Placement out;
    out.source_mesh = source.instances[i].mesh;
    out.node = out.mesh = static_cast<int>(i);
    out.name = mesh.name = unique_name(mesh.name.empty() ? "mesh" : mesh.name, &names);
    out.min = {1, 1};
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
      if (atlas->chart[i][t] == scene::kNone) continue;
      for (const Vec2& uv : uv_of(mesh, t)) {
        out.min = {std::min(out.min.x, uv.x), std::min(out.min.y, uv.y)};
        out.max = {std::max(out.max.x, uv.x), std::max(out.max.y, uv.y)};
      }
    }
    if (out.min.x > out.max.x) out.min = out.max = {0, 0};
    if (mesh.uvs[0].empty()) mesh.uvs[0] = mesh.uvs[1];
    atlas->placements.push_back(std::move(out));
  }
}

}  // namespace

Atlas make_atlas(const scene::Scene& scene, const AtlasOptions& options) {
  LTE_CHECK(!scene.instances.empty(), "the scene has no surfaces, so there is nothing to bake");
  LTE_CHECK(options.size >= 0 && options.size <= kMaxAtlas, "--size: expected 1 to ", kMaxAtlas,
            ", got ", options.size);
  LTE_CHECK(options.texels_per_metre > 0, "--texels-per-metre: expected a positive number, got ",
            options.texels_per_metre);
  const std::string fault = fault_of_uvs(scene);
  LTE_CHECK(!options.keep_uvs || fault.empty(), "--set keep_uvs: ", fault);
  if (!fault.empty()) return make_atlas_of_charts(scene, options);
  Atlas out = keep_uvs(scene, options);
  bring_to_unit(&out);
  finish_atlas(scene, &out);
  return out;
}

Atlas make_atlas_of_charts(const scene::Scene& scene, const AtlasOptions& options) {
  Atlas out = make_charts(scene, options);
  bring_to_unit(&out);
  finish_atlas(scene, &out);
  return out;
}

void finish_atlas(const scene::Scene& source, Atlas* atlas) {
  for (const scene::Mesh& mesh : atlas->scene.meshes) {
    atlas->chart.push_back(charts_of(mesh, &atlas->charts));
    atlas->lost_triangles += std::count(atlas->chart.back().begin(), atlas->chart.back().end(),
                                        static_cast<int32_t>(scene::kNone));
  }
  place(source, atlas);
}

}  // namespace lte::bake
