// A bake of a scene that changed since an earlier one: where things lie in the atlas, what is baked
// anew, and whether it is the light of a whole bake.
#include "lte/bake/rebake.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "tests/bake/density.h"
#include "tests/support/scenes.h"

namespace lte::bake {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double kDensity = 12;

/// A long room with a lamp over each end, and a block below one of them.
scene::Scene long_room(const Affine& block) {
  scene::Scene scene;
  const int white = test::add_material(&scene, {0.6f, 0.6f, 0.6f});
  const int lamp = test::add_material(&scene, {0, 0, 0}, {8, 8, 8});
  test::add_instance(&scene, test::box_mesh({0, 0, 0}, {8, 2.5f, 2}, white, true));
  test::add_instance(&scene, test::box_mesh({0, 0, 0}, {0.5f, 0.8f, 0.5f}, white, false), block);
  for (const float x : {0.8f, 6.8f})
    test::add_quad(&scene, {x, 2.45f, 0.8f}, {0.4f, 0, 0}, {0, 0, 0.4f}, lamp);
  return scene;
}

OldAtlas old_atlas(const scene::Scene& scene, const Atlas& atlas) {
  return {"old",
          atlas.width,
          atlas.height,
          atlas.texels_per_metre,
          atlas.kept_uvs,
          atlas.scene,
          mesh_fingerprints(scene)};
}

TEST(Relayout, WhatMovedKeepsItsCharts) {
  const scene::Scene before = long_room(test::translation({0.5f, 0, 0.5f}));
  const scene::Scene now = long_room(test::translation({1.5f, 0, 0.5f}));
  const Layout old = make_layout(before, density(kDensity));
  const Relayout again = lay_out_again(now, old_atlas(before, old.atlas));
  EXPECT_THAT(again.old_instance, ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(again.moved, ElementsAre(0, 1, 0, 0));
  for (size_t i = 0; i < before.instances.size(); ++i) {
    EXPECT_EQ(again.layout.atlas.scene.meshes[i].name, old.atlas.scene.meshes[i].name);
    const auto& uv = again.layout.atlas.scene.meshes[i].uvs[1];
    const auto& was = old.atlas.scene.meshes[i].uvs[1];
    ASSERT_EQ(uv.size(), was.size());
    for (size_t v = 0; v < uv.size(); ++v) EXPECT_TRUE(uv[v].x == was[v].x && uv[v].y == was[v].y);
  }
  EXPECT_EQ(again.layout.texels.pixel, old.texels.pixel);
}

TEST(Relayout, WhatIsNewLiesWhereNothingIs) {
  const scene::Scene before = long_room({});
  scene::Scene now = before;
  const Layout old = make_layout(before, density(kDensity));
  test::add_instance(&now, test::box_mesh({4, 0, 1}, {4.3f, 0.3f, 1.3f}, 0, false));
  const Relayout again = lay_out_again(now, old_atlas(before, old.atlas));
  EXPECT_THAT(again.old_instance, ElementsAre(0, 1, 2, 3, scene::kNone));
  std::vector<uint8_t> taken(size_t{4096} * 4096);
  for (const uint32_t pixel : old.texels.pixel) taken[pixel] = 1;
  const Texels& texels = again.layout.texels;
  int fresh = 0;
  for (size_t i = 0; i < texels.size(); ++i) {
    if (texels.fragments[texels.first[i]].instance != 4) continue;
    ++fresh;
    EXPECT_EQ(taken[texels.pixel[i]], 0);
  }
  EXPECT_GT(fresh, 60);
  EXPECT_EQ(texels.size(), old.texels.size() + static_cast<size_t>(fresh));
}

TEST(Relayout, SaysWhatDoesNotFit) {
  const scene::Scene before = long_room({});
  const OldAtlas old = old_atlas(before, make_layout(before, density(kDensity)).atlas);
  scene::Scene large = before;
  test::add_instance(&large, test::box_mesh({-20, 0, 0}, {-9, 9, 9}, 0, false));
  EXPECT_THAT([&] { lay_out_again(large, old); }, ThrowsMessage<Error>(HasSubstr("no room")));
  scene::Scene other;
  test::add_quad(&other, {0, 0, 0}, {0, 0, 3}, {3, 0, 0}, test::add_material(&other, {1, 1, 1}));
  EXPECT_THAT([&] { lay_out_again(other, old); },
              ThrowsMessage<Error>(HasSubstr("nothing of what it shows")));
  // A block of another size has charts of its own.
  const Relayout grown = lay_out_again(long_room(test::scaling({0.2f, 0.1f, 0.2f})), old);
  EXPECT_EQ(grown.old_instance[1], scene::kNone);
}

struct Baked {
  LightState state;
  TexelLight light;
};

Baked bake_whole(const render::TracedScene& scene, const Layout& layout, LightOptions options,
                 uint64_t seed) {
  render::CacheSettings cache;
  cache.seed = options.seed = seed;
  const auto gather = render::make_gather(scene, cache);
  gather->prepare();
  Baked out;
  out.state = sample_texels(scene, *gather, layout.atlas, layout.texels, options);
  out.light =
      light_of(scene.bvh, gather->method(), layout.atlas, layout.texels, options, out.state);
  return out;
}

/// A share of these values is not larger.
double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<size_t>(share * static_cast<double>(values.size() - 1))];
}

TEST(Rebake, IsTheLightOfAWholeBake) {
  const scene::Scene before = long_room(test::translation({0.7f, 0, 0.5f}));
  const scene::Scene now = long_room(test::translation({1.3f, 0, 0.8f}));
  const pathtrace::Bvh old_bvh(before), bvh(now);
  const pathtrace::Lights old_lights(before), lights(now);
  const render::TracedScene was{old_bvh, old_lights}, is{bvh, lights};
  LightOptions options;
  options.direct = true;
  options.passes = 16;
  const Layout old_layout = make_layout(before, density(kDensity));
  Baked first = bake_whole(was, old_layout, options, 1);
  OldLight old;
  old.state = first.state;
  const Texels& texels = old_layout.texels;
  old.pixel.assign(texels.pixel.begin(), texels.pixel.end());
  old.chart = texels.chart;
  for (size_t i = 0; i < texels.size(); ++i)
    old.instance.push_back(texels.fragments[texels.first[i]].instance);
  Lightmap old_map = make_lightmap(old_bvh, old_layout, {{"light", first.light}}, {}, nullptr);
  old.picture = old_map.layers[0].irradiance;
  old.mask = old_map.mask;

  const Relayout again = lay_out_again(now, old_atlas(before, old_layout.atlas));
  const Kept kept = find_changes(was, is, again, old, options, {0.05});
  render::CacheSettings cache;
  cache.seed = 2;
  const auto gather = render::make_gather(is, cache);
  gather->prepare();
  options.seed = 2;
  LightState state = rebake(is, *gather, again.layout, options, old, kept);
  int uncovered = 0;
  for (size_t i = 0; i < again.layout.texels.size(); ++i) {
    const int32_t there = kept.old_texel[i];
    if (there == kNew || old.state.dark[static_cast<size_t>(there)] == 0 || state.dark[i] != 0)
      continue;
    ++uncovered;
    EXPECT_GT(state.rate[i], 1);
  }
  EXPECT_GT(uncovered, 5);
  const TexelLight light =
      rebaked_light(bvh, gather->method(), again.layout, options, std::move(state), old, kept);
  Lightmap map = make_lightmap(bvh, again.layout, {{"light", light}}, {}, nullptr);
  restore_kept(again.layout, old, kept, &map);

  const Baked a = bake_whole(is, again.layout, options, 3);
  const Baked b = bake_whole(is, again.layout, options, 4);
  double mean = 0;
  for (const Rgb& value : a.light.irradiance) mean += double{value.y};
  mean /= static_cast<double>(a.light.irradiance.size());
  std::vector<double> off, noise, stale;
  size_t same = 0, shadow = 0;
  for (size_t i = 0; i < again.layout.texels.size(); ++i) {
    const size_t pixel = again.layout.texels.pixel[i];
    if (kept.changed[i] == 0) {
      ++same;
      for (size_t c = 0; c < 3; ++c)
        ASSERT_EQ(map.layers[0].irradiance[3 * pixel + c], old.picture[3 * pixel + c]);
    }
    if (a.light.dark[i] != 0 || b.light.dark[i] != 0 || light.dark[i] != 0) continue;
    const double one = double{a.light.irradiance[i].y}, two = double{b.light.irradiance[i].y};
    const double floor = (one + two) / 2 + 0.1 * mean;
    off.push_back(std::abs(double{light.irradiance[i].y} - one) / floor);
    noise.push_back(std::abs(two - one) / floor);
    stale.push_back(std::abs(double{old.picture[3 * pixel + 1]} - one) / floor);
    shadow += stale.back() > 0.3 ? 1 : 0;
  }
  // The far end of the room is as it was; shadows are not.
  EXPECT_GT(same, again.layout.texels.size() / 4);
  EXPECT_LT(same, again.layout.texels.size());
  EXPECT_GT(shadow, 20u);
  EXPECT_LT(quantile(off, 0.99), quantile(noise, 0.99) + 0.05);
  EXPECT_GT(quantile(stale, 0.99), 2 * (quantile(noise, 0.99) + 0.05));
  EXPECT_LT(quantile(off, 0.5), quantile(noise, 0.5) + 0.02);
}

TEST(Rebake, NothingIsBakedAnewWhereNothingChanged) {
  const scene::Scene scene = long_room({});
  const pathtrace::Bvh bvh(scene);
  const pathtrace::Lights lights(scene);
  const render::TracedScene traced{bvh, lights};
  LightOptions options;
  options.direct = true;
  options.passes = 2;
  const Layout layout = make_layout(scene, density(kDensity));
  OldLight old;
  old.state = bake_whole(traced, layout, options, 1).state;
  old.pixel.assign(layout.texels.pixel.begin(), layout.texels.pixel.end());
  old.chart = layout.texels.chart;
  for (size_t i = 0; i < layout.texels.size(); ++i)
    old.instance.push_back(layout.texels.fragments[layout.texels.first[i]].instance);
  const Relayout again = lay_out_again(scene, old_atlas(scene, layout.atlas));
  const Kept kept = find_changes(traced, traced, again, old, options, {1e-4});
  EXPECT_EQ(std::count(kept.changed.begin(), kept.changed.end(), 1), 0);
}

}  // namespace
}  // namespace lte::bake
