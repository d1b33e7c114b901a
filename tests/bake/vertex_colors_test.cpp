// The files of light at vertices.
#include <cmath>
#include <cstring>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "lte/bake/formats/formats.h"
#include "lte/base/file.h"
#include "lte/scene/load.h"
#include "tests/bake/quad_lightmap.h"
#include "tests/support/temp_dir.h"

namespace lte::bake {
namespace {

/// The JSON of a binary glTF, and the numbers of an accessor of floats.
struct Glb {
  nlohmann::json json;
  std::string binary;

  explicit Glb(const std::filesystem::path& path) {
    const std::string bytes = read_file(path);
    uint32_t length = 0;
    std::memcpy(&length, &bytes[12], sizeof length);
    json = nlohmann::json::parse(bytes.substr(20, length));
    binary = bytes.substr(28 + length);
  }
  const nlohmann::json& attributes(size_t mesh) const {
    return json["meshes"][mesh]["primitives"][0]["attributes"];
  }
  std::vector<float> floats(size_t mesh, const std::string& name) const {
    const nlohmann::json& accessor = json["accessors"][attributes(mesh)[name].get<size_t>()];
    EXPECT_EQ(accessor["componentType"], 5126);
    EXPECT_EQ(accessor["type"], "VEC3");
    const nlohmann::json& view = json["bufferViews"][accessor["bufferView"].get<size_t>()];
    std::vector<float> out(3 * accessor["count"].get<size_t>());
    const size_t begin = view.value("byteOffset", size_t{0}), size = out.size() * sizeof(float);
    EXPECT_EQ(begin % sizeof(float), 0u);
    EXPECT_EQ(view["byteLength"].get<size_t>(), size);
    EXPECT_LE(begin + size, binary.size());
    if (begin + size <= binary.size()) std::memcpy(out.data(), &binary[begin], size);
    return out;
  }
  /// What glTF says of the attributes of a mesh.
  void expect_valid(size_t mesh) const {
    const size_t vertices = floats(mesh, "POSITION").size();
    for (const auto& [name, accessor] : attributes(mesh).items()) {
      if (name.starts_with("TEXCOORD_")) continue;  // of two numbers
      const std::vector<float> values = floats(mesh, name);
      EXPECT_EQ(values.size(), vertices) << name;
      for (const float value : values) EXPECT_TRUE(std::isfinite(value)) << name;
      if (name == "COLOR_0") {
        EXPECT_THAT(values, testing::Each(testing::AllOf(testing::Ge(0), testing::Le(1))));
      } else if (name != "POSITION") {
        EXPECT_THAT(name, testing::MatchesRegex("_[A-Z0-9]+(_[A-Z0-9]+)*"));
      }
    }
  }
};

TEST(VertexColorsFormat, ShowsLightTimesTheColorOfTheSurface) {
  Lightmap map = test::quad_lightmap(test::furnished_room(), 16, 16);
  map.scene.meshes[1].colors.assign(map.scene.meshes[1].positions.size(), {0.5f, 0.25f, 1});
  const test::TempDir folder;
  FileSet files(folder.path());
  write_vertex_colors(map, {}, &files);
  files.commit();
  const auto record = nlohmann::json::parse(read_file(folder / "vertex_light.json"));
  const auto intensity = record["intensity"].get<float>();
  const scene::Scene scene = scene::load_scene(folder / "scene.glb");
  EXPECT_EQ(scene.triangle_count(), record["triangles"].get<int64_t>());
  EXPECT_GT(scene.triangle_count(), map.scene.triangle_count());
  const Glb glb(folder / "scene.glb");
  EXPECT_THAT(glb.json["extensionsUsed"].dump(), testing::HasSubstr("KHR_materials_unlit"));
  EXPECT_EQ(glb.json["asset"]["extras"]["light_intensity"].get<float>(), intensity);
  int64_t vertices = 0, clipped = 0;
  ASSERT_EQ(scene.meshes.size(), map.scene.meshes.size());
  for (size_t i = 0; i < scene.meshes.size(); ++i) {
    const std::vector<float> color = glb.floats(i, "COLOR_0"), light = glb.floats(i, "_IRRADIANCE");
    const scene::Mesh& mesh = scene.meshes[i];
    ASSERT_EQ(color.size(), 3 * mesh.positions.size());
    ASSERT_EQ(light.size(), color.size());
    ASSERT_EQ(mesh.colors.size(), mesh.positions.size());
    const scene::Material& material =
        map.scene.materials[static_cast<size_t>(map.scene.meshes[i].material)];
    const auto unlit =
        glb.json["materials"][glb.json["meshes"][i]["primitives"][0]["material"].get<size_t>()];
    EXPECT_TRUE(unlit["extensions"].contains("KHR_materials_unlit"));
    for (size_t k = 0; k < color.size(); ++k) {
      const auto c = static_cast<int>(k % 3);
      EXPECT_EQ(mesh.colors[k / 3][c], color[k]);
      const float own = i == 1 ? Rgb{0.5f, 0.25f, 1}[c] : 1;
      const float shown =
          (material.emissive() ? material.emission[c] : own * light[k] / kPi) / intensity;
      EXPECT_NEAR(color[k], std::min(shown, 1.0f), 1e-5f);
      clipped += !material.emissive() && shown > 1 ? 1 : 0;
      EXPECT_GE(color[k], 0);
    }
    if (!material.emissive()) {
      EXPECT_EQ(unlit["pbrMetallicRoughness"]["baseColorFactor"][0].get<float>(),
                material.base_color.x);
    }
    vertices += static_cast<int64_t>(mesh.positions.size());
  }
  EXPECT_EQ(vertices, record["vertices"].get<int64_t>());
  EXPECT_LT(clipped, vertices / 50);
}

TEST(VertexColorsFormat, ColorIsTheSumOfLightGroups) {
  Lightmap map = test::quad_lightmap(test::furnished_room(), 16, 16);
  ASSERT_EQ(map.layers.size(), 2u);
  map.layers[0].name = "Desk lamp (left)";
  map.layers[1].name = "desk-lamp left";
  map.scene.meshes[1].colors.assign(map.scene.meshes[1].positions.size(), {0.5f, 0.25f, 1});
  const std::vector<std::string> names{"_LIGHT_DESK_LAMP_LEFT", "_LIGHT_DESK_LAMP_LEFT_2"};
  const test::TempDir folder;
  FileSet files(folder.path());
  write_vertex_colors(map, {}, &files);
  files.commit();
  const auto record = nlohmann::json::parse(read_file(folder / "vertex_light.json"));
  ASSERT_EQ(record["groups"].size(), 2u);
  const std::string help = read_file(folder / "README.txt");
  for (size_t l = 0; l < 2; ++l) {
    EXPECT_EQ(record["groups"][l]["name"], map.layers[l].name);
    EXPECT_EQ(record["groups"][l]["attribute"], names[l]);
    EXPECT_THAT(help, testing::HasSubstr(names[l] + "  " + map.layers[l].name + "\n"));
  }
  EXPECT_THAT(help, testing::HasSubstr("gain = {_light_desk_lamp_left: 0.5}"));
  EXPECT_EQ(help.find("{{"), std::string::npos);
  const auto intensity = record["intensity"].get<float>();
  const Glb glb(folder / "scene.glb");
  int lamps = 0;
  for (size_t i = 0; i < map.scene.meshes.size(); ++i) {
    glb.expect_valid(i);
    const std::vector<float> color = glb.floats(i, "COLOR_0"), light = glb.floats(i, "_IRRADIANCE");
    const std::array<std::vector<float>, 2> of{glb.floats(i, names[0]), glb.floats(i, names[1])};
    const scene::Material& material =
        map.scene.materials[static_cast<size_t>(map.scene.meshes[i].material)];
    const int group = map.scene.instances[i].light_group;
    lamps += material.emissive() ? 1 : 0;
    for (size_t k = 0; k < color.size(); ++k) {
      const auto c = static_cast<int>(k % 3);
      const float sum = of[0][k] + of[1][k];
      ASSERT_EQ(color[k], std::min(sum, 1.0f));
      const float own = i == 1 ? Rgb{0.5f, 0.25f, 1}[c] : 1;
      if (material.emissive()) {
        ASSERT_FLOAT_EQ(of[static_cast<size_t>(group)][k], material.emission[c] / intensity);
        ASSERT_EQ(of[static_cast<size_t>(1 - group)][k], 0);
      } else {
        ASSERT_NEAR(sum, own * light[k] / kPi / intensity, 1e-5f * sum + 1e-9f);
      }
    }
  }
  EXPECT_EQ(lamps, 2);
}

TEST(VertexColorsFormat, OneLayerIsTheColorAlone) {
  Lightmap map = test::quad_lightmap(test::furnished_room(), 8, 4);
  map.layers = {{"light", map.total()}};
  const test::TempDir folder;
  FileSet files(folder.path());
  write_vertex_colors(map, {}, &files);
  files.commit();
  const auto record = nlohmann::json::parse(read_file(folder / "vertex_light.json"));
  ASSERT_EQ(record["groups"].size(), 1u);
  EXPECT_EQ(record["groups"][0]["attribute"], "COLOR_0");
  EXPECT_EQ(record["groups"][0]["off_p95"], record["off_p95"]);
  EXPECT_EQ(read_file(folder / "README.txt").find("gain"), std::string::npos);
  const Glb glb(folder / "scene.glb");
  for (size_t i = 0; i < map.scene.meshes.size(); ++i) {
    glb.expect_valid(i);
    for (const auto& [name, accessor] : glb.attributes(i).items())
      EXPECT_FALSE(name.starts_with("_LIGHT")) << name;
  }
}

}  // namespace
}  // namespace lte::bake
