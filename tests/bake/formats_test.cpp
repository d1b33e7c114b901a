#include "lte/bake/formats/formats.h"

#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <set>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "lte/bake/formats/engine_scene.h"
#include "lte/base/half.h"
#include "lte/image/exr.h"
#include "lte/scene/load.h"
#include "tests/bake/quad_lightmap.h"
#include "tests/image/ktx2_reader.h"
#include "tests/support/file_limit.h"
#include "tests/support/temp_dir.h"

namespace lte::bake {
namespace {

using test::error_of;
using test::TempDir;
using testing::ElementsAre;
using testing::HasSubstr;

const Lightmap& room_map() {
  static const Lightmap map = test::quad_lightmap(test::furnished_room(), 4, 16);
  return map;
}

const Format& format_of(std::string_view name) {
  for (const Format& format : engine_formats()) {
    if (format.name == name) return format;
  }
  throw Error("no such format");
}

/// A module that has the names which write_three() looks for.
std::filesystem::path three_module(const TempDir& folder) {
  test::write_text(folder / "module.js",
                   "export class GLTFLoader {} export class OrbitControls {} "
                   "export class DataTexture {}");
  return folder / "module.js";
}

void write(std::string_view format, const std::filesystem::path& folder,
           const FormatOptions& options = {}, const Lightmap& map = room_map()) {
  FileSet files(folder);
  format_of(format).write(map, options, &files);
  files.commit();
}

TEST(EngineFormats, EachHasSceneRecordAndTenLinesOfHelp) {
  const TempDir folder;
  std::vector<std::string> names;
  for (const Format& format : engine_formats()) {
    names.emplace_back(format.name);
    if (format.name == "vertex-colors") continue;  // has no picture
    const auto out = folder / names.back();
    write(format.name, out, {three_module(folder)});
    const auto record = nlohmann::json::parse(read_file(out / "lightmap.json"));
    EXPECT_TRUE(std::filesystem::exists(out / record["image"].get<std::string>())) << record;
    EXPECT_THAT(record["units"].get<std::string>(),
                testing::StartsWith(format.name == "three" ? "irradiance E in" : "E / pi in"));
    const std::string help = read_file(out / "README.txt");
    EXPECT_THAT(help, HasSubstr("room.glb"));
    const auto lines = std::count(help.begin(), help.end(), '\n');
    EXPECT_GE(lines, 9) << format.name;
    EXPECT_LE(lines, 16) << format.name;
    const scene::Scene scene = scene::load_scene(out / "scene.glb");
    ASSERT_EQ(scene.instances.size(), room_map().placements.size()) << format.name;
    EXPECT_EQ(scene.meshes[2].uvs[1].size(), room_map().scene.meshes[2].uvs[1].size());
    EXPECT_EQ(scene.meshes[2].uvs[1][5].x, room_map().scene.meshes[2].uvs[1][5].x);
  }
  EXPECT_THAT(names, ElementsAre("bevy", "blender", "godot", "three", "vertex-colors"));
}

TEST(EngineFormats, NodesHaveNamesThatNoImporterTakesForOrders) {
  Lightmap map = room_map();
  map.placements[0].name = map.placements[1].name = "Wall-col";
  map.placements[2].name = "a/b:c \"d\"@%.é";
  std::set<std::string> names;
  for (size_t i = 0; i < map.placements.size(); ++i) {
    const std::string name = node_name(map, i);
    EXPECT_TRUE(names.insert(name).second) << name;
    EXPECT_EQ(name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_"
                                     "0123456789"),
              std::string::npos)
        << name;
    // Godot strips digits and underscores from the end before it looks for "-col".
    EXPECT_EQ(name.substr(0, name.find_last_not_of("0123456789_") + 1).back(), 'n') << name;
  }
}

TEST(EngineFormats, LampsInTheMapDoNotShineTwice) {
  Lightmap map = room_map();
  test::add_point_light(&map.scene, {1, 1, 1}, {1, 1, 1});
  map.scene.materials[0].metallic = 1;
  EXPECT_TRUE(engine_scene(map).lights.empty());
  EXPECT_EQ(engine_scene(map).materials[0].metallic, 0) << "baked as matt";
  map.provenance.include = "indirect";
  EXPECT_EQ(engine_scene(map).lights.size(), 1u);
}

TEST(ThreeFormat, HasEveryTexelOfEveryLayer) {
  const TempDir folder;
  write("three", folder / "out", {three_module(folder)});
  const std::string bytes = read_file(folder / "out/lightmap.bin");
  const Lightmap& map = room_map();
  ASSERT_EQ(map.layers.size(), 2u);
  ASSERT_EQ(bytes.size(), 2 * map.pixels() * 8);
  for (size_t l = 0; l < 2; ++l) {
    for (size_t i = 0; i < map.pixels(); ++i) {
      std::array<Half, 4> texel;
      std::memcpy(texel.data(), bytes.data() + (l * map.pixels() + i) * 8, 8);
      for (size_t c = 0; c < 3; ++c)
        ASSERT_EQ(texel[c], to_half(map.layers[l].irradiance[3 * i + c])) << l << ' ' << i;
      ASSERT_EQ(to_float(texel[3]), 1);
    }
  }
  const std::string page = read_file(folder / "out/index.html");
  EXPECT_THAT(page, HasSubstr(R"({"height":20,"layers":["light0","light1"],"width":20})"));
  EXPECT_EQ(page.find("{{"), std::string::npos);
}

TEST(ThreeFormat, NeedsAModuleAndKeepsWhatWasThere) {
  const TempDir folder;
  test::write_text(folder / "index.html", "old");
  EXPECT_THAT(error_of([&] { write("three", folder.path()); }), HasSubstr("needs --three FILE"));
  test::write_text(folder / "x.js", "export class GLTFLoader {}");
  EXPECT_THAT(error_of([&] { write("three", folder.path(), {folder / "x.js"}); }),
              HasSubstr("x.js: expected an ES module that exports three.js, GLTFLoader and "
                        "OrbitControls; it has no OrbitControls"));
  EXPECT_THAT(error_of([&] { write("three", folder.path(), {folder / "none.js"}); }),
              HasSubstr("none.js: cannot read"));
  EXPECT_THAT(folder.names(), ElementsAre("index.html", "x.js"));
  EXPECT_EQ(read_file(folder / "index.html"), "old");
}

TEST(BevyFormat, TextureIsWhatAWhiteSurfaceSendsOut) {
  const TempDir folder;
  ProbeVolume volume;
  volume.grid.counts = {2, 1, 1};
  volume.grid.bounds.extend({-1, 0, 0});
  volume.grid.bounds.extend({3, 2, 1});
  volume.probes.resize(2);
  write("bevy", folder.path(), {{}, &volume});
  const image::Ktx2 texture = test::read_ktx2(folder / "lightmap.ktx2");
  const std::vector<float> total = room_map().total();
  ASSERT_EQ(texture.texels.size(), room_map().pixels());
  for (size_t i = 0; i < texture.texels.size(); ++i) {
    const Rgb value = Rgb{total[3 * i], total[3 * i + 1], total[3 * i + 2]} * (1 / kPi);
    ASSERT_NEAR(texture.texels[i].x, value.x, max_component(value) / 256);
  }
  const std::string help = read_file(folder / "README.txt");
  EXPECT_THAT(help, HasSubstr("from_translation(Vec3::new(1_f32, 1_f32, 0.5_f32))"));
  EXPECT_THAT(help, HasSubstr("with_scale(Vec3::new(4_f32, 2_f32, 1_f32))"));
  EXPECT_EQ(test::read_ktx2(folder / "irradiance_volume.ktx2").depth, 3);
}

TEST(GodotFormat, FilesHaveTheNamesAndTypesOfItsClasses) {
  const TempDir folder;
  write("godot", folder.path());
  EXPECT_EQ(
      std::system(("python3 " LTE_SOURCE_DIR "/tests/bake/check_godot.py " + folder.path().string())
                      .c_str()),
      0);
  const image::Image picture = image::read_exr(folder / "lightmap.exr");
  const std::vector<float> total = room_map().total();
  for (size_t i = 0; i < total.size(); ++i)
    ASSERT_NEAR(picture.pixels[i], total[i] / kPi, 1e-3 * total[i]);
}

TEST(EngineFormats, AFullDiskLeavesTheOldFiles) {
  const TempDir folder;
  test::write_text(folder / "lightmap.ktx2", "old");
  {
    const test::FileLimit full(1000);
    EXPECT_THAT(error_of([&] { write("bevy", folder.path()); }),
                HasSubstr((folder / "lightmap.ktx2").string() + ": cannot write: File too large"));
  }
  EXPECT_THAT(folder.names(), ElementsAre("lightmap.ktx2"));
  EXPECT_EQ(read_file(folder / "lightmap.ktx2"), "old");
}

}  // namespace
}  // namespace lte::bake
