// Upsampling against closed forms and a plain restatement of its rule.
#include "lte/gi/upsample.h"

#include <algorithm>
#include <map>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/base/random.h"
#include "tests/gi/planes.h"

namespace lte::gi {
namespace {

using test::PlanePicture;
using testing::HasSubstr;

/// Values at the pixels of a grid, and nothing between.
struct Known {
  Known(const PlanePicture& picture, const std::vector<Rgb>& field, int step)
      : known(field.size()), values(field.size(), Rgb{-7, -7, -7}) {
    for (int y = 0; y < picture.height; ++y) {
      for (int x = 0; x < picture.width; ++x) {
        const bool on =
            (x % step == 0 || x == picture.width - 1) && (y % step == 0 || y == picture.height - 1);
        const auto i = static_cast<size_t>(y * picture.width + x);
        if (!on || !picture.mask[i]) continue;
        known[i] = 1;
        values[i] = field[i];
      }
    }
  }
  std::vector<uint8_t> known;
  std::vector<Rgb> values;
};

TEST(Upsample, LinearIrradianceOverATiltedPlaneIsExactForAnySize) {
  const auto linear = [](const Vec3& p) {
    return Rgb{2 + p.x, 3 - 0.7f * p.y + 0.2f * p.x, 1};  // the last channel is constant
  };
  for (const auto& [width, height] :
       {std::pair(64, 48), {61, 47}, {1, 1}, {1, 30}, {33, 1}, {8, 8}, {9, 17}}) {
    const PlanePicture picture(width, height, {test::tilted_wall()});
    const std::vector<Rgb> truth = picture.field(linear);
    for (const int step : {1, 2, 8, 16}) {
      Known given(picture, truth, step);
      const std::vector<uint8_t> before = given.known;
      EXPECT_THAT(upsample(picture.view(), step, given.known, given.values), testing::IsEmpty());
      for (size_t i = 0; i < truth.size(); ++i) {
        if (!picture.mask[i]) continue;  // a picture of one row looks past the wall's horizon
        if (before[i]) {
          EXPECT_EQ(given.values[i], truth[i]) << "what is known keeps every bit";
        }
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(given.values[i][c], truth[i][c], 2e-5) << i;
      }
    }
  }
}

TEST(Upsample, PlanesThatLieBehindOrMeetEachOtherNeverMix) {
  for (const auto& planes : {test::wall_and_plate(0.1f), test::floor_and_wall()}) {
    const PlanePicture picture(64, 48, planes);
    std::vector<Rgb> truth(picture.plane.size());
    for (size_t i = 0; i < truth.size(); ++i)
      truth[i] = picture.plane[i] == 0 ? Rgb{1, 1, 1} : Rgb{5, 5, 5};
    Known given(picture, truth, 8);
    const std::vector<int32_t> holes = upsample(picture.view(), 8, given.known, given.values);
    EXPECT_LT(holes.size(), truth.size() / 50);
    for (size_t i = 0; i < truth.size(); ++i) {
      if (given.known[i]) {
        EXPECT_FLOAT_EQ(given.values[i].x, truth[i].x) << i;
      }
    }
  }
}

TEST(Upsample, WhatNoKnownPixelStandsForIsReportedAndLeftAlone) {
  // A plate of few pixels between the pixels of the grid, and background to its right.
  const PlanePicture picture(40, 32,
                             {{{0, 0, -2}, {0, 0, 1}, [](const Vec3& p) { return p.x < 0.5f; }},
                              {{0, 0, -1.5f}, {0, 0, 1}, [](const Vec3& p) {
                                 return std::abs(p.x + 0.2f) < 0.1f && std::abs(p.y - 0.2f) < 0.1f;
                               }}});
  const std::vector<Rgb> truth(picture.plane.size(), Rgb{1, 2, 3});
  Known given(picture, truth, 16);
  for (size_t i = 0; i < truth.size(); ++i) {
    if (picture.plane[i] == 1) given.known[i] = 0;
  }
  std::vector<int32_t> expected;
  for (size_t i = 0; i < truth.size(); ++i) {
    if (picture.plane[i] == 1) expected.push_back(static_cast<int32_t>(i));
  }
  ASSERT_GT(expected.size(), 4u);
  EXPECT_EQ(upsample(picture.view(), 16, given.known, given.values), expected);
  for (size_t i = 0; i < truth.size(); ++i) {
    if (picture.plane[i] == -1) {
      EXPECT_EQ(given.values[i], (Rgb{-7, -7, -7}));
    }
    EXPECT_EQ(given.known[i] != 0, picture.plane[i] == 0) << i;
  }
}

/// The rule once more, pixel by pixel and from the definition: a pixel asks the corners of the cell
/// in whose middle, or on whose edge, it lies, and these ask theirs.
class Restated {
 public:
  Restated(const PlanePicture& picture, const Known& given, int step)
      : picture_(picture), given_(given), step_(step) {}

  std::optional<Rgb> value(int x, int y) {
    const int i = y * picture_.width + x;
    if (!picture_.mask[static_cast<size_t>(i)]) return std::nullopt;
    if (given_.known[static_cast<size_t>(i)]) return given_.values[static_cast<size_t>(i)];
    if (const auto found = made_.find(i); found != made_.end()) return found->second;
    int cell = step_;  // of which the pixel is no corner, but of half of it
    while (cell > 1 && !(on(x, cell / 2, picture_.width) && on(y, cell / 2, picture_.height)))
      cell /= 2;
    std::optional<Rgb> out;
    if (cell > 1 && !(on(x, cell, picture_.width) && on(y, cell, picture_.height)))
      out = between(x, y, cell);
    made_[i] = out;
    return out;
  }

  /// 1 or 0, and between them by distance from the plane and angle.
  double likeness(int x, int y, int sx, int sy) const {
    const auto a = static_cast<size_t>(y * picture_.width + x),
               b = static_cast<size_t>(sy * picture_.width + sx);
    const Vec3 d = picture_.position[b] - picture_.position[a];
    const double far =
        std::max(std::abs(dot(d, picture_.normal[a])), std::abs(dot(d, picture_.normal[b])));
    const double pixel = picture_.pixel_size * std::min(picture_.depth[a], picture_.depth[b]);
    const double cosine = dot(picture_.normal[a], picture_.normal[b]);
    if (far >= pixel || cosine <= 0.9) return 0;
    return std::min(1.0, 1.25 * (1 - far / pixel)) * std::min(1.0, 12.5 * (cosine - 0.9));
  }

 private:
  static bool on(int at, int cell, int length) { return at % cell == 0 || at == length - 1; }

  std::optional<Rgb> between(int x, int y, int cell) {
    const int x0 = on(x, cell, picture_.width) ? x : x / cell * cell,
              y0 = on(y, cell, picture_.height) ? y : y / cell * cell;
    const int x1 = x0 == x ? x : std::min(x0 + cell, picture_.width - 1),
              y1 = y0 == y ? y : std::min(y0 + cell, picture_.height - 1);
    struct Corner {
      Rgb value;
      double weight;
    };
    std::map<std::pair<int, int>, Corner> corners;
    for (const int cx : {x0, x1}) {
      for (const int cy : {y0, y1}) {
        const std::optional<Rgb> there = value(cx, cy);
        const double like = there ? likeness(x, y, cx, cy) : 0;
        if (like <= 0) continue;
        const double u = x0 == x1   ? 1.0
                         : cx == x0 ? double(x1 - x) / (x1 - x0)
                                    : double(x - x0) / (x1 - x0);
        const double v = y0 == y1   ? 1.0
                         : cy == y0 ? double(y1 - y) / (y1 - y0)
                                    : double(y - y0) / (y1 - y0);
        corners[{cx, cy}] = {
            *there, like * u * v / picture_.depth[static_cast<size_t>(cy * picture_.width + cx)]};
      }
    }
    if (corners.empty()) return std::nullopt;
    const bool four = x0 != x1 && y0 != y1;
    if (four && corners.size() == 3) {  // two of them are ends of a diagonal
      const bool falling = corners.count({x0, y0}) > 0 && corners.count({x1, y1}) > 0;
      for (auto at = corners.begin(); at != corners.end();) {
        const bool on_falling = (at->first.first == x0) == (at->first.second == y0);
        at = on_falling == falling ? std::next(at) : corners.erase(at);
      }
    }
    double weight = 0, sum[3] = {};
    for (const auto& [place, corner] : corners) {
      weight += corner.weight;
      for (int c = 0; c < 3; ++c) sum[c] += corner.weight * corner.value[c];
    }
    return Rgb{float(sum[0] / weight), float(sum[1] / weight), float(sum[2] / weight)};
  }

  const PlanePicture& picture_;
  const Known& given_;
  int step_;
  std::map<int, std::optional<Rgb>> made_;
};

TEST(Upsample, AgreesWithItsRuleRestatedForScatteredPixels) {
  std::vector<test::Plane> planes = test::wall_and_plate(0.05f);
  planes.push_back({{0, -0.6f, 0}, {0, 1, 0}});
  const PlanePicture picture(45, 37, planes);
  Rng rng(3);
  for (const int step : {4, 16}) {
    std::vector<Rgb> field(picture.plane.size());
    for (Rgb& value : field) value = {rng.uniform(), rng.uniform(), rng.uniform()};
    Known given(picture, field, 64);
    for (size_t i = 0; i < field.size(); ++i) {
      given.known[i] = picture.mask[i] && rng.uniform() < 0.1f ? 1 : 0;
      given.values[i] = field[i];
    }
    Restated restated(picture, given, step);
    Known filled = given;
    const std::vector<int32_t> holes = upsample(picture.view(), step, filled.known, filled.values);
    size_t by_grids = 0, by_nearest = 0;
    for (int y = 0; y < picture.height; ++y) {
      for (int x = 0; x < picture.width; ++x) {
        const auto i = static_cast<size_t>(y * picture.width + x);
        if (given.known[i] || !picture.mask[i]) continue;
        if (const std::optional<Rgb> expected = restated.value(x, y)) {
          ++by_grids;
          for (int c = 0; c < 3; ++c) EXPECT_NEAR(filled.values[i][c], (*expected)[c], 1e-4);
          continue;
        }
        ++by_nearest;  // the nearest ring with a pixel of this surface that has a value
        double weight = 0, sum = 0;
        for (int ring = 1; ring <= step && weight == 0; ++ring) {
          for (int sy = y - ring; sy <= y + ring; ++sy) {
            for (int sx = x - ring; sx <= x + ring; ++sx) {
              if (std::max(std::abs(sx - x), std::abs(sy - y)) != ring || sx < 0 || sy < 0 ||
                  sx >= picture.width || sy >= picture.height)
                continue;
              const std::optional<Rgb> there = restated.value(sx, sy);
              const double like = there ? restated.likeness(x, y, sx, sy) : 0;
              if (like <= 0) continue;
              weight += like;
              sum += like * there->x;
            }
          }
        }
        const bool hole =
            std::find(holes.begin(), holes.end(), static_cast<int32_t>(i)) != holes.end();
        EXPECT_EQ(hole, weight == 0) << x << " " << y;
        if (weight > 0) {
          EXPECT_NEAR(filled.values[i].x, sum / weight, 1e-4);
        }
      }
    }
    EXPECT_GT(by_grids, 300u);
    EXPECT_GT(by_nearest, 5u);
  }
}

TEST(Upsample, IsTheSameForAnyNumberOfThreads) {
  const PlanePicture picture(97, 83, test::floor_and_wall());
  const std::vector<Rgb> field = picture.field([](const Vec3& p) {
    return Rgb{p.x * p.z, p.y, p.z};
  });
  Known one(picture, field, 8), many = one;
  set_num_threads(1);
  const std::vector<int32_t> holes = upsample(picture.view(), 8, one.known, one.values);
  set_num_threads(5);
  EXPECT_EQ(upsample(picture.view(), 8, many.known, many.values), holes);
  set_num_threads(0);
  EXPECT_EQ(one.values, many.values);
  EXPECT_EQ(one.known, many.known);
}

TEST(Upsample, BadSizesAreNamed) {
  const PlanePicture picture(4, 4, {test::tilted_wall()});
  std::vector<uint8_t> known(16);
  std::vector<Rgb> values(16), few(15);
  EXPECT_THAT([&] { upsample(picture.view(), 3, known, values); },
              testing::ThrowsMessage<Error>(HasSubstr("power of two, got 3")));
  EXPECT_THAT([&] { upsample(picture.view(), 2, known, few); },
              testing::ThrowsMessage<Error>(HasSubstr("16 pixels, got 15")));
}

}  // namespace
}  // namespace lte::gi
