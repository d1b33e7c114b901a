// Loads glTF scenes that a test builds.
#pragma once

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/scene/load.h"
#include "tests/scene/gltf/gltf_builder.h"
#include "tests/support/temp_dir.h"

namespace lte::test {

class GltfTest : public ::testing::Test {
 protected:
  scene::Scene load(GltfBuilder& builder, const scene::LoadLimits& limits = {}) {
    builder.save_embedded(dir_ / "scene.gltf");
    return scene::load_scene(dir_ / "scene.gltf", limits);
  }

  std::string error(GltfBuilder& builder, const scene::LoadLimits& limits = {}) {
    return error_of([&] { load(builder, limits); });
  }

  TempDir dir_;
};

/// The one primitive of the first mesh.
inline Json& first_primitive(GltfBuilder& builder) {
  return builder.json["meshes"][0]["primitives"][0];
}

}  // namespace lte::test
