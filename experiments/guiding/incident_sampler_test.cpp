// Incident radiance drawn on the fly: against stored cells, and against what a metal shows.
#include "experiments/guiding/incident_sampler.h"

#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/pathtrace/incident/hemisphere_bins.h"
#include "lte/pathtrace/incident/incident.h"
#include "lte/pathtrace/render.h"
#include "tests/pathtrace/materials/ggx_reference.h"
#include "tests/support/scenes.h"

namespace lte::experiments {

using namespace pathtrace;

namespace {

using test::add_metal;
using test::add_quad;
using testing::HasSubstr;
using testing::ThrowsMessage;

/// Samples drawn on the fly, sorted into cells, against the stored cells; cells are pooled.
TEST(IncidentSampler, SamplesAverageToTheCells) {
  const scene::Scene scene = test::furnished_room();
  const Bvh bvh(scene);
  const Lights lights(scene);
  const Vec3 position{2, 0, 1.5f}, normal{0, 1, 0};
  constexpr int kCells = 4;
  const IncidentRadiance r = estimate_incident(bvh, lights, {&position, 1}, {&normal, 1},
                                               {.bins = kCells, .samples = 4096, .seed = 3});
  IncidentSampler sampler(bvh, lights);
  Rng rng(5);
  std::vector<double> sum(kCells * kCells), squares(kCells * kCells), count(kCells * kCells);
  const Vec3 tangent = bin_tangent(normal), bitangent = cross(normal, tangent);
  for (int call = 0; call < 60; ++call) {
    const IncidentSamples& s = sampler.draw(position, normal, 1000, rng);
    for (size_t i = 0; i < 1000; ++i) {
      ASSERT_NEAR(s.pdf[i], dot(s.direction[i], normal) / kPi, 1e-6);
      const Vec2 place = bin_place({dot(s.direction[i], tangent), dot(s.direction[i], bitangent),
                                    dot(s.direction[i], normal)});
      const size_t cell = static_cast<size_t>(std::min(3.0f, place.y * kCells)) * kCells +
                          static_cast<size_t>(std::min(3.0f, place.x * kCells));
      const double value = s.direct[i].x + s.indirect[i].x;  // of the first group
      sum[cell] += value;
      squares[cell] += value * value;
      ++count[cell];
    }
  }
  for (size_t cell = 0; cell < sum.size(); ++cell) {
    const double mean = sum[cell] / count[cell];
    const double error = std::sqrt((squares[cell] / count[cell] - mean * mean) / count[cell]);
    EXPECT_NEAR(mean, r.direct[cell].x + r.indirect[cell].x, 4.5 * error + 1e-3) << cell;
  }
}

/// What a metal reflects is ∫ L f cosθ dω: samples along its lobe against the renderer.
TEST(IncidentSampler, ReflectorSamplesGiveWhatTheMetalShows) {
  for (const float metallic : {1.0f, 0.3f}) {
    scene::Scene scene = test::furnished_room();
    const int metal = add_metal(&scene, {0.9f, 0.6f, 0.2f}, 0.4f, metallic);
    add_quad(&scene, {1.5f, 0.01f, 2.5f}, {1, 0, 0}, {0, 0, -1}, metal);
    const Bvh bvh(scene);
    const Lights lights(scene);
    const Vec3 position{2, 0.01f, 2}, normal{0, 1, 0}, eye{1.2f, 1.6f, 2.8f};
    const Vec3 outgoing = normalize(eye - position);
    IncidentSampler sampler(bvh, lights);
    Rng rng(6);
    const IncidentSamples& s = sampler.draw(
        position, normal,
        {scene.materials[static_cast<size_t>(metal)].base_color, {metallic, 0.4f}, outgoing},
        40'000, rng);
    double sum = 0, squares = 0;
    for (size_t i = 0; i < 40'000; ++i) {
      if (!(s.pdf[i] > 0)) continue;
      const auto local = [](const Vec3& v) { return test::Double3{v.z, v.x, v.y}; };
      const double reflected =
          metallic * test::ggx_reflection(local(outgoing), local(s.direction[i]), 0.16, 0.9) +
          (1 - metallic) * 0.9 * std::max(0.0f, s.direction[i].y) / M_PI;
      double radiance = 0;
      for (size_t g = 0; g < static_cast<size_t>(s.groups); ++g)
        radiance += s.direct[g * 40'000 + i].x + s.indirect[g * 40'000 + i].x;
      const double value = radiance * reflected / s.pdf[i];
      sum += value;
      squares += value * value;
    }
    const double mean = sum / 40'000, error = std::sqrt((squares / 40'000 - mean * mean) / 40'000);
    scene::Camera camera;
    camera.origin = eye;
    camera.target = position;
    camera.vfov = 0.01f;
    RenderOptions options;
    options.spp = 1 << 14;
    options.max_depth = 6;
    const double seen = render_reference(bvh, lights, camera, 1, 1, options).rgb(0, 0).x;
    EXPECT_NEAR(mean, seen, 4.5 * error + 0.01 * seen) << metallic;
  }
}

TEST(IncidentSampler, RefusesWhatItCannotDo) {
  const scene::Scene scene = test::furnished_room();
  const Bvh bvh(scene);
  const Lights lights(scene);
  const Vec3 p{2, 0, 1.5f}, n{0, 1, 0};
  IncidentSampler sampler(bvh, lights);
  Rng rng(1);
  EXPECT_THAT(
      [&] {
        sampler.draw(p, n, {{1, 1, 1}, {0, 1}, n}, 1, rng);
      },
      ThrowsMessage<Error>(HasSubstr("metallic")));
  EXPECT_THAT(
      [&] {
        sampler.draw(p, n, {{1, 1, 1}, {1, 1}, -n}, 1, rng);
      },
      ThrowsMessage<Error>(HasSubstr("outgoing")));
}

}  // namespace
}  // namespace lte::experiments
