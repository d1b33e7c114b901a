// A light map made by hand, for what reads light maps: each quad of a scene has a square of the
// atlas, whose texels are path-traced one by one.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "lte/bake/lightmap.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/irradiance.h"
#include "lte/pathtrace/lights/lights.h"
#include "tests/support/scenes.h"

namespace lte::test {

/// @param scene  of meshes by append_quad() alone, an instance each
/// @param side   texels along a quad
/// @param rays   paths a texel
inline bake::Lightmap quad_lightmap(const scene::Scene& scene, int side, int rays) {
  bake::Lightmap map;
  map.scene = scene;
  size_t quads = 0;
  for (const scene::Mesh& mesh : scene.meshes) quads += mesh.positions.size() / 4;
  const int columns = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(quads))));
  map.width = map.height = columns * side;
  map.mask.assign(map.pixels(), static_cast<uint8_t>(bake::Texel::Outside));
  std::vector<Vec3> positions, normals;
  std::vector<size_t> pixels;
  int cell = 0;
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    scene::Mesh& mesh = map.scene.meshes[static_cast<size_t>(scene.instances[i].mesh)];
    const Affine& to_world = scene.instances[i].to_world;
    bake::Placement place{mesh.name + std::to_string(i),
                          static_cast<int>(i),
                          static_cast<int>(i),
                          static_cast<int>(i),
                          {1, 1},
                          {0, 0}};
    mesh.uvs[1].clear();
    for (size_t v = 0; v < mesh.positions.size(); v += 4, ++cell) {
      const int left = cell % columns * side, top = cell / columns * side;
      const auto atlas = [&](int origin, float share) {
        return (static_cast<float>(origin) + 0.5f + share * static_cast<float>(side - 1)) /
               static_cast<float>(map.width);
      };
      for (size_t k = v; k < v + 4; ++k) {
        const Vec2 uv{atlas(left, mesh.uvs[0][k].x), atlas(top, mesh.uvs[0][k].y)};
        mesh.uvs[1].push_back(uv);
        place.min = {std::min(place.min.x, uv.x), std::min(place.min.y, uv.y)};
        place.max = {std::max(place.max.x, uv.x), std::max(place.max.y, uv.y)};
      }
      const Vec3 corner = to_world.point(mesh.positions[v]);
      const Vec3 a = to_world.point(mesh.positions[v + 1]) - corner,
                 b = to_world.point(mesh.positions[v + 3]) - corner;
      for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
          const auto share = [&](int texel) {
            return std::clamp(static_cast<float>(texel) / static_cast<float>(side - 1), 2e-3f,
                              1 - 2e-3f);
          };
          positions.push_back(corner + a * share(x) + b * share(y));
          normals.push_back(normalize(cross(a, b)));
          pixels.push_back(static_cast<size_t>(top + y) * map.width + left + x);
          map.mask[pixels.back()] = static_cast<uint8_t>(bake::Texel::Lit);
        }
      }
    }
    map.placements.push_back(place);
  }
  const pathtrace::Bvh bvh(scene);
  const pathtrace::Lights lights(scene);
  pathtrace::IrradianceOptions options;
  options.rays = rays;
  const pathtrace::Irradiance light =
      pathtrace::estimate_irradiance(bvh, lights, positions, normals, options);
  for (int64_t g = 0; g < light.groups; ++g) {
    bake::Layer layer{scene.light_groups[static_cast<size_t>(g)], {}};
    layer.irradiance.assign(3 * map.pixels(), 0);
    for (size_t i = 0; i < pixels.size(); ++i) {
      const auto at = static_cast<size_t>(g * light.points) + i;
      const Rgb sum = light.direct[at] + light.indirect[at];
      for (int c = 0; c < 3; ++c) layer.irradiance[3 * pixels[i] + static_cast<size_t>(c)] = sum[c];
    }
    map.layers.push_back(layer);
  }
  map.provenance.source = "room.glb";
  map.provenance.integrator = "path";
  map.provenance.include = "full";
  return map;
}

/// Into the furnished room from a corner.
inline scene::Camera room_camera() {
  scene::Camera camera;
  camera.name = "corner";
  camera.origin = {3.7f, 1.7f, 2.7f};
  camera.target = {1.2f, 0.7f, 0.7f};
  camera.vfov = 60;
  return camera;
}

}  // namespace lte::test
