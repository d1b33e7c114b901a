// Light maps: the light on texels against what is known of it.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "lte/bake/atlas_denoiser.h"
#include "lte/bake/bake.h"
#include "lte/bake/light_group.h"
#include "lte/bake/rates.h"
#include "lte/bake/seams.h"
#include "lte/base/file.h"
#include "lte/base/random.h"
#include "lte/image/exr.h"
#include "lte/pathtrace/irradiance.h"
#include "lte/scene/load.h"
#include "lte/scene/surface.h"
#include "tests/bake/density.h"
#include "tests/support/closed_forms.h"
#include "tests/support/scenes.h"
#include "tests/support/temp_dir.h"

namespace lte::bake {
namespace {

struct Traced {
  explicit Traced(const scene::Scene& scene) : bvh(scene), lights(scene) {}
  render::TracedScene get() const { return {bvh, lights}; }
  pathtrace::Bvh bvh;
  pathtrace::Lights lights;
};

TexelLight path_light(const Traced& traced, const Layout& layout, int passes, int rays) {
  const auto path = render::make_path(traced.get(), 5);
  LightOptions options;
  options.direct = true;
  options.passes = passes;
  options.rays = rays;
  options.seed = 3;
  return light_texels(traced.get(), *path, layout.atlas, layout.texels, options);
}

TEST(AtlasDenoiser, NoiseGoesUpToTheBordersOfCharts) {
  scene::Scene scene;
  const int white = test::add_material(&scene, {1, 1, 1});
  test::add_instance(&scene, test::box_mesh({0, 0, 0}, {1, 1, 1}, white, true));
  const Layout layout = make_layout(scene, density(64));
  const size_t count = layout.texels.size();
  const auto denoiser =
      AtlasDenoiser::find(layout.atlas, layout.texels, std::vector<uint8_t>(count));
  if (!denoiser) GTEST_SKIP() << "Open Image Denoise is not installed";
  Rng rng(5, 1);
  std::vector<Rgb> light;
  for (size_t i = 0; i < count; ++i) {
    const float value = 0.5f + rng.uniform();
    light.push_back({value, value, value});
  }
  const std::vector<Rgb> clean = (*denoiser)(light);
  ASSERT_EQ(clean.size(), count);
  double square = 0, sum = 0, most = 0;
  for (const Rgb& value : clean) {
    const double off = double{value.y} - 1;
    square += off * off / static_cast<double>(count);
    sum += off / static_cast<double>(count);
    most = std::max(most, std::abs(off));
  }
  EXPECT_LT(std::sqrt(square), 0.06) << "of 0.29";
  EXPECT_LT(std::abs(sum), 0.02);
  EXPECT_LT(most, 0.4);
}

TEST(TexelLight, UnderASquareIsItsFormFactor) {
  scene::Scene scene;
  const int black = test::add_material(&scene, {0, 0, 0});
  const int lamp = test::add_material(&scene, {0, 0, 0}, {2, 2, 2});
  test::add_quad(&scene, {0, 0, 0}, {0, 0, 1}, {1, 0, 0}, black);
  test::add_quad(&scene, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}, lamp);
  const Traced traced(scene);
  const Layout layout = make_layout(scene, density(16));
  const TexelLight light = path_light(traced, layout, 16, 16);
  const std::vector<Vec3> square = {{0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1}};
  double sum = 0, squares = 0;
  int64_t count = 0;
  for (size_t i = 0; i < layout.texels.size(); ++i) {
    if (layout.texels.fragments[layout.texels.first[i]].instance != 0) continue;
    const double truth = 2 * std::abs(test::polygon_irradiance(square, layout.texels.position[i],
                                                               layout.texels.normal[i]));
    const double off = double{light.irradiance[i].y} / truth - 1;
    sum += off;
    squares += off * off;
    ++count;
  }
  ASSERT_GT(count, 200);
  EXPECT_LT(std::abs(sum / static_cast<double>(count)), 0.01);
  EXPECT_LT(std::sqrt(squares / static_cast<double>(count)), 0.03);
}

TEST(TexelLight, InAFurnaceIsASeries) {
  scene::Scene scene;
  const int glowing = test::add_material(&scene, {0.5f, 0.5f, 0.5f}, {1, 1, 1});
  test::add_instance(&scene, test::box_mesh({0, 0, 0}, {1, 1, 1}, glowing, true));
  const Traced traced(scene);
  const Layout layout = make_layout(scene, density(10));
  const TexelLight light = path_light(traced, layout, 8, 16);
  const double truth = M_PI * (1 + 0.5 + 0.25 + 0.125 + 0.0625);
  double mean = 0;
  for (size_t i = 0; i < layout.texels.size(); ++i) {
    EXPECT_EQ(light.dark[i], 0);
    // Charts of ten texels are little for a denoiser of pictures.
    EXPECT_NEAR(double{light.irradiance[i].x}, truth, 0.06 * truth);
    mean += double{light.irradiance[i].x} / static_cast<double>(layout.texels.size());
  }
  EXPECT_NEAR(mean, truth, 0.01 * truth);
}

TEST(TexelLight, IsThatOfPathsPointByPoint) {
  const scene::Scene scene = test::furnished_room();
  const Traced traced(scene);
  const Layout layout = make_layout(scene, density(3));
  const auto gather = render::make_gather(traced.get(), {});
  gather->prepare();
  LightOptions options;
  options.passes = 32;
  options.rays = 8;
  options.seed = 5;
  const TexelLight light =
      light_texels(traced.get(), *gather, layout.atlas, layout.texels, options);
  std::vector<Vec3> normals = layout.texels.normal;
  for (size_t i = 0; i < normals.size(); ++i)
    if (light.back[static_cast<size_t>(layout.texels.chart[i])] != 0) normals[i] = -normals[i];
  pathtrace::IrradianceOptions paths;
  paths.rays = 1024;
  const pathtrace::Irradiance truth = pathtrace::estimate_irradiance(
      traced.bvh, traced.lights, layout.texels.position, normals, paths);
  double square = 0, mean = 0;
  int64_t lit = 0, near = 0, dark = 0;
  for (size_t i = 0; i < layout.texels.size(); ++i) {
    const float want = luminance(truth.indirect_sum(static_cast<int64_t>(i)));
    if (light.dark[i] != 0) {
      ++dark;
      EXPECT_EQ(want, 0) << i;
      continue;
    }
    const double off = double{luminance(light.irradiance[i]) - want};
    // A texel of a third of a metre is not its middle: a tenth of the light beside three errors.
    const double bound = 3 * std::sqrt(double{truth.variance[i]}) + 0.1 * double{want} + 0.02;
    near += std::abs(off) < bound ? 1 : 0;
    square += off * off;
    mean += double{want};
    ++lit;
  }
  mean /= static_cast<double>(lit);
  EXPECT_GT(dark, 0);  // under the boxes, and their bottoms
  EXPECT_GT(static_cast<double>(near), 0.95 * static_cast<double>(lit));
  EXPECT_LT(square / static_cast<double>(lit) / (mean * mean), 0.02);
}

/// All paths of records are a quarter of the rays that read them: at least 16 of 16,384 records, up
/// to 64 of more records, and beyond that more of each.
TEST(Records, AreAsManyAsTheirReadersAreWorth) {
  LightOptions options;
  options.rays = 4;
  options.passes = 16;  // 16 paths of records a texel
  const auto of = [&](double texels) {
    const int64_t records = record_count(texels, options);
    return std::pair(records, record_paths(texels, records, options));
  };
  EXPECT_EQ(of(100), std::pair(int64_t{16'384}, 16));
  EXPECT_EQ(of(65'536), std::pair(int64_t{16'384}, 64));
  EXPECT_EQ(of(131'072), std::pair(int64_t{32'768}, 64));
  EXPECT_EQ(of(262'144), std::pair(int64_t{65'536}, 64));
  EXPECT_EQ(of(524'288), std::pair(int64_t{65'536}, 128));
  EXPECT_EQ(of(1e9), std::pair(int64_t{65'536}, 256));
}

TEST(Rates, FollowNoiseOverLight) {
  scene::Scene scene;
  const int white = test::add_material(&scene, {0.5f, 0.5f, 0.5f});
  test::add_quad(&scene, {0, 0, 0}, {0, 0, 4}, {4, 0, 0}, white);
  const Traced traced(scene);
  const Layout layout = make_layout(scene, density(8));
  const size_t count = layout.texels.size();
  const std::vector<uint8_t> none(count);
  const TexelGraph graph(traced.bvh,
                         {layout.texels.position, layout.texels.normal, layout.texels.edge, none});
  // All of one light; halves differ four times as much where x > 2.
  Halves samples{std::vector<Rgb>(count), std::vector<Rgb>(count)};
  for (size_t i = 0; i < count; ++i) {
    const float off = layout.texels.position[i].x > 2 ? 0.4f : 0.1f;
    samples[0][i] = Rgb{1, 1, 1} * (1 + off);
    samples[1][i] = Rgb{1, 1, 1} * (1 - off);
  }
  std::vector<uint8_t> skipped(count);
  skipped[0] = 1;
  const std::vector<uint8_t> rate = sampling_rates(graph, samples, skipped);
  EXPECT_EQ(rate[0], 0);
  double low = 0, high = 0;
  for (size_t i = 1; i < count; ++i) {
    EXPECT_GE(rate[i], kFullRate / 8);
    const Vec3& p = layout.texels.position[i];
    if (p.x > 0.8f && p.x < 1.2f && p.z > 1 && p.z < 3) low = rate[i];
    if (p.x > 2.8f && p.x < 3.2f && p.z > 1 && p.z < 3) high = rate[i];
  }
  // The prior of all texels counts for four of thirteen.
  EXPECT_GT(high, 1.7 * low);
  EXPECT_LT(high, 4 * low);
  EXPECT_EQ(passes_of(kFullRate, 5), 5);
  EXPECT_EQ(passes_of(kFullRate / 8, 9), 2);
}

TEST(TexelLight, IsOfTheSideThatLightReaches) {
  // A room whose faces look outwards, as plain cubes have them.
  scene::Scene scene;
  const int white = test::add_material(&scene, {0.5f, 0.5f, 0.5f});
  test::add_instance(&scene, test::box_mesh({0, 0, 0}, {2, 2, 2}, white, false));
  test::add_point_light(&scene, {1, 1.5f, 1}, {1, 1, 1});
  const Traced traced(scene);
  const Layout layout = make_layout(scene, density(6));
  const TexelLight light = path_light(traced, layout, 2, 4);
  EXPECT_EQ(std::count(light.back.begin(), light.back.end(), 1), layout.atlas.charts);
  EXPECT_EQ(light.two_sided, 0);
  EXPECT_EQ(std::count(light.dark.begin(), light.dark.end(), 1), 0);
}

TEST(TexelLight, OfTwoSidedSurfacesIsTheBrighter) {
  scene::Scene scene;
  const int sheet = test::add_material(&scene, {0.5f, 0.5f, 0.5f}, {}, true);
  test::add_quad(&scene, {0, 0, 0}, {0, 0, 1}, {1, 0, 0}, sheet);  // its front looks up
  test::add_point_light(&scene, {0.5f, 2, 0.5f}, {1, 1, 1});
  test::add_point_light(&scene, {0.5f, -2, 0.5f}, {5, 5, 5});
  const Traced traced(scene);
  const Layout layout = make_layout(scene, density(8));
  const TexelLight light = path_light(traced, layout, 2, 8);
  EXPECT_EQ(light.back, std::vector<uint8_t>{1});
  EXPECT_EQ(light.two_sided, static_cast<int64_t>(layout.texels.size()));
}

TEST(TexelLight, OfCoincidentSheetsIsThatOfTheirSide) {
  const std::array<Vec3, 2> lamp{Vec3{0.3f, 1, 0.4f}, Vec3{0.6f, -1.5f, 0.7f}};
  const std::array<float, 2> intensity{4, 1};
  for (const bool opposite : {false, true}) {
    for (const bool turned : {false, true}) {
      scene::Scene scene;
      const std::array<int, 2> material{test::add_material(&scene, {0.8f, 0.8f, 0.8f}),
                                        test::add_material(&scene, {0.7f, 0.1f, 0.1f})};
      const auto looks_down = [&](size_t i) { return (opposite && i == 1) != turned; };
      for (size_t i = 0; i < 2; ++i) {
        const Vec3 a{0, 0, 1}, b{1, 0, 0};
        test::add_quad(&scene, {0, 0, 0}, looks_down(i) ? b : a, looks_down(i) ? a : b,
                       material[i]);
      }
      for (size_t i = 0; i < 2; ++i)
        test::add_point_light(&scene, lamp[i], Rgb{1, 1, 1} * intensity[i]);
      const Traced traced(scene);
      const Layout layout = make_layout(scene, density(16));
      const auto gather = render::make_gather(traced.get(), {});
      gather->prepare();
      LightOptions options;
      options.direct = true;
      options.rays = 32;
      for (const bool by_paths : {false, true}) {
        const TexelLight light =
            by_paths ? path_light(traced, layout, 8, 32)
                     : light_texels(traced.get(), *gather, layout.atlas, layout.texels, options);
        EXPECT_EQ(std::count(light.back.begin(), light.back.end(), 1), 0);
        EXPECT_EQ(light.two_sided, 0);
        int64_t near = 0;
        for (size_t i = 0; i < layout.texels.size(); ++i) {
          const Fragment& f = layout.texels.fragments[layout.texels.first[i]];
          const size_t side = looks_down(static_cast<size_t>(f.instance)) ? 1 : 0;
          const Vec3 way = lamp[side] - layout.texels.position[i];
          const float want = intensity[side] * std::abs(way.y) / std::pow(dot(way, way), 1.5f);
          EXPECT_EQ(light.dark[i], 0);
          const float off = std::abs(light.irradiance[i].x - want) / want;
          EXPECT_LT(off, 0.3f);  // a lamp of the other side is off by more than a half
          near += off < 0.1f ? 1 : 0;
        }
        EXPECT_GT(static_cast<double>(near), 0.95 * static_cast<double>(layout.texels.size()));
      }
    }
  }
}

TEST(TexelLight, GoesOnAndJoinsToTheSameBytes) {
  const scene::Scene scene = test::furnished_room();
  const Traced traced(scene);
  const Layout layout = make_layout(scene, density(12));
  render::CacheSettings cache;
  cache.records = 512;
  const auto gather = render::make_gather(traced.get(), cache);
  gather->prepare();
  LightOptions options;
  options.passes = 4;
  options.path_passes = 4;
  options.direct = true;
  std::vector<LightState> kept;
  options.keep = [&](const LightState& state) { kept.push_back(state); };
  std::vector<double> shares;
  options.progress = [&](double share) { shares.push_back(share); };
  const auto sampled = [&](const LightOptions& with) {
    return sample_texels(traced.get(), *gather, layout.atlas, layout.texels, with);
  };
  const auto light = [&](LightState state) {
    return light_of(traced.bvh, gather->method(), layout.atlas, layout.texels, options,
                    std::move(state));
  };
  const TexelLight whole = light(sampled(options));
  ASSERT_GE(kept.size(), 4u);
  EXPECT_GT(shares.size(), 8u);
  EXPECT_GT(shares.front(), 0);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_EQ(shares.back(), 1);
  LightOptions rest = options;
  rest.keep = {};
  for (const LightState& state : kept) {
    rest.from = &state;
    EXPECT_EQ(light(sampled(rest)).irradiance, whole.irradiance);
  }
  rest.from = nullptr;
  std::vector<LightState> shards;
  for (int k = 0; k < 3; ++k) {
    rest.shard = {k, 3};
    shards.push_back(sampled(rest));
  }
  ASSERT_GT(layout.texels.size(), 2 * kShardBlock);
  EXPECT_NE(light(shards[0]).irradiance, whole.irradiance);
  const TexelLight all = light(joined(shards));
  EXPECT_EQ(all.irradiance, whole.irradiance);
  EXPECT_EQ(all.dark, whole.dark);
  shards[1].dark[0] ^= 1;
  EXPECT_THROW(joined(shards), Error);
}

Lightmap baked_by_paths(const Traced& traced, Layout layout) {
  TexelLight light = path_light(traced, layout, 4, 8);
  std::vector<BakedLayer> layers;
  layers.push_back({"light", std::move(light)});
  return make_lightmap(traced.bvh, std::move(layout), std::move(layers), {}, nullptr);
}

TEST(Lightmap, IsDarkInsideThingsAndFilledBeyondCharts) {
  scene::Scene scene;
  const int white = test::add_material(&scene, {0.5f, 0.5f, 0.5f});
  test::add_quad(&scene, {0, 0, 0}, {0, 0, 3}, {3, 0, 0}, white);
  test::add_instance(&scene, test::box_mesh({1, -1, 1}, {2, 1, 2}, white, false));
  test::add_point_light(&scene, {0.2f, 2, 1.5f}, {1, 1, 1});
  const Traced traced(scene);
  const Layout layout = make_layout(scene, density(32));
  const Lightmap map = baked_by_paths(traced, layout);
  int64_t dark = 0;
  for (size_t i = 0; i < layout.texels.size(); ++i) {
    const Vec3& p = layout.texels.position[i];
    const uint32_t pixel = layout.texels.pixel[i];
    const bool within =
        std::abs(p.y) < 1e-4f && p.x > 1.3f && p.x < 1.7f && p.z > 1.3f && p.z < 1.7f;
    if (!within) continue;
    ++dark;
    EXPECT_EQ(map.mask[pixel], static_cast<uint8_t>(Texel::Dark));
    EXPECT_EQ(map.layers[0].irradiance[3 * pixel], 0);
  }
  EXPECT_GT(dark, 100);
  std::vector<uint8_t> of_chart(map.pixels());
  for (const uint32_t pixel : layout.texels.pixel) of_chart[pixel] = 1;
  for (int y = 1; y + 1 < map.height; ++y) {
    for (int x = 1; x + 1 < map.width; ++x) {
      const auto at =
          static_cast<size_t>(y) * static_cast<size_t>(map.width) + static_cast<size_t>(x);
      if (of_chart[at] != 0) continue;
      if (of_chart[at - 1] != 0 || of_chart[at + 1] != 0) {
        EXPECT_EQ(map.mask[at], static_cast<uint8_t>(Texel::Filled));
      }
    }
  }
}

TEST(Lightmap, JoinsSeamsOfASphere) {
  scene::Scene scene;
  const int white = test::add_material(&scene, {0.5f, 0.5f, 0.5f});
  test::add_instance(&scene, test::inward_sphere_mesh(1, 3, white));
  test::add_point_light(&scene, {0.3f, 0.4f, 0}, {1, 1, 1});
  const Traced traced(scene);
  const Layout layout = make_layout(scene, density(12));
  const TexelLight light = path_light(traced, layout, 4, 4);
  const std::vector<uint8_t> mask = make_mask(traced.bvh, layout.atlas, layout.texels, light);
  std::vector<float> picture = paint(layout.atlas, layout.texels, light.irradiance, mask);
  const std::vector<SeamPlace> seams = find_seams(layout.atlas, mask);
  ASSERT_FALSE(seams.empty());
  const double before = seam_difference(seams, picture, 0.99);
  join_seams(seams, mask, &picture);
  EXPECT_LT(seam_difference(seams, picture, 0.99), 0.3 * before);
  EXPECT_LT(seam_difference(seams, picture, 0.99), 0.01);
}

TEST(Lightmap, OfLightGroupsAddsUp) {
  const scene::Scene scene = test::furnished_room();
  const Traced traced(scene);
  const Layout layout = make_layout(scene, density(4));
  const TexelLight all = path_light(traced, layout, 8, 8);
  std::vector<double> sum(layout.texels.size());
  for (int group = 0; group < 2; ++group) {
    std::vector<int> trees;
    const scene::Scene one = with_light_of(scene, group, &trees);
    ASSERT_EQ(one.instances.size(), scene.instances.size());
    const TexelLight light = path_light(Traced(one), layout, 8, 8);
    for (size_t i = 0; i < sum.size(); ++i) sum[i] += double{luminance(light.irradiance[i])};
  }
  double a = 0, b = 0;
  for (size_t i = 0; i < sum.size(); ++i) {
    a += sum[i];
    b += double{luminance(all.irradiance[i])};
  }
  EXPECT_NEAR(a / b, 1, 0.02);
}

TEST(Lightmap, LayersOfOneNameAreToldApart) {
  const scene::Scene scene = test::furnished_room();
  const Traced traced(scene);
  const Layout layout = make_layout(scene, density(2));
  const TexelLight light = path_light(traced, layout, 2, 1);
  const Lightmap map = make_lightmap(
      traced.bvh, layout, {{"lamp.1", light}, {"lamp_1", light}, {"lamp.1", light}}, {}, nullptr);
  const test::TempDir folder;
  write_lightmap_exr(folder / "map.exr", map);
  write_lightmap_json(folder / "map.json", map, "map.exr");
  const std::string picture = read_file(folder / "map.exr");
  const auto record = nlohmann::json::parse(read_file(folder / "map.json"))["layers"];
  const std::array<std::string, 3> names{"lamp.1", "lamp_1", "lamp.1_2"};
  const std::array<std::string, 3> channels{"lamp_1.R", "lamp_1_2.R", "lamp_1_2_2.R"};
  ASSERT_EQ(map.layers.size(), 3u);
  for (size_t l = 0; l < 3; ++l) {
    EXPECT_EQ(map.layers[l].name, names[l]);
    EXPECT_EQ(record[l]["name"], names[l]);
    EXPECT_EQ(record[l]["channels"], channels[l]);
    EXPECT_NE(picture.find('\0' + channels[l]), std::string::npos);
  }
}

TEST(Lightmap, FilesHoldWhatWasBaked) {
  const scene::Scene scene = test::furnished_room();
  const Traced traced(scene);
  const Lightmap map = baked_by_paths(traced, make_layout(scene, density(4)));
  const test::TempDir folder;
  write_lightmap_exr(folder.path() / "map.exr", map);
  const image::Image read = image::read_exr(folder.path() / "map.exr");
  ASSERT_EQ(read.width, map.width);
  for (size_t i = 0; i < read.pixels.size(); ++i)
    ASSERT_NEAR(read.pixels[i], map.layers[0].irradiance[i],
                1e-3f * map.layers[0].irradiance[i] + 1e-6f);
  write_lightmap_glb(folder.path() / "map.glb", map);
  write_unlit_glb(folder.path() / "unlit.glb", map);
  const scene::Scene again = scene::load_scene(folder.path() / "unlit.glb");
  ASSERT_EQ(again.meshes.size(), map.scene.meshes.size());
  EXPECT_EQ(again.triangle_count(), scene.triangle_count());
  EXPECT_EQ(again.textures.at(0)->width(), map.width);
  EXPECT_EQ(scene::load_scene(folder.path() / "map.glb").light_groups.size(), 2u);
}

}  // namespace
}  // namespace lte::bake
