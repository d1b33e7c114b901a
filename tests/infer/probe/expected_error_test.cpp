// What lte_probe expects of its errors: the terms against closed forms, and the sum of them against
// the errors that the shipped models make.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "infer/probe/neural_probe.h"
#include "infer/renderer/renderer.h"
#include "infer/tool/assets.h"
#include "lte/pathtrace/irradiance.h"
#include "lte/pathtrace/lights/lights.h"
#include "lte/scene/load.h"
#include "lte/scene/sampler.h"
#include "tests/support/scenes.h"

namespace lte::infer {
namespace {

TEST(ExpectedError, IsTheRootOfTheSquaredSharesOfItsTerms) {
  const ErrorTerms terms = {
      .draws = 1, .mean = 2, .answer = 3, .near = 4, .change = 5, .cache = 6, .direct = 7};
  EXPECT_DOUBLE_EQ(expected_error(terms, {.near = 0.75, .change = 0.8}), 5);
  EXPECT_DOUBLE_EQ(expected_error(terms, {.mean = 6, .direct = 5.0 / 7}), 13);
  for (const nn::LightInput input :
       {nn::LightInput::Emission, nn::LightInput::Radiosity, nn::LightInput::Traced}) {
    EXPECT_EQ(error_shares(input, /*several=*/false).draws, 0);
    EXPECT_GT(error_shares(input, /*several=*/true).draws, 0);
    EXPECT_GT(expected_error(terms, error_shares(input, true)), 0);
  }
}

PointAnswers answers_of(const std::vector<Rgb>& irradiance, double change, double cache) {
  return {irradiance, std::vector(irradiance.size(), change),
          std::vector(irradiance.size(), cache)};
}

TEST(ExpectedError, ItsTermsAreMeansOverTheDrawsAndTheirSpread) {
  const std::vector<double> nearness = {0.5, 0.25};
  const std::vector<Rgb> direct = {{7, 7, 7}, {0, 0, 0}};
  Draws draws;
  draws.add(answers_of({{1, 1, 1}, {1, 2, 3}}, 2, 5));
  EXPECT_EQ(draws.error_terms(nearness, direct)[1].draws, 0) << "nobody knows of one";
  draws.add(answers_of({{1, 1, 1}, {3, 4, 5}}, 4, 6));
  EXPECT_EQ(draws.mean(), (std::vector<Rgb>{{1, 1, 1}, {2, 3, 4}}));
  const std::vector<ErrorTerms> terms = draws.error_terms(nearness, direct);
  // Of two values x ± d the standard error of the mean is d.
  const double answer = std::sqrt((4 + 9 + 16) / 3.0);
  EXPECT_NEAR(terms[0].draws, 0, 1e-9);
  EXPECT_NEAR(terms[1].draws, 1, 1e-6);
  for (const ErrorTerms& term : terms) {
    EXPECT_NEAR(term.mean, (1 + answer) / 2, 1e-6);
    EXPECT_NEAR(term.change, 3, 1e-9);
    EXPECT_NEAR(term.cache, 5.5, 1e-9);
  }
  EXPECT_NEAR(terms[0].answer, 1, 1e-6);
  EXPECT_NEAR(terms[1].answer, answer, 1e-6);
  EXPECT_NEAR(terms[0].near, 0.5, 1e-6);
  EXPECT_NEAR(terms[1].near, 0.25 * answer, 1e-6);
  EXPECT_NEAR(terms[0].direct, 7, 1e-6);
  EXPECT_EQ(terms[1].direct, 0);
}

/// Under a wide ceiling at height h a ray meets it after h over its cosine: the mean of
/// reach cos / h, weighted by the cosine, is 2/3 of reach over h.
TEST(Nearness, UnderACeilingIsTwoThirdsOfReachOverHeight) {
  scene::Scene scene;
  const int white = test::add_material(&scene, {0.8f, 0.8f, 0.8f}, {});
  test::add_quad(&scene, {-500, 2, -500}, {1000, 0, 0}, {0, 0, 1000}, white);
  const pathtrace::Bvh bvh(scene);
  scene::PointTable points;
  for (int i = 0; i < 2000; ++i) {
    points.position.push_back({0.01f * static_cast<float>(i), 0, 0});
    points.normal.push_back({0, 1, 0});
  }
  const std::vector<double> under = nearness_at(bvh, points, 0.6);
  double mean = 0;
  for (const double value : under) mean += value / static_cast<double>(under.size());
  EXPECT_NEAR(mean, 0.2, 0.002);
  for (const double value : under) EXPECT_NEAR(value, 0.2, 0.04) << "each is stratified";
  for (Vec3& normal : points.normal) normal = {0, -1, 0};
  for (const double value : nearness_at(bvh, points, 0.6)) EXPECT_EQ(value, 0) << "into the open";
}

/// Points of the bundled living room that light reaches.
scene::PointTable lit_points(const Renderer& renderer, int64_t count, std::vector<Rgb>* indirect,
                             std::vector<Rgb>* direct) {
  scene::SamplerOptions sampling;
  sampling.seed = 3;
  const scene::SurfaceSamples samples =
      scene::sample_surface(renderer.bvh().scene(), count, sampling);
  pathtrace::IrradianceOptions tracing;
  tracing.rays = 1024;
  const pathtrace::Irradiance light = pathtrace::estimate_irradiance(
      renderer.bvh(), renderer.lights(), samples.position, samples.normal, tracing);
  scene::PointTable points;
  for (int64_t i = 0; i < count; ++i) {
    const auto at = static_cast<size_t>(i);
    const bool reflects = max_component(samples.albedo[at]) > 0;
    if (!reflects || max_component(light.total(i)) <= 0) continue;
    points.position.push_back(samples.position[at]);
    points.normal.push_back(samples.normal[at]);
    direct->push_back(light.direct_sum(i));
    indirect->push_back(light.total(i) - light.direct_sum(i));
  }
  return points;
}

/// The shares were fitted to the shipped models, on scenes of other kinds: in the living room what
/// is expected has the size of the errors, and tells where they are large.
TEST(ExpectedError, HoldsForTheShippedModelsInARoomOfAnotherKind) {
  const scene::Scene room = scene::load_scene(asset_path("scenes/living_room.glb", "SCENE"), {});
  Renderer renderer(room);
  std::vector<Rgb> truth, direct;
  const scene::PointTable points = lit_points(renderer, 600, &truth, &direct);
  ASSERT_GT(points.size(), 300u);
  const PointAlbedo surface = albedo_at(renderer.bvh(), points);
  for (const char* model : {"lte-base", "lte-hybrid"}) {
    SCOPED_TRACE(model);
    const runtime::Network network(asset_path(concat("models/", model, ".safetensors"), "model"));
    renderer.embed(network, {});
    Draws draws;
    draws.add(ask_at(renderer.embedding(), points, surface.albedo));
    const std::vector<ErrorTerms> terms = draws.error_terms(
        nearness_at(renderer.bvh(), points, latent_spacing(renderer.embedding())), direct);
    std::vector<std::pair<double, double>> pairs;  // expected and true
    for (size_t i = 0; i < points.size(); ++i)
      pairs.emplace_back(
          expected_error(terms[i], error_shares(network.config().light_input, false)),
          rms(draws.mean()[i] - truth[i]));
    std::sort(pairs.begin(), pairs.end());
    const auto within = [&pairs](double times) {
      const auto count = std::count_if(pairs.begin(), pairs.end(), [times](const auto& pair) {
        return pair.second <= times * pair.first;
      });
      return static_cast<double>(count) / static_cast<double>(pairs.size());
    };
    const auto median_error = [&pairs](size_t first, size_t last) {
      std::vector<double> errors;
      for (size_t i = first; i < last; ++i) errors.push_back(pairs[i].second);
      std::nth_element(errors.begin(), errors.begin() + errors.size() / 2, errors.end());
      return errors[errors.size() / 2];
    };
    // lte-base has 0.35 and 0.92, lte-hybrid 0.35 and 0.89.
    EXPECT_LT(within(0.5), 0.65) << "errors are far below what is expected";
    EXPECT_GT(within(2), 0.85);
    const size_t third = pairs.size() / 3;  // medians 3.2 and 2.8 times those of the first third
    EXPECT_GT(median_error(pairs.size() - third, pairs.size()), 2 * median_error(0, third));
  }
}

}  // namespace
}  // namespace lte::infer
