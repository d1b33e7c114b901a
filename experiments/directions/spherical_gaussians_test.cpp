#include "experiments/directions/spherical_gaussians.h"

#include <cmath>

#include <ATen/ATen.h>
#include <gtest/gtest.h>

#include "experiments/directions/nonnegative.h"
#include "lte/base/check.h"
#include "lte/pathtrace/incident/hemisphere_bins.h"

namespace lte::experiments {
namespace {

/// The smallest squared error over all sets of unknowns that are held at 0.
at::Tensor by_trying_all(const at::Tensor& A, const at::Tensor& b) {
  const int64_t n = A.size(1);
  at::Tensor best = at::zeros({n}, at::kDouble);
  double least = b.square().sum().item<double>();
  for (int64_t set = 1; set < int64_t{1} << n; ++set) {
    std::vector<int64_t> free;
    for (int64_t i = 0; i < n; ++i) {
      if ((set >> i & 1) != 0) free.push_back(i);
    }
    const at::Tensor index = at::tensor(free);
    const at::Tensor some = at::linalg_pinv(A.index_select(1, index)).mv(b);
    if (some.min().item<double>() < 0) continue;
    at::Tensor x = at::zeros({n}, at::kDouble);
    x.index_copy_(0, index, some);
    const double error = (A.mv(x) - b).square().sum().item<double>();
    if (error >= least) continue;
    least = error;
    best = x;
  }
  return best;
}

TEST(NonnegativeLeastSquares, AreTheBestOfAllSetsOfUnknowns) {
  at::manual_seed(5);
  const int64_t B = 3, L = 6, T = 20;
  const at::Tensor A = at::randn({B, 9, L}, at::kDouble), b = at::randn({B, 9, T}, at::kDouble);
  const at::Tensor gram = at::matmul(A.transpose(1, 2), A);
  const at::Tensor moments = at::matmul(A.transpose(1, 2), b);
  const at::Tensor x = nonnegative_least_squares(gram, moments);
  const at::Tensor guess = at::rand({B, L, T}, at::kDouble);
  EXPECT_TRUE(at::allclose(x, nonnegative_least_squares(gram, moments, guess), 1e-6, 1e-7))
      << "whatever the guess";
  int64_t held = 0;
  for (int64_t p = 0; p < B; ++p) {
    for (int64_t t = 0; t < T; ++t) {
      const at::Tensor got = x[p].select(1, t), wanted = by_trying_all(A[p], b[p].select(1, t));
      EXPECT_TRUE(at::allclose(got, wanted, 1e-6, 1e-7)) << p << ", " << t;
      held += (got == 0).sum().item<int64_t>();
    }
  }
  EXPECT_GT(held, B * T) << "the bound was met";
}

TEST(NonnegativeLeastSquares, TakeColumnsThatRepeat) {
  const at::Tensor column = at::tensor({1.0, 2.0, 0.5}),
                   A = at::stack({column, column, -column}, 1);
  const at::Tensor x = nonnegative_least_squares(A.t().matmul(A).unsqueeze(0),
                                                 A.t().matmul(3 * column).view({1, 3, 1}));
  EXPECT_NEAR((x[0][0] + x[0][1]).item<double>(), 3, 1e-6);
  EXPECT_EQ(x[0][2].item<double>(), 0);
}

at::Tensor cells(int bins) {
  std::vector<Vec3> out;
  for (int cell = 0; cell < bins * bins; ++cell) {
    const auto centre = [bins](int i) {
      return (static_cast<float>(i) + 0.5f) / static_cast<float>(bins);
    };
    out.push_back(pathtrace::bin_direction({centre(cell % bins), centre(cell / bins)}));
  }
  return direction_table(out);
}

/// [1, cells, 3] of Σ a exp(λ (μ · ω − 1)), term by term.
struct Lobe {
  double axis[3], sharpness, color[3];
};
at::Tensor map_of(const std::vector<Lobe>& lobes, const at::Tensor& directions) {
  at::Tensor out = at::zeros({1, directions.size(0), 3}, at::kDouble);
  for (int64_t i = 0; i < directions.size(0); ++i) {
    const auto d = directions[i];
    for (const Lobe& lobe : lobes) {
      double cosine = 0;
      for (int k = 0; k < 3; ++k) cosine += lobe.axis[k] * d[k].item<double>();
      for (int c = 0; c < 3; ++c)
        out[0][i][c] += lobe.color[c] * std::exp(lobe.sharpness * (cosine - 1));
    }
  }
  return out;
}

/// Root of the mean squared error over that of the map.
double relative_error(const GaussianSums& sums, const at::Tensor& directions,
                      const at::Tensor& maps) {
  return ((sums.values(directions) - maps).norm() / maps.norm()).item<double>();
}

std::vector<Lobe> three_lobes() {
  return {{{0.36, 0.48, 0.8}, 30, {2, 1, 0.5}},
          {{-0.6, 0, 0.8}, 6, {0.2, 0.4, 0.9}},
          {{0.48, -0.8, 0.36}, 90, {5, 5, 0}}};
}

TEST(SphericalGaussians, ASumOfThemIsFoundAgain) {
  const at::Tensor directions = cells(24), maps = map_of(three_lobes(), directions);
  const std::vector<int> counts = {1, 3, 8};
  const std::vector<GaussianSums> found = fit_greedily(counts, directions, maps);
  ASSERT_EQ(found.size(), 3u);
  EXPECT_GT(relative_error(found[0], directions, maps), 0.2) << "one is not enough";
  EXPECT_LT(relative_error(found[1], directions, maps), 0.01);
  EXPECT_LT(relative_error(found[2], directions, maps), 0.01);
  for (const Lobe& lobe : three_lobes()) {
    const at::Tensor axis = at::tensor({lobe.axis[0], lobe.axis[1], lobe.axis[2]});
    const auto [cosine, at] = found[1].axis[0].mv(axis).max(0);
    EXPECT_GT(cosine.item<double>(), 0.9995) << lobe.sharpness;
    const auto i = at.item<int64_t>();
    EXPECT_NEAR(found[1].sharpness[0][i].item<double>(), lobe.sharpness, 0.05 * lobe.sharpness);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(found[1].amplitude[0][i][c].item<double>(), lobe.color[c],
                  0.03 * lobe.color[c] + 0.02);
  }
}

TEST(SphericalGaussians, AConstantIsHeldByAFewWideLobes) {
  const at::Tensor directions = cells(16), maps = at::full({2, 256, 3}, 0.7, at::kDouble);
  const std::vector<int> counts = {4};
  EXPECT_LT(relative_error(fit_greedily(counts, directions, maps)[0], directions, maps), 0.01);
  double before = 1;
  for (const int lobes : {4, 16, 64}) {
    const GaussianSums sums = fit_lattice(lobes, directions, maps);
    const double error = relative_error(sums, directions, maps);
    EXPECT_LT(error, before);
    before = error;
  }
  EXPECT_LT(before, 0.05) << "neighbours overlap";
}

TEST(SphericalGaussians, OfALatticeAreFoundAgain) {
  const at::Tensor directions = cells(32);
  const GaussianSums of = fit_lattice(16, directions, at::ones({1, 1024, 3}, at::kDouble));
  EXPECT_NEAR((of.axis.norm(2, 2) - 1).abs().max().item<double>(), 0, 1e-12);
  EXPECT_GT(of.axis.select(2, 2).min().item<double>(), 0);
  // The mean height of points that are even over a hemisphere is 1/2, and the others 0.
  EXPECT_NEAR(of.axis.select(2, 2).mean().item<double>(), 0.5, 1e-9);
  EXPECT_NEAR(of.axis.select(2, 0).mean().item<double>(), 0, 0.05);
  GaussianSums wanted = of;
  wanted.amplitude = at::zeros_like(of.amplitude);
  wanted.amplitude.select(1, 3).fill_(2);
  wanted.amplitude.select(1, 11).fill_(0.5);
  const GaussianSums got = fit_lattice(16, directions, wanted.values(directions));
  EXPECT_LT((got.amplitude - wanted.amplitude).abs().max().item<double>(), 1e-5);
}

TEST(SphericalGaussians, AreNotNegativeWhereAFreeFitWouldBe) {
  const at::Tensor directions = cells(16);
  // A bright spot with a hard edge: least squares without the bound ring around it.
  const at::Tensor maps = (directions.select(1, 2) > 0.9).to(at::kDouble).view({1, 256, 1});
  const at::Tensor spot = maps.expand({1, 256, 3}).contiguous();
  const GaussianSums lattice = fit_lattice(64, directions, spot);
  const std::vector<int> counts = {4, 16};
  const std::vector<GaussianSums> greedy = fit_greedily(counts, directions, spot);
  for (const GaussianSums& sums : {lattice, greedy[0], greedy[1]}) {
    EXPECT_GE(sums.amplitude.min().item<double>(), 0);
    EXPECT_GE(sums.values(directions).min().item<double>(), 0);
  }
  EXPECT_LE(relative_error(greedy[1], directions, spot),
            relative_error(greedy[0], directions, spot));
  EXPECT_THROW(fit_greedily(std::vector<int>{4, 2}, directions, spot), Error);
  EXPECT_THROW(fit_lattice(0, directions, spot), Error);
}

TEST(SphericalGaussians, DarkMapsStayDark) {
  const at::Tensor directions = cells(8), dark = at::zeros({2, 64, 3}, at::kDouble);
  const std::vector<int> counts = {2};
  EXPECT_EQ(fit_greedily(counts, directions, dark)[0].values(directions).abs().max().item<double>(),
            0);
  EXPECT_EQ(fit_lattice(4, directions, dark).values(directions).abs().max().item<double>(), 0);
}

}  // namespace
}  // namespace lte::experiments
