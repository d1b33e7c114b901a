#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "lte/bake/lightmap.h"
#include "lte/bake/pixel_triangle.h"
#include "lte/base/check.h"
#include "lte/base/math.h"
#include "lte/image/tonemap.h"
#include "lte/scene/export.h"
#include "lte/scene/glb_writer.h"
#include "lte/scene/surface.h"

namespace lte::bake {
namespace {

/// Share of values that a picture of 8 bits shows without clipping.
constexpr double kShown = 0.999;

/// Radiance as a texture of 8 bits on the sRGB curve.
std::shared_ptr<const scene::Texture> texture_of(const Lightmap& map,
                                                 const std::vector<float>& radiance, float scale) {
  std::vector<uint8_t> bytes(radiance.size());
  for (size_t i = 0; i < bytes.size(); ++i) {
    const float shown = image::linear_to_srgb(std::clamp(radiance[i] * scale, 0.0f, 1.0f));
    bytes[i] = static_cast<uint8_t>(std::lround(255 * shown));
  }
  return std::make_shared<scene::Texture>(map.width, map.height, std::move(bytes), true);
}

/// What surfaces show at each pixel beside irradiance.
struct Appearance {
  std::vector<Rgb> albedo, emission;
  std::vector<uint8_t> known;
};

void add_triangle(const Lightmap& map, int instance, uint32_t triangle, Appearance* out) {
  const PixelTriangle shape(map.scene.meshes[static_cast<size_t>(instance)], triangle, map.width,
                            map.height);
  if (!(std::abs(shape.twice_area()) > 0)) return;
  shape.for_pixels(1, [&](int x, int y) {
    const Vec2 center{static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f};
    const Vec2 uv = shape.barycentric(center);
    const Vec2 at = shape.at(uv);
    const float off = std::hypot(at.x - center.x, at.y - center.y);
    const size_t pixel =
        static_cast<size_t>(y) * static_cast<size_t>(map.width) + static_cast<size_t>(x);
    const uint8_t rank = off < 1e-3f ? 2 : 1;
    if (off > 1.5f || out->known[pixel] >= rank) return;
    out->known[pixel] = rank;
    scene::evaluate_appearance(map.scene, instance, triangle, uv.x, uv.y, 0, &out->albedo[pixel],
                               &out->emission[pixel]);
  });
}

Appearance appearance_of(const Lightmap& map) {
  Appearance out{std::vector<Rgb>(map.pixels()), std::vector<Rgb>(map.pixels()),
                 std::vector<uint8_t>(map.pixels())};
  for (size_t i = 0; i < map.scene.meshes.size(); ++i) {
    for (uint32_t t = 0; t < map.scene.meshes[i].triangles.size(); ++t)
      add_triangle(map, static_cast<int>(i), t, &out);
  }
  return out;
}

void use_extension(nlohmann::json* json, const char* name) {
  nlohmann::json& used = (*json)["extensionsUsed"];
  if (std::find(used.begin(), used.end(), name) == used.end()) used.push_back(name);
}

}  // namespace

float bright(std::vector<float> values) {
  std::erase_if(values, [](float value) { return !(value > 0); });
  if (values.empty()) return 1;
  const auto at = static_cast<int64_t>(kShown * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<size_t>(at)];
}

void write_lightmap_glb(const std::filesystem::path& path, const Lightmap& map) {
  std::vector<float> radiance = map.total();
  for (float& value : radiance) value /= kPi;
  const float intensity = bright(radiance);
  scene::Scene scene = map.scene;
  const size_t image = scene.textures.size();
  scene.textures.push_back(texture_of(map, radiance, 1 / intensity));
  scene::write_glb(path, scene, [&](scene::GlbWriter& writer) {
    nlohmann::json& json = writer.json();
    json["samplers"].push_back({{"wrapS", 33071}, {"wrapT", 33071}, {"magFilter", 9729}});
    json["textures"].push_back(
        {{"source", image}, {"sampler", json["samplers"].size() - 1}, {"name", "light map"}});
    const size_t texture = json["textures"].size() - 1;
    for (nlohmann::json& material : json["materials"]) {
      material["extensions"]["MOZ_lightmap"] = {
          {"index", texture}, {"texCoord", 1}, {"intensity", intensity}};
    }
    use_extension(&json, "MOZ_lightmap");
  });
}

void write_unlit_glb(const std::filesystem::path& path, const Lightmap& map, double exposure) {
  const Appearance look = appearance_of(map);
  std::vector<float> radiance = map.total(), reflected(radiance.size());
  for (size_t i = 0; i < map.pixels(); ++i) {
    for (size_t c = 0; c < 3; ++c) {
      const int axis = static_cast<int>(c);
      reflected[3 * i + c] = radiance[3 * i + c] / kPi * look.albedo[i][axis];
      radiance[3 * i + c] = reflected[3 * i + c] + look.emission[i][axis];
    }
  }
  const float scale = exposure > 0 ? static_cast<float>(exposure) : 1 / bright(reflected);
  scene::Scene scene = map.scene;
  scene.textures = {texture_of(map, radiance, scale)};
  scene.lights.clear();
  scene.light_groups.clear();
  for (scene::Instance& instance : scene.instances) instance.light_group = scene::kNone;
  for (scene::Material& material : scene.materials) {
    scene::Material plain;
    plain.name = material.name;
    plain.double_sided = material.double_sided;
    plain.base_color_texture.texture = 0;
    plain.base_color_texture.uv_set = 1;
    plain.base_color_texture.wrap_u = plain.base_color_texture.wrap_v = scene::Wrap::ClampToEdge;
    material = plain;
  }
  for (scene::Mesh& mesh : scene.meshes) {
    mesh.colors.clear();
    mesh.normals.clear();
    mesh.tangents.clear();
  }
  scene::write_glb(path, scene, [](scene::GlbWriter& writer) {
    for (nlohmann::json& material : writer.json()["materials"])
      material["extensions"]["KHR_materials_unlit"] = nlohmann::json::object();
    use_extension(&writer.json(), "KHR_materials_unlit");
  });
}

}  // namespace lte::bake
