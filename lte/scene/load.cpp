#include "lte/scene/load.h"

#include <cctype>
#include <exception>
#include <new>
#include <utility>

#include "lte/base/check.h"
#include "lte/scene/gltf/context.h"
#include "lte/scene/import/position_check.h"
#include "lte/scene/obj/import.h"
#include "lte/scene/pbrt/import.h"
#include "lte/scene/ply/ply.h"

namespace lte::scene {
namespace {

using gltf::Context;
using gltf::MeshTable;
using gltf::Placement;

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

/// In lower case; of "room.pbrt.gz" that of "room.pbrt".
std::string format_extension(const std::filesystem::path& path) {
  const auto lower = [](std::string text) {
    for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
  };
  const std::string extension = lower(path.extension().string());
  return extension == ".gz" ? lower(path.stem().extension().string()) : extension;
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
    scene.materials.back().metallic = 1;  // as the specification has it (3.9)
  }
  add_instances(context, placements, table, &scene);
  check_world_positions(context.file.name, scene);
  add_lights_and_cameras(context, placements, &scene);
  scene.textures = gltf::read_textures(context, &buffers, &scene.materials);
  scene.ignored = notes.lines();
  return scene;
}

}  // namespace

Scene load_scene(const std::filesystem::path& path, const LoadLimits& limits) {
  const std::string extension = format_extension(path);
  try {
    if (extension == ".obj") return obj::import(path, limits);
    if (extension != ".pbrt" && extension != ".ply") return import(path, limits);
    Scene scene =
        extension == ".pbrt" ? pbrt::load_pbrt_scene(path, limits) : load_ply_scene(path, limits);
    if (path.stem().has_extension() && format_extension(path.stem()) == extension)
      scene.name = path.stem().stem().string();  // "room" of "room.pbrt.gz"
    return scene;
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw Error(concat(path.string(), ": out of memory while loading"));
  } catch (const std::exception& error) {  // nlohmann's own, which name no file
    throw Error(concat(path.string(), ": not a valid scene: ", error.what()));
  }
}

}  // namespace lte::scene
