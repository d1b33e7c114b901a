// A table of formats: one row for each extension.
#include "lte/scene/load.h"

#include <exception>
#include <new>

#include "lte/base/text.h"
#include "lte/scene/gltf/import.h"
#include "lte/scene/import/scene_files.h"
#include "lte/scene/number_check.h"
#include "lte/scene/obj/import.h"
#include "lte/scene/pbrt/import.h"
#include "lte/scene/ply/import.h"
#include "lte/scene/triangle.h"

namespace lte::scene {
namespace {

constexpr struct {
  std::string_view extension;
  Scene (*import)(SceneFiles*);
} kFormats[] = {{".gltf", gltf::import},    {".glb", gltf::import}, {".pbrt", pbrt::import},
                {".pbrt.gz", pbrt::import}, {".obj", obj::import},  {".ply", ply::import},
                {".ply.gz", ply::import}};

bool has_area(const Scene& scene) {
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[static_cast<size_t>(instance.mesh)];
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
      if (area(world_triangle(mesh, instance.to_world, t)) > 0) return true;
  }
  return false;
}

}  // namespace

Scene load_scene(const std::filesystem::path& path, const LoadLimits& limits) try {
  const std::string file = path.filename().string();
  for (const auto& [extension, import] : kFormats) {
    if (!lower_case(file).ends_with(extension)) continue;
    SceneFiles files(path, limits);
    Scene scene = import(&files);
    check_numbers(path.string(), scene);
    LTE_CHECK(scene.instances.empty() || has_area(scene), path.string(),
              ": no triangle has area, of ", scene.triangle_count());
    scene.name = file.substr(0, file.size() - extension.size());  // "room" of "room.pbrt.gz"
    return scene;
  }
  LTE_CHECK(!std::filesystem::is_directory(path), path.string(), ": is a directory");
  std::string known;
  for (const std::string& format : scene_formats()) known += (known.empty() ? "" : ", ") + format;
  throw Error(concat(path.string(), ": unknown scene format: expected one of ", known));
} catch (const Error&) {
  throw;
} catch (const std::bad_alloc&) {
  throw Error(concat(path.string(), ": out of memory while loading"));
} catch (const std::exception& error) {  // nlohmann's own, which name no file
  throw Error(concat(path.string(), ": not a valid scene: ", error.what()));
}

std::vector<std::string> scene_formats() {
  std::vector<std::string> out;
  for (const auto& format : kFormats) out.emplace_back(format.extension);
  return out;
}

}  // namespace lte::scene
