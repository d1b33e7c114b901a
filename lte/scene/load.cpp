#include "lte/scene/load.h"

#include <exception>
#include <new>
#include <utility>

#include "lte/base/check.h"
#include "lte/scene/gltf_import.h"
#include "lte/scene/obj_import.h"

namespace lte::scene {
namespace {

using gltf::Context;
using gltf::MeshTable;
using gltf::Placement;

/// Corner vertices must stay finite in the world; boxes stand for their vertices, as they contain
/// them.
void check_world_positions(const Context& context, const Scene& scene) {
  std::vector<Bounds> boxes(scene.meshes.size());
  for (size_t i = 0; i < scene.meshes.size(); ++i) {
    for (const Vec3& p : scene.meshes[i].positions) boxes[i].extend(p);
  }
  for (const Instance& instance : scene.instances) {
    const Bounds& box = boxes[static_cast<size_t>(instance.mesh)];
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 p{(corner & 1 ? box.high : box.low).x, (corner & 2 ? box.high : box.low).y,
                   (corner & 4 ? box.high : box.low).z};
      LTE_CHECK(is_finite(instance.to_world.point(p)), context.file.name, ": mesh \"",
                scene.meshes[static_cast<size_t>(instance.mesh)].name,
                "\" lies beyond the range of float in the world");
    }
  }
}

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
      for (const Affine& to_world : gltf::instance_transforms(context, placement)) {
        triangles += static_cast<int64_t>(mesh.triangles.size());
        LTE_CHECK(triangles <= context.limits.triangles, context.file.name,
                  ": instances have more than ", context.limits.triangles, " triangles, at nodes[",
                  placement.node, "]");
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

void add_camera(const Context& context, Camera camera, const std::string& type, Scene* scene) {
  if (type != "perspective") {
    context.notes.add("orthographic projection", "camera");
  } else if (length(cross(camera.target - camera.origin, camera.up)) < 1e-5f) {
    context.notes.add("transform without a view direction", "camera");
  } else {
    scene->cameras.push_back(std::move(camera));
  }
}

void add_lights_and_cameras(const Context& context, const std::vector<Placement>& placements,
                            Scene* scene) {
  for (const Placement& placement : placements) {
    const tinygltf::Node& node = context.model.nodes[static_cast<size_t>(placement.node)];
    gltf::note_extensions(node.extensions, "node", &context.notes);
    if (node.camera >= 0) {
      const tinygltf::Camera& camera = context.model.cameras[static_cast<size_t>(node.camera)];
      add_camera(context, gltf::make_camera(camera, node, placement.to_world), camera.type, scene);
    }
    const auto punctual = node.extensions.find("KHR_lights_punctual");
    if (punctual == node.extensions.end() || !punctual->second.Has("light")) continue;
    const auto index = static_cast<size_t>(punctual->second.Get("light").GetNumberAsInt());
    PunctualLight light = gltf::make_light(context.model.lights[index], node, placement.to_world);
    LTE_CHECK(is_finite(light.intensity), context.file.name, ": light ", index,
              ": its intensity is not finite");
    light.light_group = static_cast<int>(scene->light_groups.size());
    if (light.name.empty()) light.name = concat("light ", index);
    scene->light_groups.push_back(light.name);
    scene->lights.push_back(std::move(light));
  }
}

/// What the document has as a whole; `json` still has everything.
void note_document(const gltf::Json& json, gltf::Notes* notes) {
  if (json.contains("animations") && !json["animations"].empty()) {
    notes->add("animations", "animation", static_cast<int64_t>(json["animations"].size()));
  }
}

Scene import(const std::filesystem::path& path, const LoadLimits& limits) {
  gltf::File file = gltf::open_file(path);
  gltf::check_document(file);
  gltf::Buffers buffers(file);
  gltf::Notes notes;
  note_document(file.json, &notes);
  const tinygltf::Model model = gltf::parse_model(&file);
  gltf::note_extensions(model.extensions, "file", &notes);
  const Context context{file, model, buffers, limits, notes};

  Scene scene;
  scene.name = path.stem().string();
  scene.unit = "metre, as glTF has it";
  std::vector<Placement> placements = gltf::place_nodes(context);
  const std::vector<gltf::Shape> shapes = gltf::find_shapes(context, &placements);
  MeshTable table = gltf::read_meshes(context, shapes, placements);
  scene.meshes = std::move(table.meshes);
  scene.materials = gltf::read_materials(context);
  if (table.needs_default_material || scene.materials.empty()) {
    scene.materials.emplace_back();
    scene.materials.back().name = "default";
  }
  add_instances(context, placements, table, &scene);
  check_world_positions(context, scene);
  add_lights_and_cameras(context, placements, &scene);
  scene.textures = gltf::read_textures(context, &buffers, &scene.materials);
  scene.ignored = notes.lines();
  return scene;
}

bool has_extension(const std::filesystem::path& path, const char* extension) {
  std::string own = path.extension().string();
  for (char& c : own) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return own == extension;
}

}  // namespace

Scene load_scene(const std::filesystem::path& path, const LoadLimits& limits) {
  try {
    if (has_extension(path, ".obj")) return obj::import(path, limits);
    return import(path, limits);
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw Error(concat(path.string(), ": out of memory while loading"));
  } catch (const std::exception& error) {  // nlohmann's own, which name no file
    throw Error(concat(path.string(), ": not a valid scene: ", error.what()));
  }
}

}  // namespace lte::scene
