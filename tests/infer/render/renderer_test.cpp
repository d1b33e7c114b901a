// Pictures against closed forms, the G-buffer, and laws that hold for any weights.
#include "infer/renderer/renderer.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/embed/point_light.h"
#include "lte/embed/scene_points.h"
#include "lte/pathtrace/irradiance.h"
#include "lte/pathtrace/placement/auto_camera.h"
#include "lte/pathtrace/render.h"
#include "tests/infer/fixture.h"
#include "tests/support/closed_forms.h"
#include "tests/support/every_light.h"
#include "tests/support/scenes.h"

namespace lte::infer {
namespace {

using test::downward_camera;
using test::kLitFloorRadiance;
using test::lit_floor;

/// One camera ray a pixel, so that a pixel is a point.
RenderSettings settings(Output output, Method method = Method::Gather) {
  RenderSettings out;
  out.output = output;
  out.method = method;
  out.width = 24;
  out.height = 16;
  out.passes = 1;
  out.edge_rays = 0;
  out.denoise = false;
  return out;
}

runtime::Network tiny_network(const test::TinyModel& tiny = {}) {
  const test::TempDir folder;
  test::save_tiny_model(folder / "tiny.safetensors", tiny);
  return runtime::Network(folder / "tiny.safetensors");
}

/// A renderer of `scene` that carries an embedding.
struct Embedded {
  explicit Embedded(scene::Scene made, const test::TinyModel& tiny = {},
                    const EmbedSettings& embed = {})
      : scene(std::move(made)), renderer(scene) {
    renderer.embed(tiny_network(tiny), embed);
  }
  scene::Scene scene;
  Renderer renderer;
};

std::vector<float> closed_form(const pathtrace::GBuffer& hits) {
  std::vector<float> out(hits.mask.size());
  for (size_t i = 0; i < out.size(); ++i) {
    out[i] = static_cast<float>(
        test::polygon_irradiance(test::lit_floor_light(), hits.position[i], hits.normal[i]));
  }
  return out;
}

TEST(Renderer, GeometryOutputsAreTheGBuffer) {
  const scene::Scene scene = test::furnished_room();
  Renderer renderer(scene);
  const scene::Camera camera = pathtrace::auto_camera(renderer.bvh());
  const pathtrace::GBuffer hits = pathtrace::trace_gbuffer(renderer.bvh(), camera, 24, 16);
  const Frame albedo = renderer.render(camera, settings(Output::Albedo));
  const Frame normal = renderer.render(camera, settings(Output::Normal));
  const Frame depth = renderer.render(camera, settings(Output::Depth));
  ASSERT_EQ(depth.color.channels, 1);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 24; ++x) {
      const size_t i = static_cast<size_t>(y) * 24 + static_cast<size_t>(x);
      EXPECT_EQ(albedo.color.rgb(x, y), hits.albedo[i]);
      EXPECT_LT(length(normal.color.rgb(x, y) - hits.normal[i]), 1e-6f);
      EXPECT_EQ(*depth.color.at(x, y), hits.mask[i] ? hits.depth[i] : 0.0f);
    }
  }
}

TEST(Renderer, DirectLightOfAQuadAgreesWithTheClosedForm) {
  const scene::Scene scene = lit_floor();
  Renderer renderer(scene);
  const pathtrace::GBuffer hits =
      pathtrace::trace_gbuffer(renderer.bvh(), downward_camera(), 24, 16);
  const std::vector<float> expected = closed_form(hits);
  RenderSettings wanted = settings(Output::Direct);
  wanted.light_samples = 256;
  const Frame frame = renderer.render(downward_camera(), wanted);
  double sum = 0, wanted_sum = 0;
  for (size_t i = 0; i < 3 * expected.size(); ++i) {
    const float irradiance = expected[i / 3] * kLitFloorRadiance[static_cast<int>(i % 3)];
    EXPECT_NEAR(frame.direct.pixels[i], irradiance, 0.1f * irradiance);  // noise of one pixel
    EXPECT_NEAR(frame.color.pixels[i], 0.5f / kPi * frame.direct.pixels[i], 1e-5f * irradiance);
    sum += frame.direct.pixels[i];
    wanted_sum += irradiance;
  }
  EXPECT_NEAR(sum, wanted_sum, 0.005 * wanted_sum);
}

TEST(Renderer, PrunesScenePointsAsInTrainingUnlessToldOtherwise) {
  scene::Scene scene = lit_floor();
  // Half the surface lies in the dark below the floor.
  const int gray = test::add_material(&scene, {0.5f, 0.5f, 0.5f});
  test::add_instance(&scene, test::box_mesh({-1, -1.5f, -1}, {1, -0.5f, 1}, gray, false));
  for (const bool trained_pruned : {false, true}) {
    test::TinyModel tiny;
    tiny.pruned = trained_pruned;
    for (const std::optional<bool> prune : {std::optional<bool>(), {false}, {true}}) {
      EmbedSettings embed;
      embed.prune = prune;
      const Embedded embedded(scene, tiny, embed);
      const pathtrace::PruneCounts& counts = embedded.renderer.pruned_points();
      if (prune.value_or(trained_pruned)) {
        EXPECT_NEAR(static_cast<double>(counts.pruned) / static_cast<double>(counts.drawn),
                    16.0 / 33, 0.1);
      } else {
        EXPECT_EQ(counts.drawn, 0);
      }
    }
  }
}

/// lte_bench pareto draws its points by the same function.
TEST(Renderer, EveryKindOfLightReachesTheNetwork) {
  for (const test::LitScene& lit : test::scenes_of_every_light()) {
    const pathtrace::Bvh bvh(lit.scene);
    for (const bool pruned : {false, true}) {
      const scene::SurfaceSamples samples =
          embed::sample_scene_points(bvh, 1000, pruned, 0, nullptr);
      const std::vector<double> found = test::strengths(samples, lit.strength.size());
      for (size_t g = 0; g < found.size(); ++g)
        EXPECT_NEAR(found[g], lit.strength[g], std::max(1e-4, lit.tolerance) * lit.strength[g])
            << lit.light << ", pruned " << pruned;
    }
  }
}

TEST(LitSamples, HoldTheIrradianceOfTheClosedForm) {
  const scene::Scene scene = lit_floor();
  const pathtrace::Bvh bvh(scene);
  const pathtrace::Lights lights(scene);
  const scene::SurfaceSamples surface =
      embed::sample_scene_points(bvh, 2000, /*prune=*/false, /*seed=*/1, nullptr);
  EXPECT_TRUE(embed::add_light_estimates(bvh, lights, surface, {0, 0}, 1).light.direct.empty());
  for (const Rgb& light :
       embed::add_light_estimates(bvh, lights, surface, {1, 32}, 1).light.indirect)
    EXPECT_EQ(light, Rgb{}) << "paths of one hit have no indirect light";
  const embed::LitSamples lit = embed::add_light_estimates(bvh, lights, surface, {5, 32}, 1);
  ASSERT_EQ(lit.light.direct.size(), surface.position.size());
  ASSERT_EQ(lit.light.indirect.size(), surface.position.size());
  double traced = 0, expected = 0;
  for (size_t i = 0; i < lit.light.direct.size(); ++i) {
    if (max_component(surface.emission[i]) > 0) continue;
    traced += lit.light.direct[i].x;
    expected += kLitFloorRadiance.x *
                test::polygon_irradiance(test::lit_floor_light(), surface.position[i], {0, 1, 0});
    EXPECT_EQ(lit.light.indirect[i], Rgb{}) << "the light is black";
  }
  EXPECT_NEAR(traced, expected, 0.02 * expected);
}

TEST(LitSamples, HaveBothSidesAndTheirErrors) {
  const scene::Scene scene = test::furnished_room();
  const pathtrace::Bvh bvh(scene);
  const pathtrace::Lights lights(scene);
  const scene::SurfaceSamples surface =
      embed::sample_scene_points(bvh, 500, /*prune=*/false, /*seed=*/1, nullptr);
  const data::PointIrradiance light =
      embed::add_light_estimates(bvh, lights, surface, {5, 32}, 1).light;
  ASSERT_EQ(light.direct_back.size(), surface.position.size());
  ASSERT_EQ(light.indirect_back.size(), surface.position.size());
  ASSERT_EQ(light.error.size(), 2 * surface.position.size());
  // With normals turned over, the back is what the front was, under other random numbers.
  scene::SurfaceSamples turned = surface;
  for (Vec3& normal : turned.normal) normal = -normal;
  const data::PointIrradiance other =
      embed::add_light_estimates(bvh, lights, turned, {5, 32}, 1).light;
  double front = 0, back = 0;
  for (size_t i = 0; i < light.direct.size(); ++i) {
    front += luminance(light.direct[i] - light.direct_back[i]);
    back += luminance(other.direct_back[i]);
  }
  EXPECT_GT(front, 0);
  EXPECT_NEAR(back, front, 0.02 * front);
}

TEST(LitSamples, HoldTheIrradianceOfManyPathsWhereSurfacesReflect) {
  const scene::Scene scene = test::furnished_room();
  const pathtrace::Bvh bvh(scene);
  const pathtrace::Lights lights(scene);
  const scene::SurfaceSamples surface =
      embed::sample_scene_points(bvh, 2000, /*prune=*/false, /*seed=*/1, nullptr);
  const embed::LitSamples lit = embed::add_light_estimates(bvh, lights, surface, {5, 32}, 1);
  pathtrace::IrradianceOptions many;
  many.rays = 512;
  const pathtrace::Irradiance front =
      pathtrace::estimate_irradiance(bvh, lights, surface.position, surface.normal, many);
  double direct = 0, indirect = 0, front_direct = 0, front_indirect = 0;
  for (size_t i = 0; i < lit.light.direct.size(); ++i) {
    if (max_component(surface.emission[i]) > 0) {
      EXPECT_EQ(lit.light.indirect[i], Rgb{}) << "luminaires count as dark";
      continue;
    }
    direct += luminance(lit.light.direct[i]);
    indirect += luminance(lit.light.indirect[i]);
    front_direct += luminance(front.direct_sum(static_cast<int64_t>(i)));
    front_indirect += luminance(front.indirect_sum(static_cast<int64_t>(i)));
  }
  // Walls and furniture are closed: their other side is dark.
  EXPECT_NEAR(direct, front_direct, 0.01 * front_direct);
  EXPECT_NEAR(indirect, front_indirect, 0.02 * front_indirect);
  EXPECT_GT(indirect, 0.1 * direct);
}

/// What the embedding decodes at what pixel centres see.
std::vector<Rgb> decoded(const Renderer& renderer, const scene::Camera& camera) {
  const pathtrace::GBuffer hits = pathtrace::trace_gbuffer(renderer.bvh(), camera, 24, 16);
  return renderer.embedding().decode({hits.position, hits.normal, hits.albedo});
}

double sum_of(const std::vector<Rgb>& values) {
  double sum = 0;
  for (const Rgb& value : values) sum += double{luminance(value)};
  return sum;
}

double difference(const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += double{std::abs(luminance(a[i] - b[i]))};
  return sum;
}

TEST(Renderer, RescaleShowsTheNetworkTheSceneThatItKnows) {
  scene::Scene large = test::furnished_room();
  for (scene::Instance& instance : large.instances)
    instance.to_world = test::scaling({10, 10, 10}) * instance.to_world;
  test::TinyModel tiny;
  tiny.scale = 4 * (1 - 1e-5);  // the small room's own extent, and what the large one is shrunk to
  EmbedSettings embed;
  EXPECT_THROW(Embedded(large, tiny, embed), Error);
  embed.rescale = true;
  Embedded shrunk(large, tiny, embed), small(test::furnished_room(), tiny, embed);
  scene::Camera camera = pathtrace::auto_camera(small.renderer.bvh());
  const std::vector<Rgb> expected = decoded(small.renderer, camera);
  camera.origin *= 10;
  camera.target *= 10;
  EXPECT_GT(sum_of(expected), 0);
  EXPECT_LT(difference(decoded(shrunk.renderer, camera), expected), 0.02 * sum_of(expected));
}

TEST(Renderer, GivesModelsTheLightThatTheyRead) {
  for (const auto input : {nn::LightInput::Emission, nn::LightInput::Traced}) {
    test::TinyModel tiny;
    tiny.light_input = input;
    Embedded room(test::furnished_room(), tiny);
    const scene::Camera camera = pathtrace::auto_camera(room.renderer.bvh());
    const runtime::Network network = tiny_network(tiny);
    const embed::LitSamples lit = embed::add_light_estimates(
        room.renderer.bvh(), room.renderer.lights(),
        embed::sample_scene_points(room.renderer.bvh(), tiny.scene_points, /*prune=*/false,
                                   /*seed=*/0, nullptr),
        network.light_request(), 0);
    EXPECT_EQ(lit.light.direct.empty(), input == nn::LightInput::Emission);
    const pathtrace::GBuffer hits = pathtrace::trace_gbuffer(room.renderer.bvh(), camera, 24, 16);
    const std::vector<Rgb> expected = runtime::SceneEmbedding(network, lit.points())
                                          .decode({hits.position, hits.normal, hits.albedo});
    EXPECT_GT(sum_of(expected), 0) << enum_name(input);
    EXPECT_LT(difference(decoded(room.renderer, camera), expected), 1e-5 * sum_of(expected))
        << enum_name(input) << ": not the light of these estimates";
  }
}

TEST(Renderer, TheNetworksLightIsGathered) {
  Embedded room(test::furnished_room());
  const scene::Camera camera = pathtrace::auto_camera(room.renderer.bvh());
  const RenderSettings gi = settings(Output::Gi, Method::Network);
  EXPECT_THROW(room.renderer.render(camera, gi), Error) << "no cache yet";
  room.renderer.make_cache(Method::Network, {.records = 512});
  const Frame network = room.renderer.render(camera, gi);
  room.renderer.make_cache(Method::Gather, {.records = 512});
  const Frame gathered = room.renderer.render(camera, settings(Output::Gi));
  EXPECT_NE(network.color.pixels, gathered.color.pixels);
  EXPECT_GT(*std::max_element(network.color.pixels.begin(), network.color.pixels.end()), 0);
}

TEST(Renderer, WithoutLightAllLightIsBlackAndNothingIsNeeded) {
  scene::Scene scene;
  const int gray = test::add_material(&scene, {0.5f, 0.5f, 0.5f});
  test::add_instance(&scene, test::box_mesh({0, 0, 0}, {2, 2, 2}, gray, true));
  Renderer renderer(scene);
  EXPECT_FALSE(renderer.has_light());
  const scene::Camera camera = pathtrace::auto_camera(renderer.bvh());
  for (const Method method : {Method::Gather, Method::Network, Method::Path}) {
    for (const Output output : {Output::Full, Output::Gi, Output::Irradiance, Output::Direct}) {
      EXPECT_THAT(renderer.render(camera, settings(output, method)).color.pixels,
                  testing::Each(0.0f));
    }
  }
  EXPECT_EQ(renderer.render(camera, settings(Output::Albedo)).color.rgb(0, 0),
            (Rgb{0.5f, 0.5f, 0.5f}));
}

TEST(Renderer, APictureThatIsStoppedIsNone) {
  const scene::Scene scene = test::furnished_room();
  Renderer renderer(scene);
  RenderSettings stopped = settings(Output::Direct);
  stopped.stop = [] { return true; };
  EXPECT_THROW(renderer.render(pathtrace::auto_camera(renderer.bvh()), stopped), PictureStopped);
}

TEST(Renderer, RefusesWhatItCannotDo) {
  const scene::Scene scene = lit_floor();
  Renderer renderer(scene);
  RenderSettings empty = settings(Output::Albedo);
  empty.width = 0;
  EXPECT_THROW(renderer.render(downward_camera(), empty), Error);
  EXPECT_THROW(renderer.render(downward_camera(), settings(Output::Full)), Error) << "no cache";
  EXPECT_THROW(parse_enum<Output>("--output", "fulll"), Error);
  EXPECT_THROW(parse_enum<Method>("--integrator", "neural"), Error);
}

}  // namespace
}  // namespace lte::infer
