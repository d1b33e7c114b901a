#include "lte/scene/ply/import.h"

#include <utility>

#include "lte/base/check.h"
#include "lte/scene/ply/ply.h"

namespace lte::scene::ply {

Scene import(SceneFiles* files) {
  PlyMesh file = read_ply(files->open_scene(), &files->budget());
  Scene scene;
  Mesh mesh;
  mesh.name = files->scene().stem().string();
  mesh.positions = std::move(file.positions);
  mesh.triangles = std::move(file.triangles);
  mesh.uvs[0] = std::move(file.uvs);
  mesh.colors = std::move(file.colors);
  Material material;
  material.name = mesh.colors.empty() ? "default" : "vertex colors";
  if (mesh.colors.empty()) material.base_color = {0.5f, 0.5f, 0.5f};
  scene.materials.push_back(std::move(material));
  scene.meshes.push_back(std::move(mesh));
  scene.instances.push_back({0, {}, kNone});
  if (file.dropped_faces > 0)
    scene.ignored.push_back(
        concat("face of fewer than 3 corners (", file.dropped_faces, " faces)"));
  return scene;
}

}  // namespace lte::scene::ply
