#include "lte/scene/gltf/import.h"

#include <utility>

#include "lte/base/check.h"
#include "lte/scene/gltf/context.h"

namespace lte::scene::gltf {
namespace {

std::string node_name(const Context& context, const Placement& placement,
                      const std::string& fallback) {
  const std::string& name = context.model.nodes[static_cast<size_t>(placement.node)].name;
  return name.empty() ? fallback : name;
}

void add_instances(const Context& context, const std::vector<Placement>& placements,
                   const MeshTable& table, Scene* scene) {
  int64_t triangles = 0;
  for (const Placement& placement : placements) {
    if (placement.shape == kNone) continue;
    for (const int index : table.of_shape[static_cast<size_t>(placement.shape)]) {
      const Mesh& mesh = scene->meshes[static_cast<size_t>(index)];
      for (const Affine& to_world : instance_transforms(context, placement)) {
        triangles += static_cast<int64_t>(mesh.triangles.size());
        if (triangles > context.limits.triangles)
          throw OverLimit(
              concat(context.file.name, ": instances have more than ", context.limits.triangles,
                     " triangles, at nodes[", placement.node, "]"),
              "triangles");
        Instance instance{index, to_world, kNone};
        if (scene->materials[static_cast<size_t>(mesh.material)].emissive()) {
          instance.light_group = static_cast<int>(scene->light_groups.size());
          scene->light_groups.push_back(node_name(context, placement, mesh.name));
        }
        scene->instances.push_back(instance);
      }
    }
  }
  LTE_CHECK(triangles > 0, context.file.name, ": the scene has no triangles");
}

/// Records what is left out of the document as a whole.
void ignore_animations(const Json& json, IgnoredFeatures* ignored) {
  if (json.contains("animations") && !json["animations"].empty()) {
    ignored->add("animations", "animation", static_cast<int64_t>(json["animations"].size()));
  }
}

}  // namespace

Scene import(SceneFiles* files) {
  File file = open_file(files);
  check_document(file);
  Buffers buffers(file, files);
  IgnoredFeatures ignored;
  // Before parse_model(), which leaves only the images in the JSON.
  ignore_animations(file.json, &ignored);
  const tinygltf::Model model = parse_model(&file);
  ignore_unknown_extensions(model.extensions, "file", &ignored);
  const Context context{file, model, buffers, files->limits(), files->budget(), ignored};

  Scene scene;
  scene.unit = "metre, as glTF has it";
  std::vector<Placement> placements = place_nodes(context);
  const std::vector<Shape> shapes = find_shapes(context, &placements);
  MeshTable table = read_meshes(context, shapes, placements);
  scene.meshes = std::move(table.meshes);
  scene.materials = read_materials(context);
  if (table.needs_default_material || scene.materials.empty()) {
    scene.materials.emplace_back();
    scene.materials.back().name = "default";
    scene.materials.back().metallic = 1;  // as the specification has it (3.9)
  }
  // Before the instances: what shone through a picture that is not read has no light group.
  scene.textures = read_textures(context, &buffers, &scene.materials);
  add_instances(context, placements, table, &scene);
  add_lights_and_cameras(context, placements, &scene);
  scene.ignored = ignored.lines();
  return scene;
}

}  // namespace lte::scene::gltf
