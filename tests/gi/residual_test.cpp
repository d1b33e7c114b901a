// Residual correction on a sheet of points whose true error and noise are known.
#include "lte/gi/residual.h"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/base/random.h"

namespace lte::gi {
namespace {

constexpr int kEdge = 40;

/// A grid of points over [0, 1]² whose answers are all 1.
struct Sheet {
  Sheet() {
    for (int y = 0; y < kEdge; ++y) {
      for (int x = 0; x < kEdge; ++x) {
        position.push_back(
            {(static_cast<float>(x) + 0.5f) / kEdge, (static_cast<float>(y) + 0.5f) / kEdge, 0});
      }
    }
    normal.assign(position.size(), Vec3{0, 0, 1});
    answer.assign(position.size(), Rgb{1, 1, 1});
  }
  ResidualField field() const {
    return {position, normal, std::vector<float>(position.size(), 1.0f / kEdge)};
  }
  std::vector<Vec3> position, normal;
  std::vector<Rgb> answer;
};

using Truth = std::function<float(const Vec3&)>;

std::vector<Rgb> estimates(const Sheet& sheet, const Truth& truth, float deviation, uint64_t seed) {
  Rng rng(seed);
  std::vector<Rgb> out;
  for (const Vec3& p : sheet.position) {
    const auto noisy = [&] {
      // Uniform, of this standard deviation.
      return truth(p) + deviation * std::sqrt(3.0f) * rng.uniform(-1, 1);
    };
    const float r = noisy(), g = noisy(), b = noisy();
    out.push_back({r, g, b});
  }
  return out;
}

double mean_squared_error(const Sheet& sheet, const std::vector<Rgb>& correction,
                          const Truth& truth) {
  double sum = 0;
  for (size_t i = 0; i < correction.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      const double d =
          double{sheet.answer[i][c] + correction[i][c]} - double{truth(sheet.position[i])};
      sum += d * d;
    }
  }
  return sum / (3 * static_cast<double>(correction.size()));
}

float bumpy(const Vec3& p) { return 1 + 0.3f * std::sin(6 * p.x) + 0.2f * std::cos(5 * p.y); }

/// A field after `batches` batches of this noise.
ResidualField after(const Sheet& sheet, const Truth& truth, int batches, float deviation,
                    uint64_t seed = 1) {
  ResidualField field = sheet.field();
  for (int k = 0; k < batches; ++k)
    field.add(estimates(sheet, truth, deviation, seed * 1000 + static_cast<uint64_t>(k)),
              sheet.answer);
  return field;
}

TEST(Residual, NoiselessEstimatesMakeABiasedAnswerExact) {
  const Sheet sheet;
  ResidualField field = after(sheet, bumpy, 2, 0);
  EXPECT_LT(mean_squared_error(sheet, field.correct_points(), bumpy), 1e-12);
  EXPECT_EQ(field.radius_in_spacings(), 0);
}

TEST(Residual, ARightAnswerIsChangedByLessThanTheNoise) {
  const Sheet sheet;
  const Truth one = [](const Vec3&) { return 1.0f; };
  for (const int batches : {1, 2, 8}) {
    ResidualField field = after(sheet, one, batches, 0.5f);
    const double own = 0.25 / batches;
    // Less than what the mean over the widest radius would leave of it.
    EXPECT_LT(mean_squared_error(sheet, field.correct_points(), one), 0.01 * own) << batches;
    EXPECT_GE(field.radius_in_spacings(), 4);
  }
}

TEST(Residual, NeighboursShareWhatTheyKnow) {
  const Sheet sheet;
  ResidualField field = after(sheet, bumpy, 4, 0.5f);
  const double error = mean_squared_error(sheet, field.correct_points(), bumpy);
  const double without = mean_squared_error(sheet, std::vector<Rgb>(sheet.answer.size()), bumpy);
  EXPECT_LT(error, 0.1 * without);
  EXPECT_LT(error, 0.1 * 0.25 / 4) << "a point by itself would keep its own noise";
}

TEST(Residual, ConvergesAsBatchesComeIn) {
  const Sheet sheet;
  // An edge, which no smoothing reproduces.
  const Truth edge = [](const Vec3& p) { return p.x < 0.5f ? 1.0f : 1.8f; };
  double before = 1;
  float radius = 100;
  for (const int batches : {2, 16, 128, 1024}) {
    ResidualField field = after(sheet, edge, batches, 0.5f);
    const double error = mean_squared_error(sheet, field.correct_points(), edge);
    EXPECT_LT(error, 0.5 * before) << batches;
    EXPECT_LT(error, 1.05 * 0.25 / batches) << "no worse than the paths alone";
    EXPECT_LE(field.radius_in_spacings(), radius);
    before = error;
    radius = field.radius_in_spacings();
  }
  EXPECT_LT(before, 3e-4);
}

TEST(Residual, CorrectsBetweenPointsAndNotOnTheOtherSide) {
  const Sheet sheet;
  ResidualField field = after(
      sheet, [](const Vec3&) { return 1.5f; }, 16, 0.2f);
  field.correct_points();
  const std::vector<Vec3> places{{0.4871f, 0.3333f, 0}, {0.4871f, 0.3333f, 0}, {3, 3, 0}};
  const std::vector<Vec3> sides{{0, 0, 1}, {0, 0, -1}, {0, 0, 1}};
  const std::vector<Rgb> correction = field.correct(places, sides);
  EXPECT_NEAR(correction[0].x, 0.5f, 0.05f);
  EXPECT_EQ(correction[1], Rgb{});
  EXPECT_EQ(correction[2], Rgb{});
}

TEST(Residual, ErrorsThatNeighboursDoNotShareAreNotSpread) {
  const Sheet sheet;
  // Known without noise, and of another sign at every second point.
  std::vector<Rgb> rough = sheet.answer;
  for (size_t i = 0; i < rough.size(); ++i)
    rough[i] += Rgb{1, 1, 1} * ((i / kEdge + i) % 2 == 0 ? 0.5f : -0.5f);
  ResidualField field = sheet.field();
  field.add(rough, sheet.answer);
  field.add(rough, sheet.answer);
  field.correct_points();
  const std::vector<Rgb> between =
      field.correct(std::vector<Vec3>{{0.505f, 0.497f, 0}}, std::vector<Vec3>{{0, 0, 1}});
  EXPECT_LT(std::fabs(between[0].x), 0.02f);
}

TEST(Residual, RefusesWhatDoesNotFit) {
  const Sheet sheet;
  ResidualField field = sheet.field();
  EXPECT_EQ(field.correct_points()[5], Rgb{}) << "no batch, no correction";
  EXPECT_THROW(field.add(std::vector<Rgb>(3), sheet.answer), Error);
  std::vector<Rgb> bad = sheet.answer;
  bad[4].z = INFINITY;
  EXPECT_THROW(field.add(bad, sheet.answer), Error);
  EXPECT_EQ(field.batches(), 0);
}

}  // namespace
}  // namespace lte::gi
