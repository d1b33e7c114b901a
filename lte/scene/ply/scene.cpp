// A PLY file as a scene of its own.
#include <utility>

#include "lte/base/check.h"
#include "lte/scene/ply/ply.h"

namespace lte::scene {

Scene load_ply_scene(const std::filesystem::path& path, const LoadLimits& limits) {
  PlyMesh ply = read_ply(path, limits);
  Scene scene;
  scene.name = path.stem().string();
  Mesh mesh;
  mesh.name = scene.name;
  mesh.positions = std::move(ply.positions);
  mesh.triangles = std::move(ply.triangles);
  mesh.uvs[0] = std::move(ply.uvs);
  mesh.colors = std::move(ply.colors);
  Material material;
  material.name = mesh.colors.empty() ? "default" : "vertex colors";
  if (mesh.colors.empty()) material.base_color = {0.5f, 0.5f, 0.5f};
  scene.materials.push_back(std::move(material));
  scene.meshes.push_back(std::move(mesh));
  scene.instances.push_back({0, {}, kNone});
  if (ply.dropped_faces > 0)
    scene.ignored.push_back(concat("face of fewer than 3 corners (", ply.dropped_faces, " faces)"));
  return scene;
}

}  // namespace lte::scene
