// Loads PBRT scenes that a test writes out as text.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/file.h"
#include "lte/scene/load.h"
#include "lte/scene/surface.h"
#include "lte/scene/triangle.h"
#include "tests/scene/expect.h"
#include "tests/support/temp_dir.h"

namespace lte::test {

/// A right triangle whose normal is +z.
inline const std::string kTriangle =
    "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 2]\n";

class PbrtTest : public ::testing::Test {
 protected:
  scene::Scene load(const std::string& text, const scene::LoadLimits& limits = {}) {
    write_file(dir_ / "scene.pbrt", text);
    return scene::load_scene(dir_ / "scene.pbrt", limits);
  }
  /// `body` behind WorldBegin.
  scene::Scene load_world(const std::string& body) { return load("WorldBegin\n" + body); }

  /// The error, without the folder of the scene.
  std::string error(const std::string& text, const scene::LoadLimits& limits = {}) {
    std::string message = error_of([&] { load(text, limits); });
    const std::string folder = dir_.path().string() + "/";
    for (size_t at = 0; (at = message.find(folder, at)) != message.npos;)
      message.erase(at, folder.size());
    return message;
  }
  /// What was ignored, without the folder of the scene.
  std::vector<std::string> ignored(const scene::Scene& scene) {
    std::vector<std::string> out = scene.ignored;
    const std::string folder = dir_.path().string() + "/";
    for (std::string& line : out) {
      for (size_t at = 0; (at = line.find(folder, at)) != line.npos;) line.erase(at, folder.size());
    }
    return out;
  }

  TempDir dir_;
};

/// World positions of an instance's vertices.
inline std::vector<Vec3> world_positions(const scene::Scene& scene, size_t instance) {
  std::vector<Vec3> out;
  const scene::Instance& placed = scene.instances.at(instance);
  for (const Vec3& p : scene.meshes.at(static_cast<size_t>(placed.mesh)).positions)
    out.push_back(placed.to_world.point(p));
  return out;
}

/// Front normal of an instance's triangle in the world.
inline Vec3 front(const scene::Scene& scene, size_t instance = 0, uint32_t triangle = 0) {
  return scene::evaluate_surface(scene, static_cast<int>(instance), triangle, 0.3f, 0.3f, 0).normal;
}

inline const scene::Material& material_of(const scene::Scene& scene, size_t instance = 0) {
  const scene::Instance& placed = scene.instances.at(instance);
  return scene.materials.at(
      static_cast<size_t>(scene.meshes.at(static_cast<size_t>(placed.mesh)).material));
}

/// World area of an instance, m².
inline double area_of(const scene::Scene& scene, size_t instance = 0) {
  const scene::Instance& placed = scene.instances.at(instance);
  const scene::Mesh& mesh = scene.meshes.at(static_cast<size_t>(placed.mesh));
  double sum = 0;
  for (uint32_t i = 0; i < mesh.triangles.size(); ++i)
    sum += scene::area(scene::world_triangle(mesh, placed.to_world, i));
  return sum;
}

}  // namespace lte::test
