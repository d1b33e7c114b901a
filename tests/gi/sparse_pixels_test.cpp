// Sparse answers against fields that are known at every pixel.
#include "lte/gi/sparse_pixels.h"

#include <algorithm>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "tests/gi/planes.h"

namespace lte::gi {
namespace {

using test::PlanePicture;
using testing::HasSubstr;
using Field = std::function<Rgb(const Query&)>;

/// Answers by a function and counts.
struct Told {
  explicit Told(Field made) : field(std::move(made)) {}
  Answerer answerer() {
    return [this](std::span<const Query> queries) {
      calls.push_back(static_cast<int64_t>(queries.size()));
      std::vector<Rgb> out;
      for (const Query& query : queries) out.push_back(field(query));
      return out;
    };
  }
  int64_t asked() const { return std::accumulate(calls.begin(), calls.end(), int64_t{0}); }
  Field field;
  std::vector<int64_t> calls;
};

SparseOptions plain() {
  SparseOptions out;
  out.contact_radius = -1;
  return out;
}

SparseAnswers answer(const PlanePicture& picture, const SparseOptions& options, Told* told,
                     std::span<const uint8_t> wanted = {}) {
  return answer_sparsely(picture.view(), picture.albedo, wanted, options, told->answerer());
}

int64_t grid_pixels(int width, int height, int step) {
  return ((width - 1 + step - 1) / step + 1) * int64_t{(height - 1 + step - 1) / step + 1};
}

float greatest_error(const PlanePicture& picture, const SparseAnswers& got, const Field& field) {
  float worst = 0;
  for (size_t i = 0; i < picture.mask.size(); ++i) {
    if (!picture.mask[i]) continue;
    const Rgb truth = field({picture.position[i], picture.normal[i], picture.albedo[i]});
    for (int c = 0; c < 3; ++c) worst = std::max(worst, std::abs(truth[c] - got.irradiance[i][c]));
  }
  return worst;
}

TEST(SparsePixels, SmoothIrradianceTakesTheCoarsestGridAlone) {
  const PlanePicture picture(96, 64, {test::tilted_wall()});
  const Field linear = [](const Query& q) { return Rgb{3 + q.position.x, 2, 3 - q.position.y}; };
  for (const int step : {4, 8, 16}) {
    Told told(linear);
    SparseOptions options = plain();
    options.step = step;
    const SparseAnswers got = answer(picture, options, &told);
    EXPECT_EQ(got.answers, grid_pixels(96, 64, step));
    EXPECT_EQ(told.asked(), got.answers);
    EXPECT_EQ(std::count(got.answered.begin(), got.answered.end(), 1), got.answers);
    EXPECT_LT(greatest_error(picture, got, linear), 1e-4f);
  }
}

TEST(SparsePixels, AShadowsEdgeIsFoundAndFollowedToThePixel) {
  const PlanePicture picture(160, 128, {test::tilted_wall()});
  const Field shadow = [](const Query& q) {
    return q.position.x + 0.43f * q.position.y < 0.11f ? Rgb{1, 1, 1} : Rgb{4, 4, 4};
  };
  Told told(shadow);
  const SparseAnswers got = answer(picture, plain(), &told);
  EXPECT_LT(greatest_error(picture, got, shadow), 1e-4f)
      << "a half-plane that cuts a cell holds a corner of it";
  EXPECT_LT(got.answers, 160 * 128 / 5);
  EXPECT_GT(got.answers, 2 * grid_pixels(160, 128, 8));
  // The bound is the caller's: without one the edge is as coarse as the grid.
  SparseOptions never = plain();
  never.tolerance = INFINITY;
  EXPECT_GT(greatest_error(picture, answer(picture, never, &told), shadow), 0.5f);
}

TEST(SparsePixels, DifferencesStayWithinAFewTolerances) {
  const PlanePicture picture(160, 128, {test::tilted_wall()});
  // A spot of light that falls off: smooth, and steep in places.
  const Field spot = [](const Query& q) {
    const Vec3 d = q.position - Vec3{0.3f, 0.2f, -3};
    const float e = 1 / (0.05f + dot(d, d));
    return Rgb{e, e, e};
  };
  int64_t before = 0;
  for (const float tolerance : {0.2f, 0.05f, 0.01f}) {
    Told told(spot);
    SparseOptions options = plain();
    options.tolerance = tolerance;
    const SparseAnswers got = answer(picture, options, &told);
    for (size_t i = 0; i < picture.mask.size(); ++i) {
      const float truth = spot({picture.position[i], picture.normal[i], {}}).x;
      EXPECT_NEAR(got.irradiance[i].x, truth, tolerance * (truth + 1));
    }
    EXPECT_GT(got.answers, before);
    before = got.answers;
  }
}

TEST(SparsePixels, NothingMixesAtEdgesAndSmallThingsAreAnswered) {
  auto planes = test::wall_and_plate(0.2f);
  planes.push_back({{0, 0, -1.2f}, {0, 0, 1}, [](const Vec3& p) {
                      return std::abs(p.x - 0.31f) < 0.03f && std::abs(p.y - 0.2f) < 0.03f;
                    }});
  const PlanePicture picture(96, 96, planes);
  ASSERT_GT(std::count(picture.plane.begin(), picture.plane.end(), 2), 4);
  const Field by_depth = [](const Query& q) {
    const float e = -10 * q.position.z;
    return Rgb{e, e, e};
  };
  Told told(by_depth);
  const SparseAnswers got = answer(picture, plain(), &told);
  EXPECT_LT(greatest_error(picture, got, by_depth), 1e-4f);
  EXPECT_LT(got.answers, 96 * 96 / 4);
  // With answers to both sides of every pixel that is not asked, linear light is exact as well.
  const Field linear = [](const Query& q) {
    const float e = 3 + q.position.x + 20 * q.position.z;
    return Rgb{e, e, e};
  };
  SparseOptions both_sides = plain();
  both_sides.edge_step = 0;
  both_sides.tolerance = INFINITY;
  Told lines(linear);
  EXPECT_LT(greatest_error(picture, answer(picture, both_sides, &lines), linear), 1e-3f);
}

TEST(SparsePixels, EveryPixelNearAContactAndEveryPixelWantedIsAnswered) {
  const PlanePicture picture(64, 64, test::floor_and_wall());
  Told told([](const Query&) { return Rgb{1, 1, 1}; });
  SparseOptions options = plain();
  options.contact_radius = 1;
  std::vector<uint8_t> wanted(64 * 64);
  wanted[5 * 64 + 7] = wanted[63 * 64 + 62] = 1;
  const SparseAnswers got = answer(picture, options, &told, wanted);
  int near = 0;
  for (int y = 1; y + 1 < 64; ++y) {
    const auto at = [&](int row) { return picture.plane[static_cast<size_t>(row * 64)]; };
    if (at(y) == at(y + 1) && at(y) == at(y - 1)) continue;
    for (int x = 0; x < 64; ++x, ++near)
      EXPECT_EQ(got.answered[static_cast<size_t>(y * 64 + x)], 1) << x << " " << y;
  }
  EXPECT_EQ(near, 2 * 64);
  EXPECT_EQ(got.answered[5 * 64 + 7], 1);
  EXPECT_EQ(got.answered[63 * 64 + 62], 1);
}

TEST(SparsePixels, BackgroundIsNeverAskedAndStoppingFillsTheRest) {
  const PlanePicture picture(
      80, 80, {{{0, 0, -2}, {0, 0, 1}, [](const Vec3& p) { return dot(p, p) < 4.6f; }}});
  const Field shadow = [](const Query& q) {
    EXPECT_LT(q.position.z, -1) << "background was asked about";
    return q.position.x < 0.11f ? Rgb{1, 1, 1} : Rgb{4, 4, 4};
  };
  Told whole(shadow), stopped(shadow);
  const SparseAnswers all = answer(picture, plain(), &whole);
  SparseOptions options = plain();
  options.stop = [] { return true; };
  const SparseAnswers few = answer(picture, options, &stopped);
  EXPECT_LT(few.answers, all.answers);
  for (size_t i = 0; i < picture.mask.size(); ++i) {
    EXPECT_EQ(few.irradiance[i].x > 0, picture.mask[i] == 1) << i;
    EXPECT_EQ(all.irradiance[i].x > 0, picture.mask[i] == 1) << i;
  }
}

TEST(SparsePixels, IsTheSameForAnyNumberOfThreads) {
  const PlanePicture picture(97, 83, test::floor_and_wall());
  Told told([](const Query& q) {
    const float e = 2 + std::sin(5 * q.position.x * q.position.z);
    return Rgb{e, 1, e};
  });
  set_num_threads(1);
  const SparseAnswers one = answer(picture, plain(), &told);
  set_num_threads(5);
  const SparseAnswers many = answer(picture, plain(), &told);
  set_num_threads(0);
  EXPECT_EQ(one.irradiance, many.irradiance);
  EXPECT_EQ(one.answered, many.answered);
}

TEST(SparsePixels, BadOptionsAndAnswersAreNamed) {
  const PlanePicture picture(8, 8, {test::tilted_wall()});
  Told told([](const Query&) { return Rgb{}; });
  const auto expect = [&](void (*change)(SparseOptions*), const char* words) {
    SparseOptions options;
    change(&options);
    EXPECT_THAT([&] { answer(picture, options, &told); },
                testing::ThrowsMessage<Error>(HasSubstr(words)));
  };
  expect([](SparseOptions* o) { o->step = 6; }, "power of two up to 64, got 6");
  expect([](SparseOptions* o) { o->step = 128; }, "got 128");
  expect([](SparseOptions* o) { o->edge_step = 3; }, "0 or a power of two, got 3");
  expect([](SparseOptions* o) { o->tolerance = -1; }, "tolerance of 0 or more, got -1");
  expect([](SparseOptions* o) { o->tolerance = NAN; }, "got nan");
  const auto one_short = [](std::span<const Query> queries) {
    return std::vector<Rgb>(queries.size() - 1);
  };
  EXPECT_THAT([&] { answer_sparsely(picture.view(), picture.albedo, {}, {}, one_short); },
              testing::ThrowsMessage<Error>(HasSubstr("expected 4 answers, got 3")));
  EXPECT_EQ(answer_sparsely({}, {}, {}, {}, one_short).answers, 0);
}

}  // namespace
}  // namespace lte::gi
