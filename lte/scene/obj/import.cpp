#include "lte/scene/obj/import.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "lte/base/check.h"
#include "lte/scene/import/texture_file.h"
#include "lte/scene/obj/file.h"
#include "lte/scene/obj/material.h"
#include "lte/scene/obj/text.h"

namespace lte::scene::obj {
namespace {

/// Vertices of one mesh: a position with one texture coordinate each. OBJ numbers the two apart.
class VertexTable {
 public:
  explicit VertexTable(const ObjFile& file) : file_(file) {}

  void fill(const Part& part, Mesh* mesh) {
    first_.resize(file_.positions.size(), kUnset);
    next_.clear();
    uv_.clear();
    bool textured = false;
    for (const auto& triangle : part.triangles) {
      for (const Corner& corner : triangle) textured |= corner.uv != kNoUv;
    }
    mesh->triangles.reserve(part.triangles.size());
    for (const auto& [a, b, c] : part.triangles)
      mesh->triangles.push_back({number(a, mesh), number(b, mesh), number(c, mesh)});
    for (size_t i = 0; textured && i < uv_.size(); ++i)
      mesh->uvs[0].push_back(uv_[i] == kNoUv ? Vec2{0, 0} : file_.uvs[uv_[i]]);
    for (const auto& triangle : part.triangles) {
      for (const Corner& corner : triangle) first_[corner.position] = kUnset;
    }
  }

 private:
  static constexpr uint32_t kUnset = 0xffffffff;
  /// A position with more texture coordinates than this gets vertices twice rather than a long
  /// search.
  static constexpr int kSearch = 64;

  uint32_t number(const Corner& corner, Mesh* mesh) {
    uint32_t at = first_[corner.position];
    for (int k = 0; at != kUnset && k < kSearch; ++k, at = next_[at]) {
      if (uv_[at] == corner.uv) return at;
    }
    const auto fresh = static_cast<uint32_t>(mesh->positions.size());
    mesh->positions.push_back(file_.positions[corner.position]);
    if (!file_.colors.empty()) mesh->colors.push_back(file_.colors[corner.position]);
    uv_.push_back(corner.uv);
    next_.push_back(first_[corner.position]);
    first_[corner.position] = fresh;
    return fresh;
  }

  const ObjFile& file_;
  std::vector<uint32_t> first_, next_, uv_;
};

/// The library of a whole mtllib line.
/// @param several  the line may as well hold several names, which are tried apart
SceneFilePtr open_library(const SceneFile& scene, const std::string& name, const std::string& where,
                          bool several, SceneFiles* files) try {
  return find_beside(scene, name, where, files);
} catch (const OutsideFolder&) {
  if (!several) throw;
  return nullptr;
}

MaterialLibrary read_libraries(const SceneFile& scene, const ObjFile& file, SceneFiles* files,
                               IgnoredFeatures* ignored) {
  MaterialLibrary library;
  const std::string where = concat(scene.name(), ": mtllib");
  for (const std::string& name : file.libraries) {
    Statements names(name, scene.name());
    names.next();
    std::string word(names.word());
    // One name with spaces, as most write it, or several without.
    const bool several = word.size() < name.size();
    if (const SceneFilePtr found = open_library(scene, name, where, several, files)) {
      read_mtl(*found, files, ignored, &library);
      continue;
    }
    for (; !word.empty(); word = names.word()) {
      if (const SceneFilePtr found = find_beside(scene, word, where, files)) {
        read_mtl(*found, files, ignored, &library);
      } else {
        ignored->add(concat("mtllib \"", shown(word), "\", which is not there"), "file");
      }
    }
  }
  return library;
}

/// The number of a part's material; gray under its own name where no library has it.
int material_of(const Part& part, IgnoredFeatures* ignored, MaterialLibrary* library) {
  const std::string name = part.material.empty() ? "default" : part.material;
  const auto [found, is_new] =
      library->by_name.try_emplace(name, static_cast<int>(library->materials.size()));
  if (is_new) {
    if (!part.material.empty()) ignored->add("usemtl without a newmtl (it is grey)", "material");
    Material gray;
    gray.name = name;
    gray.base_color = Rgb{1, 1, 1} * kDefaultGray;
    library->materials.push_back(std::move(gray));
  }
  return found->second;
}

void add_part(const Part& part, int material, VertexTable* vertices, Scene* scene) {
  Mesh mesh;
  mesh.name = part.name.empty() ? scene->materials[static_cast<size_t>(material)].name : part.name;
  mesh.material = material;
  vertices->fill(part, &mesh);
  Instance instance{static_cast<int>(scene->meshes.size()), {}, kNone};
  if (scene->materials[static_cast<size_t>(material)].emissive()) {
    instance.light_group = static_cast<int>(scene->light_groups.size());
    scene->light_groups.push_back(mesh.name);
  }
  scene->instances.push_back(instance);
  scene->meshes.push_back(std::move(mesh));
}

/// What is not of colors is a normal map.
std::vector<std::shared_ptr<const Texture>> read_pictures(const MaterialLibrary& library,
                                                          LoadBudget* budget) {
  std::vector<EncodedPicture> pictures;
  for (const auto& [file, color] : library.pictures)
    pictures.push_back({file->bytes(), file->name(), color, /*optional=*/!color});
  return decode_textures(pictures, budget);
}

}  // namespace

Scene import(SceneFiles* files) {
  const SceneFilePtr source = files->open_scene();
  IgnoredFeatures ignored;
  ObjFile file = read_obj(*source, files->limits(), &ignored);
  LTE_CHECK(!file.parts.empty(), source->name(), ": the scene has no triangles (no f statement)");
  MaterialLibrary library = read_libraries(*source, file, files, &ignored);
  std::vector<int> material;
  for (const Part& part : file.parts) material.push_back(material_of(part, &ignored, &library));

  Scene scene;
  scene.unit = "metre, assumed: OBJ has no unit";
  scene.textures = read_pictures(library, &files->budget());
  drop_damaged(&scene.textures, &library.materials, &ignored);
  scene.materials = std::move(library.materials);
  VertexTable vertices(file);
  for (size_t i = 0; i < file.parts.size(); ++i) {
    add_part(file.parts[i], material[i], &vertices, &scene);
    file.parts[i] = {};
  }
  scene.ignored = ignored.lines();
  return scene;
}

}  // namespace lte::scene::obj
