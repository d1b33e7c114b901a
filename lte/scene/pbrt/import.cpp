#include "lte/scene/pbrt/import.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lte/scene/import/environment_file.h"
#include "lte/scene/pbrt/builder.h"
#include "lte/scene/pbrt/image.h"
#include "lte/scene/pbrt/material.h"
#include "lte/scene/pbrt/named_spectra.h"
#include "lte/scene/surface.h"
#include "lte/scene/triangle.h"

namespace lte::scene::pbrt {
namespace {

/// World area of each triangle of a mesh.
std::vector<double> areas(const Mesh& mesh, const Affine& to_world) {
  std::vector<double> out(mesh.triangles.size());
  for (uint32_t i = 0; i < out.size(); ++i) out[i] = area(world_triangle(mesh, to_world, i));
  return out;
}

/// pbrt's texture coordinates of triangles that have none, which needs corners of their own.
void add_default_uvs(Mesh* mesh) {
  Mesh out;
  for (std::array<uint32_t, 3>& triangle : mesh->triangles) {
    const auto first = static_cast<uint32_t>(out.positions.size());
    for (const uint32_t corner : triangle) out.positions.push_back(mesh->positions[corner]);
    out.uvs[0].insert(out.uvs[0].end(), {{0, 0}, {1, 0}, {1, 1}});
    triangle = {first, first + 1, first + 2};
  }
  mesh->positions = std::move(out.positions);
  mesh->uvs[0] = std::move(out.uvs[0]);
}

/// Turns a World into a Scene: it follows materials, and makes meshes of shapes and instances of
/// placements.
class Importer {
 public:
  Importer(World* world, const Files& files, std::string name)
      : world_(*world),
        files_(files),
        limits_(files.limits()),
        file_(std::move(name)),
        textures_(world_, files, &world_.ignored),
        materials_(world_, textures_, files, &world_.ignored),
        images_(files, &world_.ignored),
        mesh_of_shape_(world_.shapes.size(), kUnseen) {}

  Scene run() {
    for (const Placement& placement : world_.placements) {
      if (placement.shape != kNone) {
        place(placement.shape, placement.to_world, placement.at);
        continue;
      }
      const auto object = world_.objects.find(placement.object);
      if (object == world_.objects.end())
        fail(placement.at, "no object ", quote(placement.object), " is defined");
      for (const Placement& part : object->second)
        place(part.shape, placement.to_world * part.to_world, placement.at);
    }
    LTE_CHECK(triangles_ > 0, file_, ": the scene has no triangles");
    for (PunctualLight& light : world_.lights) {
      light.light_group = static_cast<int>(scene_.light_groups.size());
      scene_.light_groups.push_back(light.name);
      scene_.lights.push_back(std::move(light));
    }
    if (world_.infinite) scene_.environment = to_environment(std::move(*world_.infinite));
    add_environment_group(&scene_);
    if (world_.camera) scene_.cameras.push_back(*world_.camera);
    finish_materials();
    scene_.ignored = world_.ignored.lines();
    return std::move(scene_);
  }

 private:
  static constexpr int kUnseen = -2;  ///< no placement yet; kNone is a shape that is left out

  void place(int shape, const Transform& to_world, const Location& at) {
    const Affine affine = to_affine(to_world, at);
    int& mesh = mesh_of_shape_[static_cast<size_t>(shape)];
    if (mesh == kUnseen) mesh = add_mesh(&world_.shapes[static_cast<size_t>(shape)], affine);
    if (mesh == kNone) return;
    const Mesh& placed = scene_.meshes[static_cast<size_t>(mesh)];
    triangles_ += static_cast<int64_t>(placed.triangles.size());
    if (triangles_ > limits_.triangles)
      throw OverLimit(concat(at, ": instances have more than ", limits_.triangles, " triangles"),
                      "triangles");
    Instance instance{mesh, affine, kNone};
    if (scene_.materials[static_cast<size_t>(placed.material)].emissive()) {
      instance.light_group = static_cast<int>(scene_.light_groups.size());
      scene_.light_groups.push_back(placed.name);
    }
    scene_.instances.push_back(instance);
  }

  /// Index of the shape's mesh, kNone if its material is not seen.
  int add_mesh(ShapeDef* shape, const Affine& to_world) {
    const TexturePtr albedo = materials_.albedo(shape->material);
    if (!albedo) {
      if (shape->area_light != kNone)
        world_.ignored.add("area light of a shape that is left out", shape->at);
      return kNone;
    }
    const int index = material_of(*shape, albedo, to_world);
    const Material& material = scene_.materials[static_cast<size_t>(index)];
    shape->mesh.material = index;
    const bool textured = material.base_color_texture.texture != kNone ||
                          material.emission_texture.texture != kNone ||
                          material.normal_texture.texture != kNone;
    if (textured && shape->mesh.uvs[0].empty()) {
      world_.ignored.add("texture on a shape without uv: (0,0) (1,0) (1,1) on each triangle",
                         shape->at);
      add_default_uvs(&shape->mesh);
    }
    scene_.meshes.push_back(std::move(shape->mesh));
    return static_cast<int>(scene_.meshes.size()) - 1;
  }

  /// Materials are shared by shapes; one whose emission depends on the shape's size is its own.
  int material_of(const ShapeDef& shape, const TexturePtr& albedo, const Affine& to_world) {
    const std::pair<int, int> key{shape.material, shape.area_light};
    const auto known = shared_.find(key);
    if (known != shared_.end()) return known->second;
    const MaterialDef& def = world_.materials[static_cast<size_t>(shape.material)];
    Material material;
    const Appearance appearance = images_.resolve(albedo);
    // An unnamed material is known by its line; the default one has none.
    material.name =
        def.type == def.name && def.at.file != nullptr ? concat(def.name, " ", def.at) : def.name;
    material.base_color = appearance.factor;
    material.base_color_texture = appearance.texture;
    const Gloss gloss = materials_.gloss(shape.material);
    material.metallic = gloss.metallic;
    material.roughness = gloss.roughness;
    read_normal_map(def, &material);
    bool shareable = true;
    if (shape.area_light != kNone) shareable = add_emission(shape, to_world, &material);
    const int index = static_cast<int>(scene_.materials.size());
    scene_.materials.push_back(std::move(material));
    if (shareable) shared_[key] = index;
    return index;
  }

  void read_normal_map(const MaterialDef& def, Material* material) {
    if (!def.params || !def.params->has("normalmap")) return;
    try {
      material->normal_texture = images_.normal_map(def.params->text("normalmap", ""), def.at);
    } catch (const LimitError&) {
      throw;
    } catch (const Error&) {
      world_.ignored.add("normal map that is not there", def.at);
    }
  }

  /// False if the emission belongs to this shape alone.
  bool add_emission(const ShapeDef& shape, const Affine& to_world, Material* material) {
    const Params& light = world_.area_lights[static_cast<size_t>(shape.area_light)];
    const Parameter* color = light.find("L");
    const std::string picture = light.text("filename", "");
    if (color != nullptr && !picture.empty())
      fail(light.at(), light.what(), " has both \"L\" and \"filename\"");
    material->double_sided = light.boolean("twosided", false);
    material->emission =
        color != nullptr ? to_illuminant(*color, files_, &world_.ignored) : Rgb{1, 1, 1};
    if (!picture.empty()) material->emission_texture = images_.light_image(picture, light.at());
    const double scale = light.number("scale", 1), power = light.number("power", -1);
    if (scale < 0) fail(light.at(), light.what(), ": \"scale\" is negative");
    for (const char* harmless : {"nsamples", "samples"}) light.has(harmless);
    ignore_unused(light, &world_.ignored);
    material->emission *= static_cast<float>(scale);
    if (power > 0) {
      material->emission *= static_cast<float>(power / unit_power(shape, to_world, light));
      if (!picture.empty()) powered_.push_back(scene_.materials.size());
    }
    if (!is_finite(material->emission))
      fail(light.at(), light.what(), ": its radiance is not finite");
    return !(power > 0);
  }

  /// What a part of the shape emits at radiance 1: pbrt makes a light of each part, and "power" is
  /// that of each. Uneven parts get their mean radiance.
  double unit_power(const ShapeDef& shape, const Affine& to_world, const Params& light) {
    const std::vector<double> each = areas(shape.mesh, to_world);
    double total = 0;
    for (const double area : each) total += area;
    const auto [least, most] = std::minmax_element(each.begin(), each.end());
    if (shape.parts == static_cast<int64_t>(each.size()) && *least < *most * 0.999)
      world_.ignored.add(
          "power of an area light: its triangles differ in size, their mean radiance "
          "taken",
          light.at());
    if (!(total > 0)) fail(shape.at, "an area light with power, but without area");
    const bool two_sided = light.boolean("twosided", false);
    return (two_sided ? 2 : 1) * M_PI * total /
           static_cast<double>(std::max<int64_t>(shape.parts, 1));
  }

  void finish_materials() {
    std::vector<float> before;
    for (const Material& material : scene_.materials)
      before.push_back(max_component(material.emission));
    scene_.textures = images_.finish(&scene_.materials);
    // The power of a light with a picture counts the picture's mean, known only now.
    for (const size_t index : powered_) {
      Material& material = scene_.materials[index];
      const Texture& texture =
          *scene_.textures[static_cast<size_t>(material.emission_texture.texture)];
      const float gain = max_component(material.emission) / before[index];
      const float mean = gain * luminance(texture.sample({0.5f, 0.5f}, Wrap::ClampToEdge,
                                                         Wrap::ClampToEdge, 1e9f));
      if (mean > 0) material.emission = material.emission / mean;
    }
  }

  World& world_;
  const Files& files_;
  const LoadLimits& limits_;
  std::string file_;
  TextureTable textures_;
  MaterialTable materials_;
  ImageTable images_;
  Scene scene_;
  std::vector<int> mesh_of_shape_;
  std::map<std::pair<int, int>, int> shared_;
  std::vector<size_t> powered_;  ///< materials of lights with a picture and a power
  int64_t triangles_ = 0;
};

}  // namespace

Scene import(SceneFiles* scene) {
  Files files(scene);
  Builder builder(&files);
  parse_scene(&files, {Builder::syntax, [&](Call&& call) { builder.execute(std::move(call)); }});
  const std::string name = scene->scene().string();
  World world = builder.finish(name);
  return Importer(&world, files, name).run();
}

}  // namespace lte::scene::pbrt
