#include "datagen/common/metals.h"

#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "datagen/dataset/generate.h"
#include "tests/datagen/scenes.h"

namespace lte::datagen::test {
namespace {

scene::Scene scene_of(double share, uint64_t seed, GeneratorKind generator = GeneratorKind::Boxes) {
  DatagenConfig config = tiny_config();
  config.generator = generator;
  config.metals.share = share;
  config.homes.rooms = {1, 1};
  config.homes.detail = {0.3, 0.3};
  config.homes.texture_sizes = {8};
  return generate_scene(config, seed, "room");
}

int count_metals(const scene::Scene& scene) {
  int count = 0;
  for (const scene::Material& material : scene.materials) count += material.metallic > 0 ? 1 : 0;
  return count;
}

TEST(Metals, AreOfTheAskedShareAndRoughnessAndNeverLamps) {
  int metals = 0, materials = 0;
  std::set<float> roughness;
  for (uint64_t seed = 0; seed < 40; ++seed) {
    for (const scene::Material& material : scene_of(0.25, seed).materials) {
      if (material.emissive()) {
        EXPECT_EQ(material.metallic, 0);
        continue;
      }
      ++materials;
      if (material.metallic == 0) continue;
      ++metals;
      EXPECT_EQ(material.metallic, 1);
      EXPECT_GE(material.roughness, 0.05f - 1e-6f);
      EXPECT_LE(material.roughness, 0.5f + 1e-6f);
      roughness.insert(material.roughness);
    }
  }
  // Rooms without any would get one, so the mean lies a little above the share.
  EXPECT_NEAR(metals, 0.26 * materials, 4 * std::sqrt(0.25 * 0.75 * materials));
  EXPECT_LT(*roughness.begin(), 0.08f);
  EXPECT_GT(*roughness.rbegin(), 0.3f);
}

TEST(Metals, EverySceneHasOneUnlessNoneIsAskedFor) {
  for (uint64_t seed = 0; seed < 20; ++seed) {
    EXPECT_GE(count_metals(scene_of(1e-6, seed)), 1);
    EXPECT_EQ(count_metals(scene_of(0, seed)), 0);
  }
  EXPECT_GE(count_metals(scene_of(1e-6, 3, GeneratorKind::Homes)), 1);
}

TEST(Metals, TheRestOfTheSceneStaysWhatItIs) {
  const scene::Scene plain = scene_of(0, 7), metal = scene_of(0.5, 7);
  ASSERT_EQ(plain.materials.size(), metal.materials.size());
  ASSERT_EQ(plain.instances.size(), metal.instances.size());
  for (size_t i = 0; i < plain.materials.size(); ++i) {
    EXPECT_EQ(plain.materials[i].name, metal.materials[i].name);
    EXPECT_EQ(plain.materials[i].base_color_texture.texture,
              metal.materials[i].base_color_texture.texture);
    if (metal.materials[i].metallic > 0) continue;
    for (int c = 0; c < 3; ++c)
      EXPECT_EQ(plain.materials[i].base_color[c], metal.materials[i].base_color[c]);
  }
  const scene::Scene again = scene_of(0.5, 7);
  for (size_t i = 0; i < metal.materials.size(); ++i)
    EXPECT_EQ(again.materials[i].roughness, metal.materials[i].roughness);
}

TEST(Metals, AreConfiguredInRangeAndWrittenWhereAskedFor) {
  DatagenConfig config = tiny_config();
  EXPECT_EQ(to_yaml(config).find("metals"), std::string::npos);
  config.metals.share = 0.3;
  EXPECT_NE(to_yaml(config).find("metals"), std::string::npos);
  const auto bad = [](double share, const Range& roughness) {
    DatagenConfig other = tiny_config();
    other.metals = {share, roughness};
    EXPECT_THROW(check_datagen_config(other), Error);
  };
  bad(1.5, {0.1, 0.5});
  bad(0.5, {0.5, 0.1});
  bad(0.5, {0.1, 1.5});
}

}  // namespace
}  // namespace lte::datagen::test
