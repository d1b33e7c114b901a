// Incident radiance by direction: closed forms, and irradiance as the sum over its cells.
#include "lte/pathtrace/incident/incident.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/base/random.h"
#include "lte/pathtrace/incident/hemisphere_bins.h"
#include "lte/pathtrace/irradiance.h"
#include "lte/pathtrace/render.h"
#include "tests/pathtrace/materials/ggx_reference.h"
#include "tests/support/scenes.h"

namespace lte::pathtrace {
namespace {

using test::add_instance;
using test::add_material;
using test::add_metal;
using test::add_quad;
using testing::HasSubstr;
using testing::ThrowsMessage;

IncidentOptions with(int bins, int samples, int max_depth = 5) {
  IncidentOptions options;
  options.bins = bins;
  options.samples = samples;
  options.max_depth = max_depth;
  options.seed = 3;
  return options;
}

IncidentRadiance at(const scene::Scene& scene, const std::vector<Vec3>& positions,
                    const std::vector<Vec3>& normals, const IncidentOptions& options) {
  const Bvh bvh(scene);
  const Lights lights(scene);
  return estimate_incident(bvh, lights, positions, normals, options);
}

Vec3 to_world(const Vec3& local, const Vec3& normal) {
  const Vec3 tangent = bin_tangent(normal);
  return tangent * local.x + cross(normal, tangent) * local.y + normal * local.z;
}

TEST(HemisphereBins, PlacesAndDirectionsAreInverse) {
  Rng rng(1);
  for (int i = 0; i < 10'000; ++i) {
    const Vec2 place{rng.uniform(), rng.uniform()};
    const Vec3 direction = bin_direction(place);
    ASSERT_NEAR(length(direction), 1, 1e-6);
    const Vec2 back = bin_place(direction);
    ASSERT_NEAR(back.x, place.x, 2e-6);
    ASSERT_NEAR(back.y, place.y, 2e-6);
  }
  EXPECT_EQ(bin_direction({0.5f, 0.5f}), (Vec3{0, 0, 1}));
  EXPECT_EQ(bin_place({0, 0, 1}).x, 0.5f);
  EXPECT_NEAR(bin_direction({1, 0.5f}).x, 1, 1e-6);
  EXPECT_NEAR(bin_direction({0.5f, 0}).y, -1, 1e-6);
}

/// Directions of density cosθ / π, drawn without the map under test, fall evenly.
TEST(HemisphereBins, CellsHaveEqualProjectedSolidAngle) {
  constexpr int kBins = 8, kDraws = 400'000;
  Rng rng(2);
  std::vector<int> counts(kBins * kBins);
  for (int i = 0; i < kDraws; ++i) {
    Vec3 d;
    do {
      d = {rng.uniform(-1, 1), rng.uniform(-1, 1), 0};
    } while (!(dot(d, d) < 1));
    d.z = std::sqrt(1 - dot(d, d));
    const Vec2 place = bin_place(d);
    const auto cell = [](float x) { return std::min(kBins - 1, static_cast<int>(x * kBins)); };
    ++counts[static_cast<size_t>(cell(place.y) * kBins + cell(place.x))];
  }
  const double expected = static_cast<double>(kDraws) / (kBins * kBins);
  for (const int count : counts) EXPECT_NEAR(count, expected, 5 * std::sqrt(expected));
}

/// dω = π / cosθ du over the unit square, by quadrature.
TEST(HemisphereBins, SolidAnglesAreTheirIntegrals) {
  for (const int bins : {2, 8, 32}) {
    double sum = 0;
    for (int row = 0; row < bins; ++row)
      for (int column = 0; column < bins; ++column) sum += bin_solid_angle(bins, row, column);
    EXPECT_NEAR(sum, 2 * M_PI, 1e-9) << bins;
  }
  constexpr int kBins = 8, kSteps = 400;
  for (const auto& [row, column] : {std::pair{3, 4}, {4, 6}, {2, 2}, {1, 3}, {5, 3}}) {
    double integral = 0;
    for (int i = 0; i < kSteps * kSteps; ++i) {
      const auto x = static_cast<float>((column + (i % kSteps + 0.5) / kSteps) / kBins);
      const auto y = static_cast<float>((row + (i / kSteps + 0.5) / kSteps) / kBins);
      integral += M_PI / double{bin_direction({x, y}).z} / (kBins * kBins * kSteps * kSteps);
    }
    EXPECT_NEAR(bin_solid_angle(kBins, row, column), integral, 1e-4 * integral);
  }
  EXPECT_THAT([] { bin_solid_angle(3, 0, 0); }, ThrowsMessage<Error>(HasSubstr("even")));
}

TEST(Incident, FurnaceHasOneRadianceInEveryCell) {
  scene::Scene scene;
  const int wall = add_material(&scene, {0.5f, 0.25f, 0}, {2, 2, 2});
  add_instance(&scene, test::box_mesh({-1, -1, -1}, {1, 1, 1}, wall, true));
  const IncidentRadiance r = at(scene, {{0.2f, -1, 0.1f}}, {{0, 1, 0}}, with(4, 64, 4));
  ASSERT_EQ(r.direct.size(), 16u);
  double mean = 0;
  for (size_t i = 0; i < 16; ++i) {
    EXPECT_FLOAT_EQ(r.direct[i].x, 2);
    EXPECT_NEAR(r.indirect[i].x, 2 * (0.5 + 0.25 + 0.125), 0.25);
    EXPECT_EQ(r.indirect[i].z, 0);
    mean += r.indirect[i].x / 16;
  }
  EXPECT_NEAR(mean, 2 * (0.5 + 0.25 + 0.125), 0.03);
}

/// A lamp overhead: cells wholly in its outline have its radiance, those outside nothing.
TEST(Incident, RectangleFillsTheCellsItCovers) {
  scene::Scene scene;
  const int lamp = add_material(&scene, {0, 0, 0}, {7, 5, 3});
  add_quad(&scene, {-0.5f, 2, -0.3f}, {1.5f, 0, 0}, {0, 0, 0.9f}, lamp);
  const Vec3 position{0.1f, 0.5f, 0}, normal = normalize({0.3f, 1, -0.2f});
  constexpr int kBins = 32, kSteps = 24;
  const IncidentRadiance r = at(scene, {position}, {normal}, with(kBins, 16));
  int full = 0, none = 0;
  for (int cell = 0; cell < kBins * kBins; ++cell) {
    int inside = 0;
    for (int i = 0; i <= kSteps; ++i) {
      for (int j = 0; j <= kSteps; ++j) {
        const Vec2 place{
            (static_cast<float>(cell % kBins) + static_cast<float>(i) / kSteps) / kBins,
            (static_cast<float>(cell / kBins) + static_cast<float>(j) / kSteps) / kBins};
        const Vec3 d = to_world(bin_direction(place), normal);
        const Vec3 there = position + d * (1.5f / d.y);
        inside += d.y > 0 && there.x > -0.5f && there.x < 1 && there.z > -0.3f && there.z < 0.6f;
      }
    }
    const auto at_cell = static_cast<size_t>(cell);
    if (inside == (kSteps + 1) * (kSteps + 1)) {
      EXPECT_FLOAT_EQ(r.direct[at_cell].y, 5) << cell;
      ++full;
    } else if (inside == 0) {
      EXPECT_EQ(r.direct[at_cell].y, 0) << cell;
      ++none;
    } else {
      EXPECT_NEAR(r.direct[at_cell].y, 5.0 * inside / ((kSteps + 1) * (kSteps + 1)), 5 * 0.3);
    }
    EXPECT_EQ(r.indirect[at_cell].y, 0);
  }
  EXPECT_GT(full, 60);
  EXPECT_GT(none, 600);
}

/// E = π / bins² Σ L, by group, direct and indirect.
TEST(Incident, SumsToIrradiance) {
  const scene::Scene scene = test::furnished_room();
  const Bvh bvh(scene);
  const Lights lights(scene);
  const std::vector<Vec3> positions{{2, 0, 1.5f}, {0, 1.2f, 2}, {3.2f, 2.5f, 0.7f}};
  const std::vector<Vec3> normals{{0, 1, 0}, {1, 0, 0}, {0, -1, 0}};
  const IncidentRadiance r = estimate_incident(bvh, lights, positions, normals, with(16, 32));
  IrradianceOptions options;
  options.rays = 1 << 14;
  const Irradiance e = estimate_irradiance(bvh, lights, positions, normals, options);
  ASSERT_EQ(r.groups, e.groups);
  for (int64_t i = 0; i < r.points; ++i) {
    for (int64_t g = 0; g < r.groups; ++g) {
      double direct = 0, indirect = 0;
      for (int64_t k = 0; k < r.cells(); ++k) {
        const auto at = static_cast<size_t>((g * r.points + i) * r.cells() + k);
        direct += M_PI / static_cast<double>(r.cells()) * r.direct[at].y;
        indirect += M_PI / static_cast<double>(r.cells()) * r.indirect[at].y;
      }
      const auto slot = static_cast<size_t>(g * r.points + i);
      const double scale = e.total(i).y;
      EXPECT_NEAR(direct, e.direct[slot].y, 0.02 * scale) << i << " " << g;
      EXPECT_NEAR(indirect, e.indirect[slot].y, 0.02 * scale) << i << " " << g;
    }
  }
}

TEST(Incident, DependsNeitherOnThreadsNorOnHowItIsCut) {
  const scene::Scene scene = test::furnished_room();
  const Bvh bvh(scene);
  const Lights lights(scene);
  const std::vector<Vec3> positions{{2, 0, 1.5f}, {0, 1.2f, 2}};
  const std::vector<Vec3> normals{{0, 1, 0}, {1, 0, 0}};
  set_num_threads(1);
  const IncidentRadiance both = estimate_incident(bvh, lights, positions, normals, with(4, 5));
  set_num_threads(3);
  const IncidentRadiance second =
      estimate_incident(bvh, lights, {&positions[1], 1}, {&normals[1], 1}, with(4, 5), 1);
  set_num_threads(0);
  for (int64_t g = 0; g < both.groups; ++g) {
    for (int64_t k = 0; k < 16; ++k) {
      EXPECT_EQ(both.indirect[static_cast<size_t>((g * 2 + 1) * 16 + k)],
                second.indirect[static_cast<size_t>(g * 16 + k)]);
    }
  }
}

TEST(Incident, RefusesWhatItCannotDo) {
  const scene::Scene scene = test::furnished_room();
  const Bvh bvh(scene);
  const Lights lights(scene);
  const Vec3 p{2, 0, 1.5f}, n{0, 1, 0};
  const auto estimate = [&](const IncidentOptions& options, const Vec3& normal) {
    return [&, options, normal] { estimate_incident(bvh, lights, {&p, 1}, {&normal, 1}, options); };
  };
  EXPECT_THAT(estimate(with(7, 1), n), ThrowsMessage<Error>(HasSubstr("bins")));
  EXPECT_THAT(estimate(with(8, 0), n), ThrowsMessage<Error>(HasSubstr("samples")));
  EXPECT_THAT(estimate(with(8, 1, 0), n), ThrowsMessage<Error>(HasSubstr("max_depth")));
  EXPECT_THAT(estimate(with(8, 1), {0, 2, 0}), ThrowsMessage<Error>(HasSubstr("unit")));
}

}  // namespace
}  // namespace lte::pathtrace
