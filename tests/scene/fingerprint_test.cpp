// What moves light changes a fingerprint, and nothing else does.
#include "lte/scene/fingerprint.h"

#include <functional>

#include <gtest/gtest.h>

#include "lte/scene/export.h"
#include "lte/scene/load.h"
#include "tests/support/every_light.h"
#include "tests/support/temp_dir.h"

namespace lte::scene {
namespace {

Scene sample() {
  Scene scene = test::furnished_room();
  scene.textures.push_back(
      std::make_shared<Texture>(2, 1, std::vector<uint8_t>{1, 2, 3, 4, 5, 6}, true));
  scene.lights.push_back({});
  scene.environment.emplace();
  return scene;
}

TEST(Fingerprint, IsThatOfTheContent) {
  const Fingerprint first = fingerprint(sample());
  EXPECT_EQ(first.geometry.size(), 16u);
  EXPECT_EQ(first, fingerprint(sample()));
  Scene renamed = sample();
  renamed.name = renamed.meshes[0].name = renamed.materials[0].name = "other";
  renamed.cameras.push_back({});
  renamed.ignored.push_back("something");
  EXPECT_EQ(first, fingerprint(renamed)) << "names and cameras move no light";
}

TEST(Fingerprint, EveryPartOfLightTransportCounts) {
  struct Change {
    const char* what;
    std::string Fingerprint::*part;
    std::function<void(Scene*)> apply;
  };
  const Change changes[] = {
      {"a vertex", &Fingerprint::geometry,
       [](Scene* s) {
         s->meshes[0].positions[0].y = std::nextafter(s->meshes[0].positions[0].y, 9.f);
       }},
      {"a winding", &Fingerprint::geometry,
       [](Scene* s) { std::swap(s->meshes[0].triangles[0][0], s->meshes[0].triangles[0][1]); }},
      {"a place", &Fingerprint::geometry,
       [](Scene* s) { s->instances[0].to_world.m[0][3] += 1e-3f; }},
      {"a material's mesh", &Fingerprint::geometry, [](Scene* s) { s->meshes[0].material ^= 1; }},
      {"a color", &Fingerprint::materials, [](Scene* s) { s->materials[0].base_color.y *= 0.5f; }},
      {"a roughness", &Fingerprint::materials, [](Scene* s) { s->materials[0].roughness = 0.25f; }},
      {"a texel", &Fingerprint::materials,
       [](Scene* s) {
         s->textures[0] =
             std::make_shared<Texture>(2, 1, std::vector<uint8_t>{1, 2, 3, 4, 5, 7}, true);
       }},
      {"an intensity", &Fingerprint::lights, [](Scene* s) { s->lights[0].intensity.x += 1; }},
      {"the sky", &Fingerprint::lights, [](Scene* s) { s->environment->radiance.z = 2; }},
      {"no sky", &Fingerprint::lights, [](Scene* s) { s->environment.reset(); }},
  };
  const Fingerprint before = fingerprint(sample());
  for (const Change& change : changes) {
    Scene scene = sample();
    change.apply(&scene);
    const Fingerprint after = fingerprint(scene);
    for (std::string Fingerprint::*part :
         {&Fingerprint::geometry, &Fingerprint::materials, &Fingerprint::lights}) {
      if (part == change.part) {
        EXPECT_NE(after.*part, before.*part) << change.what;
      } else {
        EXPECT_EQ(after.*part, before.*part) << change.what;
      }
    }
  }
}

/// Vertices are not to be moved from one mesh to the next unseen.
TEST(Fingerprint, WhereAListEndsCounts) {
  Scene one = sample(), other = sample();
  one.meshes.resize(2);
  other.meshes.resize(2);
  for (Scene* scene : {&one, &other})
    for (Mesh& mesh : scene->meshes) {
      mesh = {};
      mesh.positions = {{0, 0, 0}, {1, 0, 0}};
    }
  one.meshes[0].positions.push_back({2, 0, 0});
  other.meshes[1].positions.insert(other.meshes[1].positions.begin(), {2, 0, 0});
  EXPECT_NE(fingerprint(one).geometry, fingerprint(other).geometry);
}

}  // namespace
}  // namespace lte::scene
