// Gathered light of whole rooms against brute-force paths: where light is bright and uneven in
// small places, a cache of it must not carry it elsewhere.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "lte/gi/gather.h"
#include "lte/pathtrace/gbuffer.h"
#include "lte/pathtrace/irradiance.h"
#include "tests/gi/rooms.h"

namespace lte::gi {
namespace {

constexpr int kWidth = 64, kHeight = 48, kBlock = 8, kReference = 128;
// Tables, whose chance is that of few paths in few places, are several.
constexpr uint64_t kTables = 4;

struct RoomCase {
  const char* name;
  scene::Scene (*make)();
  double ratio, blocks;  ///< how far the mean may be off, and 8 x 8 means, over the mean
};
void PrintTo(const RoomCase& room, std::ostream* out) { *out << room.name; }

/// What a view of a room shows.
struct View {
  explicit View(scene::Scene made) : scene(std::move(made)), bvh(scene), lights(scene) {
    const pathtrace::GBuffer hits =
        pathtrace::trace_gbuffer(bvh, scene.cameras.at(0), kWidth, kHeight);
    for (size_t i = 0; i < hits.mask.size(); ++i) {
      if (!hits.mask[i]) continue;
      positions.push_back(hits.position[i]);
      normals.push_back(hits.normal[i]);
      const auto x = static_cast<int>(i) % kWidth, y = static_cast<int>(i) / kWidth;
      block.push_back(y / kBlock * (kWidth / kBlock) + x / kBlock);
    }
  }
  std::vector<Rgb> reference(uint64_t seed) const {
    pathtrace::IrradianceOptions options;
    options.rays = kReference;
    options.seed = seed;
    options.variance = false;
    const auto light = pathtrace::estimate_irradiance(bvh, lights, positions, normals, options);
    std::vector<Rgb> out;
    for (int64_t i = 0; i < light.points; ++i) out.push_back(light.indirect_sum(i));
    return out;
  }
  std::vector<Rgb> gathered(uint64_t seed) const {
    const CacheRecords records = sample_records(bvh, 4096, seed);
    const RecordLight light = estimate_records(bvh, lights, records, 16, 4, seed);
    const IrradianceCache cache =
        IrradianceCache::of(std::make_shared<const CacheGeometry>(bvh, records), records, light);
    GatherOptions options;
    options.rays = 32;
    options.seed = seed;
    return gather_irradiance(bvh, lights, cache, positions, normals, options).indirect;
  }
  /// Sums over the channels by block of pixels.
  std::vector<double> means(const std::vector<Rgb>& light) const {
    std::vector<double> sum(kWidth * kHeight / kBlock / kBlock), count(sum.size());
    for (size_t i = 0; i < light.size(); ++i) {
      const auto at = static_cast<size_t>(block[i]);
      sum[at] += double{light[i].x} + double{light[i].y} + double{light[i].z};
      count[at] += 1;
    }
    for (size_t i = 0; i < sum.size(); ++i) sum[i] /= std::max(1.0, count[i]);
    return sum;
  }

  scene::Scene scene;
  pathtrace::Bvh bvh;
  pathtrace::Lights lights;
  std::vector<Vec3> positions, normals;
  std::vector<int> block;
};

double sum(const std::vector<double>& values) {
  double out = 0;
  for (const double value : values) out += value;
  return out;
}

class RoomLight : public testing::TestWithParam<RoomCase> {};

/// The noise of two references cancels in the product of the differences to both.
TEST_P(RoomLight, IsThatOfPaths) {
  const View view(GetParam().make());
  const std::vector<double> a = view.means(view.reference(1)), b = view.means(view.reference(2));
  const double reference = (sum(a) + sum(b)) / 2;
  const auto count = static_cast<double>(a.size());
  double ratio = 0, error = 0;
  for (uint64_t seed = 0; seed < kTables; ++seed) {
    const std::vector<double> x = view.means(view.gathered(seed));
    ratio += sum(x) / reference / kTables;
    for (size_t i = 0; i < x.size(); ++i) error += (x[i] - a[i]) * (x[i] - b[i]) / kTables;
  }
  EXPECT_NEAR(ratio, 1, GetParam().ratio);
  EXPECT_LT(std::sqrt(std::max(0.0, error / count)) / (reference / count), GetParam().blocks);
}

INSTANTIATE_TEST_SUITE_P(
    All, RoomLight,
    testing::Values(
        RoomCase{"Panel", [] { return test::panel_room(true); }, 0.03, 0.08},
        RoomCase{"PanelWalledOutwards",
                 [] { return test::panel_room(true, test::Winding::Outwards); }, 0.03, 0.08},
        RoomCase{"PanelOfOneSide", [] { return test::panel_room(false); }, 0.03, 0.03},
        RoomCase{"Dark", test::dark_room, 0.05, 0.12},
        RoomCase{"DoorAjar", [] { return test::door_ajar(); }, 0.08, 0.2},
        RoomCase{"Corridor", [] { return test::corridor(test::Winding::Outwards); }, 0.1, 0.3},
        RoomCase{"Shelves", test::shelves, 0.04, 0.1},
        RoomCase{"OpenFront", test::open_front, 0.04, 0.08},
        RoomCase{"SunThroughBars", test::sun_through_bars, 0.05, 0.12},
        RoomCase{"SmallLamps", test::small_lamps, 0.02, 0.11},
        RoomCase{"Cups", [] { return test::cups(); }, 0.06, 0.4}),
    [](const testing::TestParamInfo<RoomCase>& at) { return std::string(at.param.name); });

/// Of what the cache reads on a floor around plates that lie 2 cm above it, over what paths find.
/// Below the plates, where no ray from the room comes, it is dark.
TEST(RoomLight, BelowPlatesDoesNotDarkenTheFloorBesideThem) {
  scene::Scene scene;
  const int white = test::add_material(&scene, {0.7f, 0.7f, 0.7f}, {}, true);
  const int sky = test::add_material(&scene, {}, {1, 1, 1}, true);
  test::add_room(&scene, {0, 0, 0}, {4, 2, 4}, white);
  test::add_panel(&scene, {0.1f, 1.9f, 0.1f}, 3.8f, 3.8f, sky);
  const std::array<float, 4> corners{0.25f, 1.2f, 2.15f, 3.1f};
  for (const float x : corners)
    for (const float z : corners)
      test::add_quad(&scene, {x, 0.02f, z}, {0, 0, 0.65f}, {0.65f, 0, 0}, white);
  const pathtrace::Bvh bvh(scene);
  const pathtrace::Lights lights(scene);
  const CacheRecords records = sample_records(bvh, 8192, 1);
  const RecordLight light = estimate_records(bvh, lights, records, 64, 4, 1);
  const IrradianceCache cache =
      IrradianceCache::of(std::make_shared<const CacheGeometry>(bvh, records), records, light);
  std::vector<Vec3> positions, normals;
  double found = 0;
  for (int i = 0; i < 400; ++i) {
    const Vec3 place{0.25f + 0.00875f * static_cast<float>(i), 0, 1.05f};  // between two rows
    Rgb here;
    if (!cache.lookup(place, {0, 1, 0}, &here)) continue;
    positions.push_back(place);
    normals.push_back({0, 1, 0});
    found += double{here.x};
  }
  ASSERT_GT(positions.size(), 50);
  pathtrace::IrradianceOptions options;
  options.rays = 512;
  options.max_depth = 4;
  const auto paths = pathtrace::estimate_irradiance(bvh, lights, positions, normals, options);
  double expected = 0;
  for (int64_t i = 0; i < paths.points; ++i) expected += double{paths.total(i).x};
  EXPECT_NEAR(found / expected, 1, 0.03);
}

TEST(RoomLight, OfAFurnaceIsExact) {
  const View view(test::furnace());
  double expected = 0;
  for (int k = 1; k <= 5; ++k) expected += std::pow(0.6, k - 1);
  expected = double{kPi} * (expected - 1);  // depths 2 to 5
  for (const double block : view.means(view.gathered(3)))
    EXPECT_NEAR(block / 3, expected, 0.02 * expected);
}

}  // namespace
}  // namespace lte::gi
