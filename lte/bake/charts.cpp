#include "lte/bake/charts.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <xatlas.h>

#include "lte/base/check.h"
#include "lte/scene/triangle.h"

namespace lte::bake {
namespace {

struct Destroy {
  void operator()(xatlas::Atlas* atlas) const { xatlas::Destroy(atlas); }
};
using AtlasPtr = std::unique_ptr<xatlas::Atlas, Destroy>;

/// Texels around each chart, beside those that bilinear look-ups read.
constexpr uint32_t kPadding = 2;
/// Times that charts are packed anew until they fit a size.
constexpr int kPackings = 12;

/// Adds an instance in world space, so that charts have the scale that texels count in.
/// @return  m² of its triangles
double add(const scene::Scene& scene, const scene::Instance& instance, uint32_t count,
           xatlas::Atlas* atlas) {
  const scene::Mesh& mesh = scene.meshes[static_cast<size_t>(instance.mesh)];
  std::vector<Vec3> positions;
  for (const Vec3& p : mesh.positions) positions.push_back(instance.to_world.point(p));
  const auto ignored = std::make_unique<bool[]>(mesh.triangles.size());
  double sum = 0;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    const double area =
        scene::area(scene::world_triangle(mesh, instance.to_world, static_cast<uint32_t>(t)));
    ignored[t] = !(area > 0);
    if (!ignored[t]) sum += area;
  }
  xatlas::MeshDecl decl;
  decl.vertexPositionData = positions.data();
  decl.vertexPositionStride = sizeof(Vec3);
  decl.vertexCount = static_cast<uint32_t>(positions.size());
  decl.indexData = mesh.triangles.data();
  decl.indexCount = static_cast<uint32_t>(3 * mesh.triangles.size());
  decl.indexFormat = xatlas::IndexFormat::UInt32;
  decl.faceIgnoreData = ignored.get();
  LTE_CHECK(xatlas::AddMesh(atlas, decl, count) == xatlas::AddMeshError::Success, mesh.name,
            ": xatlas cannot read this mesh");
  return sum;
}

xatlas::PackOptions packing(double texels_per_metre) {
  xatlas::PackOptions out;
  out.padding = kPadding;
  out.texelsPerUnit = static_cast<float>(texels_per_metre);
  return out;
}

/// Packs charts at the density that fills a square of `size`.
double pack_into(int size, double area, xatlas::Atlas* atlas) {
  double density = size * std::sqrt(0.8 / area), fits = 0;
  for (int k = 0; k < kPackings; ++k) {
    xatlas::PackCharts(atlas, packing(density));
    const auto edge = static_cast<double>(std::max(atlas->width, atlas->height));
    if (edge <= size) {
      fits = density;
      if (edge > 0.97 * size) return density;
      density *= std::min(1.2, 0.99 * size / edge);
    } else {
      if (fits > 0) break;
      density *= 0.97 * size / edge;
    }
  }
  LTE_CHECK(fits > 0, "--size ", size, ": ", atlas->chartCount,
            " charts and the space between them do not fit; take a larger picture");
  xatlas::PackCharts(atlas, packing(fits));
  return fits;
}

}  // namespace

scene::Mesh split_mesh(const scene::Mesh& mesh, const std::vector<uint32_t>& source,
                       std::vector<std::array<uint32_t, 3>> triangles) {
  scene::Mesh out;
  out.name = mesh.name;
  out.material = mesh.material;
  out.triangles = std::move(triangles);
  const auto take = [&](const auto& from, auto* to) {
    if (from.empty()) return;
    to->reserve(source.size());
    for (const uint32_t i : source) to->push_back(from[i]);
  };
  take(mesh.positions, &out.positions);
  take(mesh.colors, &out.colors);
  take(mesh.normals, &out.normals);
  take(mesh.tangents, &out.tangents);
  for (size_t set = 0; set < mesh.uvs.size(); ++set) take(mesh.uvs[set], &out.uvs[set]);
  return out;
}

Atlas make_charts(const scene::Scene& scene, const AtlasOptions& options) {
  const AtlasPtr atlas(xatlas::Create());
  double area = 0;
  for (const scene::Instance& instance : scene.instances)
    area += add(scene, instance, static_cast<uint32_t>(scene.instances.size()), atlas.get());
  LTE_CHECK(area > 0, "no triangle has an area, so there is nothing to bake");
  const double edge = std::sqrt(area) * options.texels_per_metre;
  LTE_CHECK(options.size > 0 || edge <= kMaxAtlas, "--texels-per-metre ", options.texels_per_metre,
            ": an atlas of ", area, " m² would be ", edge, " texels wide, more than ", kMaxAtlas);
  xatlas::ComputeCharts(atlas.get());
  double density = options.texels_per_metre;
  if (options.size > 0) {
    density = pack_into(options.size, area, atlas.get());
  } else {
    xatlas::PackCharts(atlas.get(), packing(density));
  }
  Atlas out;
  out.width = options.size > 0 ? options.size : static_cast<int>(atlas->width);
  out.height = options.size > 0 ? options.size : static_cast<int>(atlas->height);
  LTE_CHECK(out.width <= kMaxAtlas && out.height <= kMaxAtlas, "--texels-per-metre ",
            options.texels_per_metre, ": the atlas would be ", out.width, " x ", out.height,
            " texels, more than ", kMaxAtlas);
  out.texels_per_metre = density;
  out.scene = scene;
  out.scene.meshes.clear();
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    const scene::Mesh& mesh = scene.meshes[static_cast<size_t>(scene.instances[i].mesh)];
    const xatlas::Mesh& made = atlas->meshes[i];
    std::vector<uint32_t> source(made.vertexCount);
    std::vector<Vec2> uv(made.vertexCount);
    for (uint32_t v = 0; v < made.vertexCount; ++v) {
      source[v] = made.vertexArray[v].xref;
      uv[v] = {made.vertexArray[v].uv[0], made.vertexArray[v].uv[1]};
    }
    std::vector<std::array<uint32_t, 3>> triangles(made.indexCount / 3);
    for (uint32_t k = 0; k < 3 * triangles.size(); ++k)
      triangles[k / 3][k % 3] = made.indexArray[k];
    out.scene.meshes.push_back(split_mesh(mesh, source, std::move(triangles)));
    out.scene.meshes.back().uvs[1] = std::move(uv);
    out.scene.instances[i].mesh = static_cast<int>(i);
  }
  return out;
}

}  // namespace lte::bake
