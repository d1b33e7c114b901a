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

TEST(RefinedScene, HasNoCracks) {
  // A room whose walls are meshes of their own, and a sphere in it.
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
  RefinedScene refined(scene);
  const double before = area_of(refined);
  Rng rng(1, 2);
  for (int round = 0; round < 6; ++round) {
    std::vector<uint32_t> some;
    for (uint32_t i = 0; i < refined.leaves().size(); ++i)
      if (rng.uniform() < 0.2f) some.push_back(i);
    refined.halve(some);
  }
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

/// A lamp of 1 m² over a black floor and before a black wall of 1.5 m that meets it, as a light map
/// without noise.
struct LampOverCorner {
  static constexpr float kRadiance = 5, kWall = 1.5f;
  scene::Scene scene;
  std::vector<Vec3> lamp{{1.5f, 2, 0.5f}, {2.5f, 2, 0.5f}, {2.5f, 2, 1.5f}, {1.5f, 2, 1.5f}};
  Lightmap map;

  LampOverCorner() {
    const int black = test::add_material(&scene, {0, 0, 0});
    test::add_quad(&scene, {0, 0, 0}, {0, 0, 4}, {4, 0, 0}, black);
    test::add_quad(&scene, {0, 0, 0}, {4, 0, 0}, {0, kWall, 0}, black);
    const int lit = test::add_material(&scene, {0, 0, 0}, Rgb{1, 0.5f, 0.25f} * kRadiance);
    test::add_quad(&scene, {1.5f, 2, 0.5f}, {1, 0, 0}, {0, 0, 1}, lit);
    map = test::quad_lightmap(scene, 64, 1);
    for (int i = 0; i < 2; ++i) {
      const Placement& place = map.placements[static_cast<size_t>(i)];
      for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) {
          const int px = static_cast<int>(place.min.x * static_cast<float>(map.width)) + x;
          const int py = static_cast<int>(place.min.y * static_cast<float>(map.height)) + y;
          const Vec2 at{4 * static_cast<float>(x) / 63, 4 * static_cast<float>(y) / 63};
          // Corner 1 of a quad is along its first edge, and so is u.
          const double light = i == 0 ? known({at.y, 0, at.x}, {0, 1, 0})
                                      : known({at.x, at.y * kWall / 4, 0}, {0, 0, 1});
          for (size_t c = 0; c < 3; ++c) {
            map.layers[0].irradiance[3 * (static_cast<size_t>(py) * map.width + px) + c] =
                static_cast<float>(light) / static_cast<float>(1 << c);
          }
        }
      }
    }
  }

  /// Of the red light.
  double known(const Vec3& position, const Vec3& normal) const {
    return kRadiance * test::polygon_irradiance(lamp, position, normal);
  }

  /// Errors at random places of the triangles of floor and wall, as VertexOptions has them.
  std::vector<double> errors(const VertexLight& found) const {
    std::vector<double> out;
    double mean = 0;
    for (const bool with_mean : {false, true}) {
      Rng rng(3, 4);
      for (size_t i = 0; i < 2; ++i) {
        const scene::Mesh& mesh = found.scene.meshes[i];
        for (const auto& corner : mesh.triangles) {
          const float u = rng.uniform(), v = (1 - u) * rng.uniform();
          const std::array<float, 3> share{1 - u - v, u, v};
          Vec3 at;
          Rgb light;
          for (size_t k = 0; k < 3; ++k) {
            at += mesh.positions[corner[k]] * share[k];
            light += found.irradiance[i][corner[k]] * share[k];
          }
          const double want = known(at, i == 0 ? Vec3{0, 1, 0} : Vec3{0, 0, 1});
          if (with_mean)
            out.push_back(std::abs(double{light.x} - want) / std::max(want, 0.1 * mean));
          else
            mean += want;
        }
      }
      mean /= static_cast<double>(found.triangles);
    }
    std::sort(out.begin(), out.end());
    return out;
  }
};

TEST(VertexLight, IsTheClosedFormBetweenVertices) {
  const LampOverCorner lamp;
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
  const LampOverCorner lamp;
  VertexOptions options;
  options.bend = 0.02;
  const VertexLight found = vertex_light(lamp.map, options);
  int64_t corners = 0;
  for (size_t i = 0; i < 2; ++i) {
    const scene::Mesh& mesh = found.scene.meshes[i];
    for (size_t v = 0; v < mesh.positions.size(); ++v) {
      const Vec3& p = mesh.positions[v];
      if (p.y != 0 || p.z != 0) continue;
      const double want = lamp.known(p, i == 0 ? Vec3{0, 1, 0} : Vec3{0, 0, 1});
      const double other = lamp.known(p, i == 0 ? Vec3{0, 0, 1} : Vec3{0, 1, 0});
      EXPECT_NEAR(double{found.irradiance[i][v].x}, want, 0.06 * want) << p.x;
      if (p.x > 1 && p.x < 3) {
        EXPECT_GT(std::abs(want - other), 0.2 * want);
      }
      ++corners;
    }
  }
  EXPECT_GT(corners, 8);
}

TEST(VertexLight, StopsAtTheLimit) {
  const LampOverCorner lamp;
  const VertexLight found = vertex_light(lamp.map, {0.02, 200});
  EXPECT_TRUE(found.limited);
  EXPECT_LE(found.triangles, 200);
  EXPECT_GT(found.triangles, 100);
  EXPECT_LT(found.off_p95, 0.2);
  EXPECT_EQ(vertex_light(lamp.map, {0.02, 1}).triangles, 6);
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
  ASSERT_EQ(found.irradiance.size(), 2u);
  for (size_t v = 0; v < 4; ++v) {
    EXPECT_NEAR(found.irradiance[0][v].x, 2, 1e-5);
    EXPECT_NEAR(found.irradiance[1][v].x, 6, 1e-5);
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
  std::vector<float> floats(const nlohmann::json& accessor) const {
    EXPECT_EQ(accessor["componentType"], 5126);
    EXPECT_EQ(accessor["type"], "VEC3");
    const nlohmann::json& view = json["bufferViews"][accessor["bufferView"].get<size_t>()];
    std::vector<float> out(3 * accessor["count"].get<size_t>());
    std::memcpy(out.data(), &binary[view.value("byteOffset", size_t{0})],
                out.size() * sizeof(float));
    return out;
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
    const nlohmann::json& attributes = glb.json["meshes"][i]["primitives"][0]["attributes"];
    const auto values = [&](const char* name) {
      return glb.floats(glb.json["accessors"][attributes[name].get<size_t>()]);
    };
    const std::vector<float> color = values("COLOR_0"), light = values("_IRRADIANCE");
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

}  // namespace
}  // namespace lte::bake
