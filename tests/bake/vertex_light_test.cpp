// Light at vertices: the cut triangles, their light against a closed form, and the file.
#include "lte/bake/vertex_light.h"

#include <cmath>
#include <cstring>
#include <map>
#include <set>
#include <tuple>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "lte/bake/bake.h"
#include "lte/bake/formats/formats.h"
#include "lte/bake/refined_scene.h"
#include "lte/base/random.h"
#include "lte/scene/load.h"
#include "lte/scene/triangle.h"
#include "tests/bake/quad_lightmap.h"
#include "tests/support/closed_forms.h"
#include "tests/support/temp_dir.h"

namespace lte::bake {
namespace {

using Place = std::tuple<float, float, float>;

double area_of(const RefinedScene& refined) {
  double out = 0;
  for (const Leaf& leaf : refined.leaves()) {
    const auto& positions = refined.scene().meshes[leaf.instance].positions;
    out += scene::area(
        {positions[leaf.vertex[0]], positions[leaf.vertex[1]], positions[leaf.vertex[2]]});
  }
  return out;
}

/// A room whose walls are meshes of their own, and a sphere in it.
scene::Scene room_of_walls() {
  scene::Scene scene;
  const int white = test::add_material(&scene, {0.5f, 0.5f, 0.5f});
  const scene::Mesh room = test::box_mesh({0, 0, 0}, {4, 2.5f, 3}, white, true);
  for (size_t t = 0; t < room.triangles.size(); t += 2) {
    scene::Mesh wall = room;
    wall.triangles = {room.triangles[t], room.triangles[t + 1]};
    test::add_instance(&scene, wall);
  }
  test::add_instance(&scene, test::inward_sphere_mesh(0.5f, 3, white),
                     test::translation({1.75f, 1.25f, 1.5f}));
  return scene;
}

std::vector<uint32_t> some_leaves(const RefinedScene& refined, Rng* rng) {
  std::vector<uint32_t> out;
  for (uint32_t i = 0; i < refined.leaves().size(); ++i)
    if (rng->uniform() < 0.2f) out.push_back(i);
  return out;
}

TEST(RefinedScene, HasNoCracks) {
  RefinedScene refined(room_of_walls());
  const double before = area_of(refined);
  Rng rng(1, 2);
  for (int round = 0; round < 6; ++round) EXPECT_TRUE(refined.halve(some_leaves(refined, &rng)));
  EXPECT_GT(refined.leaves().size(), 2000u);
  EXPECT_NEAR(area_of(refined), before, 1e-4 * before);
  std::set<Place> corners;
  std::map<uint32_t, Place> of_point;
  const auto at = [&](const Leaf& leaf, size_t k) {
    return refined.scene().instances[leaf.instance].to_world.point(
        refined.scene().meshes[leaf.instance].positions[leaf.vertex[k]]);
  };
  for (const Leaf& leaf : refined.leaves()) {
    for (size_t k = 0; k < 3; ++k) {
      const Vec3 p = at(leaf, k);
      corners.insert({p.x, p.y, p.z});
      EXPECT_EQ(of_point.try_emplace(leaf.point[k], p.x, p.y, p.z).first->second,
                Place(p.x, p.y, p.z));
    }
  }
  for (const Leaf& leaf : refined.leaves()) {
    for (size_t k = 0; k < 3; ++k) {
      const Vec3 middle = (at(leaf, k) + at(leaf, (k + 1) % 3)) * 0.5f;
      EXPECT_FALSE(corners.contains({middle.x, middle.y, middle.z}));
    }
  }
}

TEST(RefinedScene, IsAsItWasWhereItWouldExceedTheLimit) {
  RefinedScene refined(room_of_walls()), other(room_of_walls());
  const auto expect_same = [&] {
    ASSERT_EQ(refined.leaves().size(), other.leaves().size());
    for (size_t i = 0; i < refined.leaves().size(); ++i) {
      const Leaf &a = refined.leaves()[i], &b = other.leaves()[i];
      EXPECT_EQ(a.instance, b.instance);
      EXPECT_EQ(a.point, b.point);
      for (size_t k = 0; k < 3; ++k) {
        const Vec3& p = refined.scene().meshes[a.instance].positions[a.vertex[k]];
        const Vec3& q = other.scene().meshes[b.instance].positions[b.vertex[k]];
        EXPECT_TRUE(p.x == q.x && p.y == q.y && p.z == q.z);
      }
    }
  };
  Rng rng(5, 6);
  for (int round = 0; round < 4; ++round) {
    const std::vector<uint32_t> which = some_leaves(refined, &rng);
    const size_t before = refined.leaves().size();
    // One more than the leaves themselves: what fits their edges exceeds it.
    EXPECT_FALSE(refined.halve(which, before + which.size() + 1));
    EXPECT_FALSE(refined.halve(some_leaves(refined, &rng), before));
    expect_same();
    EXPECT_TRUE(refined.halve(which));
    other.halve(which);
    EXPECT_GT(refined.leaves().size(), before + which.size() + 1);
    expect_same();
    EXPECT_TRUE(refined.halve({}, refined.leaves().size()));
  }
}

/// Lamps of 1 m² over a black floor and before a black wall of 1.5 m that meets it, as a light map
/// without noise, a layer each.
struct LampsOverCorner {
  static constexpr float kRadiance = 5, kWall = 1.5f;
  scene::Scene scene;
  std::vector<std::vector<Vec3>> lamps;
  Lightmap map;

  explicit LampsOverCorner(const std::vector<Vec3>& corners = {{1.5f, 2, 0.5f}}) {
    const int black = test::add_material(&scene, {0, 0, 0});
    test::add_quad(&scene, {0, 0, 0}, {0, 0, 4}, {4, 0, 0}, black);
    test::add_quad(&scene, {0, 0, 0}, {4, 0, 0}, {0, kWall, 0}, black);
    const int lit = test::add_material(&scene, {0, 0, 0}, Rgb{1, 0.5f, 0.25f} * kRadiance);
    for (const Vec3& at : corners) {
      const Vec3 x{1, 0, 0}, z{0, 0, 1};
      test::add_quad(&scene, at, x, z, lit);
      lamps.push_back({at, at + x, at + x + z, at + z});
    }
    map = test::quad_lightmap(scene, 64, 1);
    for (size_t lamp = 0; lamp < lamps.size(); ++lamp)
      for (const size_t quad : {size_t{0}, size_t{1}}) paint(lamp, quad);
  }

  /// Of the red light of a lamp.
  double known(const Vec3& position, const Vec3& normal, size_t lamp = 0) const {
    return kRadiance * test::polygon_irradiance(lamps[lamp], position, normal);
  }

  /// Errors at random places of the triangles of floor and wall, as VertexOptions has them, of
  /// lamps with gains.
  std::vector<double> errors(const VertexLight& found,
                             const std::vector<float>& gains = {1}) const {
    std::vector<double> out;
    double mean = 0;
    for (const bool with_mean : {false, true}) {
      Rng rng(3, 4);
      for (size_t i = 0; i < 2; ++i) {
        const scene::Mesh& mesh = found.meshes[i];
        for (const auto& corner : mesh.triangles) {
          const float u = rng.uniform(), v = (1 - u) * rng.uniform();
          const std::array<float, 3> share{1 - u - v, u, v};
          Vec3 at;
          for (size_t k = 0; k < 3; ++k) at += mesh.positions[corner[k]] * share[k];
          double light = 0, want = 0;
          for (size_t l = 0; l < lamps.size(); ++l) {
            for (size_t k = 0; k < 3; ++k) {
              light += double{gains[l] * found.layers[l].irradiance[i][corner[k]].x * share[k]};
            }
            want += double{gains[l]} * known(at, i == 0 ? Vec3{0, 1, 0} : Vec3{0, 0, 1}, l);
          }
          if (with_mean)
            out.push_back(std::abs(light - want) / std::max(want, 0.1 * mean));
          else
            mean += want;
        }
      }
      mean /= static_cast<double>(found.triangles);
    }
    std::sort(out.begin(), out.end());
    return out;
  }

 private:
  void paint(size_t lamp, size_t quad) {
    const Placement& place = map.placements[quad];
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < 64; ++x) {
        const int px = static_cast<int>(place.min.x * static_cast<float>(map.width)) + x;
        const int py = static_cast<int>(place.min.y * static_cast<float>(map.height)) + y;
        const Vec2 at{4 * static_cast<float>(x) / 63, 4 * static_cast<float>(y) / 63};
        // Corner 1 of a quad is along its first edge, and so is u.
        const double light = quad == 0 ? known({at.y, 0, at.x}, {0, 1, 0}, lamp)
                                       : known({at.x, at.y * kWall / 4, 0}, {0, 0, 1}, lamp);
        for (size_t c = 0; c < 3; ++c) {
          map.layers[lamp].irradiance[3 * (static_cast<size_t>(py) * map.width + px) + c] =
              static_cast<float>(light) / static_cast<float>(1 << c);
        }
      }
    }
  }
};

TEST(VertexLight, IsTheClosedFormBetweenVertices) {
  const LampsOverCorner lamp;
  VertexOptions options;
  size_t last = 0;
  for (const double bend : {0.2, 0.05, 0.02}) {
    options.bend = bend;
    const VertexLight found = vertex_light(lamp.map, options);
    EXPECT_EQ(found.triangles_before, 6);
    EXPECT_FALSE(found.limited);
    const std::vector<double> off = lamp.errors(found);
    EXPECT_LT(off[off.size() * 95 / 100], bend);
    EXPECT_LT(off.back(), 2.5 * bend);
    EXPECT_LT(found.off_p95, bend);
    EXPECT_GT(off.size(), last);
    last = off.size();
  }
  EXPECT_LT(last, 64u * 64 / 2);  // as few as it takes
  options.bend = 10;
  const std::vector<double> flat = lamp.errors(vertex_light(lamp.map, options));
  EXPECT_EQ(flat.size(), 4u);
  EXPECT_GT(flat.back(), 0.3);
}

TEST(VertexLight, OfACornerIsThatOfItsOwnSide) {
  const LampsOverCorner lamp;
  VertexOptions options;
  options.bend = 0.02;
  const VertexLight found = vertex_light(lamp.map, options);
  int64_t corners = 0;
  for (size_t i = 0; i < 2; ++i) {
    const scene::Mesh& mesh = found.meshes[i];
    for (size_t v = 0; v < mesh.positions.size(); ++v) {
      const Vec3& p = mesh.positions[v];
      if (p.y != 0 || p.z != 0) continue;
      const double want = lamp.known(p, i == 0 ? Vec3{0, 1, 0} : Vec3{0, 0, 1});
      const double other = lamp.known(p, i == 0 ? Vec3{0, 0, 1} : Vec3{0, 1, 0});
      EXPECT_NEAR(double{found.total(i)[v].x}, want, 0.06 * want) << p.x;
      if (p.x > 1 && p.x < 3) {
        EXPECT_GT(std::abs(want - other), 0.2 * want);
      }
      ++corners;
    }
  }
  EXPECT_GT(corners, 8);
}

TEST(VertexLight, StopsAtTheLimit) {
  const LampsOverCorner lamp;
  const VertexLight found = vertex_light(lamp.map, {0.02, 200});
  EXPECT_TRUE(found.limited);
  EXPECT_LE(found.triangles, 200);
  EXPECT_GT(found.triangles, 100);
  EXPECT_LT(found.off_p95, 0.2);
  EXPECT_EQ(vertex_light(lamp.map, {0.02, 1}).triangles, 6);
}

const std::vector<Vec3> kTwoLamps{{1.5f, 2, 0.5f}, {2.6f, 1.6f, 2.2f}};

TEST(VertexLight, LayersAreTheClosedFormsOfTheirLampsHoweverDimmed) {
  const LampsOverCorner lamps(kTwoLamps);
  VertexOptions options;
  for (const double bend : {0.2, 0.05}) {
    options.bend = bend;
    const VertexLight found = vertex_light(lamps.map, options);
    ASSERT_EQ(found.layers.size(), 2u);
    EXPECT_EQ(found.layers[0].name, "light0");
    EXPECT_EQ(found.layers[1].name, "light1");
    EXPECT_LT(found.off_p95, bend);
    for (const VertexLayer& layer : found.layers) EXPECT_LT(layer.off_p95, bend);
    for (const std::vector<float>& gains :
         std::vector<std::vector<float>>{{1, 1}, {1, 0}, {0, 1}, {0.1f, 1}, {3, 0.2f}}) {
      const std::vector<double> off = lamps.errors(found, gains);
      EXPECT_LT(off[off.size() * 95 / 100], bend) << gains[0] << ' ' << gains[1];
      EXPECT_LT(off.back(), 2.5 * bend) << gains[0] << ' ' << gains[1];
    }
  }
}

TEST(VertexLight, OfALayerIsThatOfItsLampAlone) {
  const LampsOverCorner lamps(kTwoLamps);
  VertexOptions whole;
  whole.bend = 10;  // triangles as they are
  const VertexLight found = vertex_light(lamps.map, whole);
  for (size_t l = 0; l < 2; ++l) {
    for (const float gain : {1.0f, 0.3f}) {
      Lightmap alone = lamps.map;
      alone.layers = {lamps.map.layers[l]};
      for (float& value : alone.layers[0].irradiance) value *= gain;
      const VertexLight one = vertex_light(alone, whole);
      for (size_t i = 0; i < found.meshes.size(); ++i) {
        const std::vector<Rgb>& layer = found.layers[l].irradiance[i];
        const std::vector<Rgb> light = one.total(i);
        ASSERT_EQ(layer.size(), light.size());
        for (size_t v = 0; v < layer.size(); ++v) {
          for (int c = 0; c < 3; ++c) {
            if (gain == 1) {
              EXPECT_EQ(layer[v][c], light[v][c]);
            }
            EXPECT_NEAR(gain * layer[v][c], light[v][c], 1e-4f * gain * layer[v][c] + 1e-9f);
          }
        }
      }
    }
  }
}

TEST(VertexLight, IsCutWhereLayersBendAndTheirSumDoesNot) {
  scene::Scene scene;
  test::add_quad(&scene, {0, 0, 0}, {0, 0, 1}, {1, 0, 0},
                 test::add_material(&scene, {0.5f, 0.5f, 0.5f}));
  for (int k = 0; k < 2; ++k) test::add_point_light(&scene, {0, 1, 0}, {1, 1, 1});
  Lightmap map = test::quad_lightmap(scene, 32, 1);
  for (size_t i = 0; i < 3 * map.pixels(); ++i) {
    const float x = static_cast<float>(i / 3 % 32) / 31;
    map.layers[0].irradiance[i] = 1 + 4 * x * x;
    map.layers[1].irradiance[i] = 6 - map.layers[0].irradiance[i];
  }
  VertexOptions options;
  options.bend = 0.05;
  const VertexLight found = vertex_light(map, options);
  EXPECT_GT(found.triangles, 8);
  EXPECT_LT(found.off_p95, 0.01);
  for (const VertexLayer& layer : found.layers) EXPECT_LT(layer.off_p95, 0.05);
  for (const Rgb& light : found.total(0)) EXPECT_NEAR(light.x, 6, 0.05);
  Lightmap sum = map;
  sum.layers = {{"light", map.total()}};
  EXPECT_EQ(vertex_light(sum, options).triangles, 2);
}

TEST(VertexLight, OfInstancesIsTheirOwn) {
  scene::Scene scene;
  const int gray = test::add_material(&scene, {0.5f, 0.5f, 0.5f});
  test::add_quad(&scene, {0, 0, 0}, {0, 0, 1}, {1, 0, 0}, gray);
  test::add_point_light(&scene, {0, 1, 0}, {1, 1, 1});
  test::add_instance(&scene, scene.meshes[0],
                     test::translation({3, 0, 0}) * test::scaling({-1, 1, 1}));
  Lightmap map = test::quad_lightmap(scene, 8, 1);
  for (size_t i = 0; i < map.pixels(); ++i) {
    const bool first = static_cast<int>(i % static_cast<size_t>(map.width)) < 8;
    for (size_t c = 0; c < 3; ++c) map.layers[0].irradiance[3 * i + c] = first ? 2.0f : 6.0f;
  }
  const VertexLight found = vertex_light(map, {});
  ASSERT_EQ(found.meshes.size(), 2u);
  for (size_t v = 0; v < 4; ++v) {
    EXPECT_NEAR(found.total(0)[v].x, 2, 1e-5);
    EXPECT_NEAR(found.total(1)[v].x, 6, 1e-5);
  }
}

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
