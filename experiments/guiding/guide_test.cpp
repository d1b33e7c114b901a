#include "experiments/guiding/guide.h"

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "experiments/guiding/guide_field.h"
#include "lte/base/check.h"
#include "lte/base/random.h"
#include "lte/pathtrace/incident/hemisphere_bins.h"
#include "lte/pathtrace/incident/incident.h"
#include "lte/scene/sampler.h"
#include "tests/support/scenes.h"

namespace lte::experiments {

using namespace pathtrace;

namespace {

constexpr int kBins = 8;
const Vec3 kNormal = normalize({0.3f, 1, -0.2f});

/// A map with a bright corner, a dark half and an empty cell or two.
std::vector<Rgb> some_map() {
  std::vector<Rgb> map(kBins * kBins);
  for (size_t i = 0; i < map.size(); ++i) {
    const float value = i % 7 == 0 ? 0 : i < 20 ? 0.2f : 1.0f + static_cast<float>(i % 5);
    map[i] = Rgb{1, 0.7f, 0.4f} * value;
  }
  map[kBins + 2] = {80, 80, 80};
  return map;
}

Reflector reflector(float metallic, float roughness) {
  Vec3 tangent, bitangent;
  make_frame(kNormal, &tangent, &bitangent);
  return {{0.8f, 0.5f, 0.3f}, {metallic, roughness}, normalize(kNormal + tangent * 0.9f)};
}

struct Local {
  Vec3 tangent = bin_tangent(kNormal), bitangent = cross(kNormal, tangent);
  Vec3 world(const Vec3& v) const { return tangent * v.x + bitangent * v.y + kNormal * v.z; }
  Vec3 local(const Vec3& v) const { return {dot(v, tangent), dot(v, bitangent), dot(v, kNormal)}; }
};

/// Calls visit(cell of a coarse grid, direction, solid angle) for a fine grid of the hemisphere.
template <typename Visit>
void over_hemisphere(const Visit& visit) {
  constexpr int kFine = 480;
  const Local frame;
  for (int row = 0; row < kFine; ++row) {
    for (int column = 0; column < kFine; ++column) {
      const Vec3 d = bin_direction(
          {(static_cast<float>(column) + 0.5f) / kFine, (static_cast<float>(row) + 0.5f) / kFine});
      const double solid_angle = M_PI / (double{kFine} * kFine * double{d.z});
      visit(static_cast<size_t>(row / 40 * 12 + column / 40), frame.world(d), solid_angle);
    }
  }
}

/// How a guide comes by its map.
enum class Made {
  Here,          ///< around the point itself
  Near,          ///< around one nearby, whose normal is another; the product is made here
  NearAndShared  ///< the same by a table that knows no surface
};

struct Case {
  float metallic, roughness;
  Made made;
};

class Guides : public testing::TestWithParam<Case> {
 protected:
  Reflector surface() const { return reflector(GetParam().metallic, GetParam().roughness); }

  Guide guide(const std::vector<Rgb>& map) const {
    if (GetParam().made == Made::Here) return {{map, kBins, kNormal}, kNormal, surface()};
    const DirectionMap near{map, kBins, normalize({0.1f, 1, 0.3f})};
    EXPECT_LT(dot(near.normal, kNormal), 0.9f);
    if (GetParam().made == Made::Near) return {near, kNormal, surface()};
    return {std::make_shared<const GuideTable>(near, 0.1f), kNormal, surface()};
  }
};

/// χ² of where draws fall against the density, in cells that are not those of the map.
TEST_P(Guides, DrawsFallAsTheDensitySays) {
  const Guide guide = Guides::guide(some_map());
  constexpr int kDraws = 200'000;
  std::vector<double> expected(144), counts(144);
  double total = 0;
  over_hemisphere([&](size_t cell, const Vec3& direction, double solid_angle) {
    const double share = guide.pdf(direction) * solid_angle;
    EXPECT_GT(share, 0) << "no direction is left out";
    expected[cell] += kDraws * share;
    total += share;
  });
  const Local frame;
  Rng rng(5);
  double lost = 0;
  for (int i = 0; i < kDraws; ++i) {
    const float u = rng.uniform(), v = rng.uniform();
    const Guide::Draw draw = guide.draw({u, v});
    if (draw.pdf <= 0) {
      ++lost;
      continue;
    }
    EXPECT_NEAR(draw.pdf, guide.pdf(draw.direction), 1e-4f * draw.pdf);
    const Vec2 place = bin_place(frame.local(draw.direction));
    const auto at = [](float x) { return std::min(static_cast<int>(x * 12), 11); };
    ++counts[static_cast<size_t>(at(place.y) * 12 + at(place.x))];
  }
  EXPECT_NEAR(total, 1 - lost / kDraws, 0.01) << "what is lost goes below the surface";
  double chi2 = 0;
  int freedom = 0;
  for (size_t i = 0; i < expected.size(); ++i) {
    if (expected[i] < 100) continue;
    const double slack = 0.006 * expected[i];  // of the midpoints
    chi2 += (counts[i] - expected[i]) * (counts[i] - expected[i]) / (expected[i] + slack * slack);
    ++freedom;
  }
  EXPECT_GT(freedom, 30);
  EXPECT_LT(chi2, freedom + 5 * std::sqrt(2.0 * freedom));
}

/// The mean of weights is ∫ f cosθ, whatever the map says.
TEST_P(Guides, WeightsIntegrateWhatTheSurfaceReflects) {
  for (const bool dark : {false, true}) {
    const std::vector<Rgb> map = dark ? std::vector<Rgb>(kBins * kBins) : some_map();
    const Guide guide = Guides::guide(map);
    double expected = 0;
    over_hemisphere([&](size_t, const Vec3& direction, double solid_angle) {
      expected += double{guide.reflected(direction).x} * solid_angle;
    });
    constexpr int kDraws = 400'000;
    Rng rng(6);
    double sum = 0, squares = 0;
    for (int i = 0; i < kDraws; ++i) {
      const float u = rng.uniform(), v = rng.uniform();
      const double weight = guide.draw({u, v}).weight.x;
      sum += weight;
      squares += weight * weight;
    }
    const double mean = sum / kDraws, error = std::sqrt((squares / kDraws - mean * mean) / kDraws);
    EXPECT_NEAR(mean, expected, 4 * error + 2e-3 * expected) << dark;
  }
}

INSTANTIATE_TEST_SUITE_P(Surfaces, Guides,
                         testing::Values(Case{0, 1, Made::Here}, Case{1, 0.3f, Made::Here},
                                         Case{0.6f, 0.5f, Made::Here}, Case{0, 1, Made::Near},
                                         Case{1, 0.3f, Made::Near}, Case{0, 1, Made::NearAndShared},
                                         Case{0.6f, 0.5f, Made::NearAndShared}));

/// Radiance over the cells at a point, traced.
std::vector<Rgb> traced_map(const Bvh& bvh, const Lights& lights, const Vec3& position,
                            const Vec3& normal, int bins) {
  IncidentOptions options;
  options.bins = bins;
  options.samples = 256;
  const IncidentRadiance traced =
      estimate_incident(bvh, lights, {&position, 1}, {&normal, 1}, options);
  std::vector<Rgb> map(static_cast<size_t>(traced.cells()));
  for (size_t i = 0; i < traced.indirect.size(); ++i)
    map[i % map.size()] += traced.indirect[i] + traced.direct[i];
  return map;
}

/// Draws by the guide and by the cosine have one mean within their errors, and the guide's variance
/// is less than `share` of the other.
/// @param field  of the guided paths from their second vertex on; null: none
void expect_same_mean(const Bvh& bvh, const Lights& lights, const Vec3& position,
                      const Vec3& normal, const Guide& guide, double share,
                      const GuideField* field = nullptr) {
  IncidentSampler sampler(bvh, lights), by_field(bvh, lights, field);
  constexpr int64_t kPaths = 40'000;
  const auto statistics = [&](const IncidentSamples& samples) {
    double sum = 0, squares = 0;
    for (int64_t i = 0; i < samples.count; ++i) {
      const auto at = static_cast<size_t>(i);
      if (!(samples.pdf[at] > 0)) continue;
      Rgb light{};
      for (int64_t g = 0; g < samples.groups; ++g) {
        const auto of_group = static_cast<size_t>(g * samples.count + i);
        light += samples.direct[of_group] + samples.indirect[of_group];
      }
      const double value =
          luminance(light * guide.reflected(samples.direction[at])) / double{samples.pdf[at]};
      sum += value;
      squares += value * value;
    }
    const double mean = sum / kPaths;
    return std::pair(mean, squares / kPaths - mean * mean);
  };
  Rng one(1), two(2);
  const auto [mean, variance] = statistics(by_field.draw(position, normal, guide, kPaths, one));
  const auto [other, unguided] = statistics(sampler.draw(position, normal, kPaths, two));
  EXPECT_NEAR(mean, other, 4 * std::sqrt((variance + unguided) / kPaths));
  EXPECT_LT(variance, share * unguided);
}

/// In a room lit through a slit: both ways of drawing have one mean, and the guide by the true map
/// has far less variance.
TEST(Guide, OfTheTrueMapHasTheSameMeanAndLessVariance) {
  scene::Scene scene = test::furnished_room();
  const Bvh bvh(scene);
  const Lights lights(scene);
  const Vec3 position = {3.2f, 0, 0.5f}, normal = {0, 1, 0};
  const Reflector floor{{0.8f, 0.8f, 0.8f}, {0, 1}, normal};
  const std::vector<Rgb> map = traced_map(bvh, lights, position, normal, 16);
  expect_same_mean(bvh, lights, position, normal, Guide({map, 16, normal}, normal, floor), 0.4);
}

/// The same by a map that was made 40 cm away, around a normal that leans.
TEST(Guide, OfANeighboursMapHasTheSameMeanAndLessVariance) {
  scene::Scene scene = test::furnished_room();
  const Bvh bvh(scene);
  const Lights lights(scene);
  const Vec3 position = {3.2f, 0, 0.5f}, normal = {0, 1, 0};
  const Vec3 near = {2.9f, 0.02f, 0.8f}, leaning = normalize({0.1f, 1, 0.2f});
  const Reflector floor{{0.8f, 0.8f, 0.8f}, {0, 1}, normal};
  const std::vector<Rgb> map = traced_map(bvh, lights, near, leaning, 16);
  const auto table = std::make_shared<const GuideTable>(DirectionMap{map, 16, leaning}, 0.1f);
  const Guide guide(table, normal, floor);
  expect_same_mean(bvh, lights, position, normal, guide, 0.75);
}

/// A field whose tables say nothing true: bright and dark cells at random.
GuideField arbitrary_field(const Bvh& bvh, float material_share, int hits) {
  SharedPlaces places(0.7f, 0.8f);
  const scene::SurfaceSamples points = scene::sample_surface(bvh.scene(), 500, {});
  for (size_t i = 0; i < points.position.size(); i += 2)
    places.join(points.position[i], points.normal[i]);
  std::vector<std::shared_ptr<const GuideTable>> tables;
  Rng rng(8);
  for (const Vec3& normal : places.normal()) {
    std::vector<Rgb> map(64);
    for (Rgb& cell : map) cell = Rgb{1, 1, 1} * (rng.uniform() < 0.3f ? 5.0f : 0.1f);
    tables.push_back(std::make_shared<const GuideTable>(DirectionMap{map, 8, normal}, 0.2f));
  }
  return {std::move(places), std::move(tables), material_share, hits};
}

/// Whatever the tables say, light that has bounced once and more has one mean; lamps are met by
/// guided paths and by light samples, whose weights must add up to one.
TEST(GuideField, KeepsTheMeanOfPathsWhateverItSays) {
  scene::Scene scene = test::furnished_room();
  scene.materials[1].metallic = 1;
  scene.materials[1].roughness = 0.4f;
  const Bvh bvh(scene);
  const Lights lights(scene);
  const Vec3 position = {3.2f, 0, 0.5f}, normal = {0, 1, 0};
  const Reflector floor{{0.8f, 0.8f, 0.8f}, {0, 1}, normal};
  const std::vector<Rgb> even(16, {1, 1, 1});
  const Guide guide({even, 4, normal}, normal, floor);
  for (const auto& [share, hits] : {std::pair(0.1f, GuideField::kAllHits), std::pair(0.5f, 1),
                                    std::pair(0.5f, GuideField::kAllHits)}) {
    const GuideField field = arbitrary_field(bvh, share, hits);
    expect_same_mean(bvh, lights, position, normal, guide, 20, &field);
  }
}

TEST(GuideField, DrawsFallAsTheDensitySays) {
  const Vec3 leaning = normalize({0.1f, 1, 0.3f});
  SharedPlaces places(1, 0.5f);
  places.join({}, leaning);
  const std::vector<Rgb> map = some_map();
  const GuideField field(
      places, {std::make_shared<const GuideTable>(DirectionMap{map, kBins, leaning}, 0.1f)}, 0.3f);
  EXPECT_EQ(field.at({0.2f, 0, 0}, kNormal), 0);
  EXPECT_EQ(field.at({0.2f, 0, 0}, -kNormal), scene::kNone);
  EXPECT_EQ(field.at({5, 0, 0}, kNormal), scene::kNone);
  // In twelve by twelve cells, and what goes below the surface in one more.
  constexpr int kDraws = 200'000;
  std::vector<double> expected(145), counts(145);
  double above = 0;
  over_hemisphere([&](size_t cell, const Vec3& direction, double solid_angle) {
    const double share = field.pdf(0, dot(direction, kNormal), direction) * solid_angle;
    expected[cell] += kDraws * share;
    above += share;
  });
  expected[144] = kDraws * (1 - above);
  EXPECT_LT(above, 0.999) << "the table's hemisphere is not the surface's";
  const Local frame;
  Rng rng(9);
  for (int i = 0; i < kDraws; ++i) {
    const float u = rng.uniform(), v = rng.uniform();
    const Vec3 local = frame.local(field.direction(0, kNormal, {u, v}));
    if (!(local.z > 0)) {
      ++counts[144];
      continue;
    }
    const Vec2 place = bin_place(local);
    const auto at = [](float x) { return std::min(static_cast<int>(x * 12), 11); };
    ++counts[static_cast<size_t>(at(place.y) * 12 + at(place.x))];
  }
  double chi2 = 0;
  int freedom = 0;
  for (size_t i = 0; i < expected.size(); ++i) {
    if (expected[i] < 100) continue;
    const double slack = 0.006 * expected[i] + (i == 144 ? 0.002 * kDraws : 0);  // of the midpoints
    chi2 += (counts[i] - expected[i]) * (counts[i] - expected[i]) / (expected[i] + slack * slack);
    ++freedom;
  }
  EXPECT_GT(freedom, 30);
  EXPECT_LT(chi2, freedom + 5 * std::sqrt(2.0 * freedom));
}

/// Each point has a place as near as voxels of half a radius allow, which faces its way.
TEST(GuideField, FindsAPlaceNearby) {
  constexpr float kRadius = 0.4f;
  SharedPlaces places(kRadius, 0.9f);
  Rng rng(12);
  const auto point = [&] { return Vec3{rng.uniform(-2, 2), 1, rng.uniform(-2, 2)}; };
  for (int i = 0; i < 2000; ++i) places.join(point(), {0, i % 2 == 0 ? 1.0f : -1.0f, 0});
  const std::vector<Rgb> map(4);
  const auto table = std::make_shared<const GuideTable>(DirectionMap{map, 2, kNormal}, 1.0f);
  const GuideField field(places, {places.position().size(), table}, 0.5f);
  int near = 0;
  const float slack = kRadius / 2 * std::sqrt(3.0f);  // twice half of a voxel's diagonal
  for (int i = 0; i < 2000; ++i) {
    const Vec3 position = point(), normal{0, i % 2 == 0 ? 1.0f : -1.0f, 0};
    const int32_t nearest = places.find(position, normal), found = field.at(position, normal);
    if (nearest < 0) continue;
    ++near;
    ASSERT_GE(found, 0);
    const auto apart = [&](int32_t place) {
      return length(places.position()[static_cast<size_t>(place)] - position);
    };
    EXPECT_LE(apart(found), apart(nearest) + slack);
    EXPECT_EQ(places.normal()[static_cast<size_t>(found)], normal);
  }
  EXPECT_GT(near, 1800);
}

TEST(GuideField, RefusesTablesThatDoNotFit) {
  SharedPlaces places(1, 0.5f);
  places.join({}, kNormal);
  const std::vector<Rgb> map(4);
  const auto table = std::make_shared<const GuideTable>(DirectionMap{map, 2, kNormal}, 1.0f);
  EXPECT_THROW(GuideField(places, {}, 0.5f), Error);
  EXPECT_THROW(GuideField(places, {table}, 0), Error);
  EXPECT_THROW(GuideField(places, {table}, 1), Error);
  EXPECT_THROW(GuideField(places, {table}, 0.5f, 0), Error);
}

TEST(Guide, RefusesWhatItCannotDrawFrom) {
  const Reflector surface = reflector(1, 0.3f);
  std::vector<Rgb> map = some_map();
  const auto make = [&](int bins, const Vec3& normal, const GuideOptions& options) {
    Guide({map, bins, normal}, kNormal, surface, options);
  };
  make(kBins, kNormal, {0.1f, 0});
  EXPECT_THROW(make(6, kNormal, {}), Error);
  EXPECT_THROW(make(kBins, kNormal, {0, 0.5f}), Error);
  EXPECT_THROW(make(kBins, kNormal, {0.1f, 1}), Error);
  EXPECT_THROW(make(kBins, normalize({0.1f, 1, 0.3f}), {0.1f, 0}), Error)
      << "directions below the map's hemisphere would have density 0";
  map[3].y = -1;
  EXPECT_THROW(make(kBins, kNormal, {}), Error);
  map[3].y = NAN;
  EXPECT_THROW(make(kBins, kNormal, {}), Error);
}

}  // namespace
}  // namespace lte::experiments
