// Spherical harmonics: laws of the functions, and of their fits to maps of known radiance.
#include "experiments/directions/spherical_harmonics.h"

#include <cmath>
#include <functional>
#include <numbers>

#include <ATen/ATen.h>
#include <gtest/gtest.h>

#include "lte/base/random.h"
#include "lte/pathtrace/incident/hemisphere_bins.h"

namespace lte::experiments {

namespace {

Vec3 random_direction(Rng* rng) {
  const float z = rng->uniform(-1, 1), azimuth = 2 * kPi * rng->uniform();
  const float across = std::sqrt(1 - z * z);
  return {across * std::cos(azimuth), across * std::sin(azimuth), z};
}

TEST(SphericalHarmonics, AreOrthonormalOverTheSphere) {
  constexpr int kDegree = 6, kCount = 49, kRows = 64, kColumns = 64;
  std::vector<double> gram(kCount * kCount);
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {  // midpoints in azimuth, Fejér's in z
      const double theta = std::numbers::pi * (row + 0.5) / kRows;
      const double azimuth = 2 * std::numbers::pi * (column + 0.5) / kColumns;
      const auto Y =
          spherical_harmonics(kDegree, {static_cast<float>(std::sin(theta) * std::cos(azimuth)),
                                        static_cast<float>(std::sin(theta) * std::sin(azimuth)),
                                        static_cast<float>(std::cos(theta))});
      const double area =
          std::sin(theta) * std::numbers::pi / kRows * 2 * std::numbers::pi / kColumns;
      for (size_t i = 0; i < kCount; ++i) {
        for (size_t j = 0; j < kCount; ++j) gram[i * kCount + j] += area * Y[i] * Y[j];
      }
    }
  }
  for (size_t i = 0; i < kCount; ++i) {
    for (size_t j = 0; j < kCount; ++j)
      EXPECT_NEAR(gram[i * kCount + j], i == j ? 1 : 0, 2e-3) << i << ", " << j;
  }
}

TEST(SphericalHarmonics, AddUpToLegendrePolynomials) {
  Rng rng(3);
  for (int trial = 0; trial < 10; ++trial) {
    const Vec3 a = random_direction(&rng), b = random_direction(&rng);
    const auto Ya = spherical_harmonics(20, a), Yb = spherical_harmonics(20, b);
    for (int l = 0; l <= 20; ++l) {
      double sum = 0;
      for (int m = -l; m <= l; ++m) {
        const auto at = static_cast<size_t>(l * (l + 1) + m);
        sum += Ya[at] * Yb[at];
      }
      const double expected = (2 * l + 1) / (4 * std::numbers::pi) *
                              std::legendre(static_cast<unsigned>(l), double{dot(a, b)});
      EXPECT_NEAR(sum, expected, 1e-4) << "l = " << l;
    }
  }
}

struct Cells {
  std::vector<Vec3> direction;
  std::vector<double> solid_angle;

  explicit Cells(int bins) {
    for (int row = 0; row < bins; ++row) {
      for (int column = 0; column < bins; ++column) {
        const auto centre = [bins](int cell) {
          return (static_cast<float>(cell) + 0.5f) / static_cast<float>(bins);
        };
        direction.push_back(pathtrace::bin_direction({centre(column), centre(row)}));
        solid_angle.push_back(pathtrace::bin_solid_angle(bins, row, column));
      }
    }
  }
  at::Tensor table(const std::function<double(const Vec3&)>& value) const {
    at::Tensor out = at::empty({static_cast<int64_t>(direction.size()), 1}, at::kDouble);
    for (size_t i = 0; i < direction.size(); ++i) out.data_ptr<double>()[i] = value(direction[i]);
    return out;
  }
  double error(int degree, HarmonicFit fit, const at::Tensor& table) const {
    const HarmonicFitter fitter(degree, fit, direction, solid_angle);
    return (fitter.reconstruct(table) - table).square().mean().item<double>();
  }
};

TEST(HarmonicFitter, LeastSquaresHoldWhatTheyCanAndFallWithTheDegree) {
  const Cells cells(16);
  const at::Tensor cubic =
      cells.table([](const Vec3& d) { return 1 + d.x - 2 * d.y * d.z + d.x * d.x * d.z; });
  EXPECT_GT(cells.error(2, HarmonicFit::LeastSquares, cubic), 1e-4);
  EXPECT_LT(cells.error(3, HarmonicFit::LeastSquares, cubic), 1e-10);
  const at::Tensor step = cells.table([](const Vec3& d) { return d.x > 0.2f ? 1 : 0; });
  double before = INFINITY;
  for (const int degree : {0, 1, 2, 4, 8}) {
    const double error = cells.error(degree, HarmonicFit::LeastSquares, step);
    EXPECT_LT(error, before);
    EXPECT_LE(error, cells.error(degree, HarmonicFit::Projected, step) + 1e-12);
    before = error;
  }
}

TEST(HarmonicFitter, ProjectionsOverTheHemisphereRingAndAWindowDampsIt) {
  const Cells cells(16);
  // A small bright spot: what is far from it should stay dark.
  const at::Tensor spot = cells.table([](const Vec3& d) { return d.z > 0.95f ? 10 : 0; });
  const auto lowest = [&](HarmonicFit fit) {
    return HarmonicFitter(8, fit, cells.direction, cells.solid_angle)
        .reconstruct(spot)
        .min()
        .item<double>();
  };
  EXPECT_LT(lowest(HarmonicFit::Projected), -0.3);
  EXPECT_GT(lowest(HarmonicFit::Windowed), 0.5 * lowest(HarmonicFit::Projected));
}

}  // namespace
}  // namespace lte::experiments
