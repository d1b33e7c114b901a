// Rays among discs against a search through all discs in double precision, and the walk of the CUDA
// twin, which the CPU can take too.
#include "lte/ops/surfel_rays.h"

#include <array>
#include <cmath>
#include <vector>

#include "lte/ops/surfel_rays_args.h"
#include "tests/ops/fixtures.h"
#include "tests/ops/per_device.h"

namespace lte::ops {
namespace {

using Column = SurfelColumn;

/// Discs at random in the unit cube, of which every third shows its back too.
at::Tensor soup(int64_t M, double radius, double metallic) {
  at::Tensor discs = test::uniform({M, kSurfelColumns}, 1);
  const at::Tensor normal = test::normal({M, 3}, 2, at::kFloat);
  discs.narrow(1, Column::kNormal, 3).copy_(normal / normal.norm(2, 1, true));
  discs.select(1, Column::kRadius).mul_(radius).add_(radius / 2);
  const at::Tensor shows = at::arange(M).remainder(3).eq(0).to(at::kFloat).unsqueeze(1);
  discs.narrow(1, Column::kBack, 3).mul_(shows);
  discs.select(1, Column::kMetallic).mul_(metallic);
  return discs;
}

struct Rays {
  at::Tensor position, directions;

  Rays(int64_t Q, int64_t N)
      : position(test::uniform({Q, 3}, 3) * 1.4 - 0.2),
        directions(test::normal({Q, N, 3}, 4, at::kFloat)) {
    directions.div_(directions.norm(2, 2, true));
    // Some along the axes, whose distances to borders are infinite.
    for (int64_t q = 0; q < std::min<int64_t>(Q, 6); ++q) {
      directions[q][0].zero_();
      directions[q][0][q / 2] = q % 2 == 0 ? 1 : -1;
    }
  }
};

/// What a ray sees of discs without metal, by looking at all of them.
std::vector<double> look_at_all(const at::Tensor& discs, const at::Tensor& from,
                                const at::Tensor& along) {
  struct Met {
    double distance, weight;
    const double* disc;
    bool front;
  };
  const at::Tensor table = discs.to(at::kDouble).contiguous();
  const auto* rows = table.const_data_ptr<double>();
  const at::Tensor ends = at::cat({from, along}).to(at::kDouble);
  const double *p = ends.const_data_ptr<double>(), *d = p + 3;
  const auto luminance = [](const double* c) {
    return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
  };
  std::vector<Met> all;
  double limit = INFINITY;
  for (int64_t i = 0; i < discs.size(0); ++i) {
    const double* disc = rows + i * kSurfelColumns;
    double toward = 0, above = 0, square = 0;
    for (int64_t c = 0; c < 3; ++c) {
      toward += d[c] * disc[Column::kNormal + c];
      above += (disc[c] - p[c]) * disc[Column::kNormal + c];
    }
    const double distance = above / toward, r = disc[Column::kRadius];
    for (int64_t c = 0; c < 3; ++c) {
      const double away = p[c] + distance * d[c] - disc[c];
      square += away * away;
    }
    const bool front = toward < 0;
    if (distance <= 0.1 * r || square >= r * r) continue;
    if (!front && luminance(disc + Column::kBack) <= 0.1 * luminance(disc + Column::kFront))
      continue;
    all.push_back({distance, std::exp(-square / (0.35 * r * r)), disc, front});
    limit = std::min(limit, distance + 0.5 * r);
  }
  std::vector<double> seen(kSeenColumns, 0);
  if (all.empty()) return seen;
  double total = 0, depth = 0;
  std::array<double, 3> normal{};
  for (const Met& met : all) {
    if (met.distance > limit) continue;
    total += met.weight;
    depth += met.weight * met.distance;
    for (size_t c = 0; c < 3; ++c) {
      const double* side = met.disc + (met.front ? Column::kFront : Column::kBack);
      seen[c] += met.weight * side[c];
      normal[c] += met.weight * met.disc[Column::kNormal + c] * (met.front ? 1 : -1);
    }
  }
  double length = 0, facing = 0;
  for (size_t c = 0; c < 3; ++c) {
    seen[c] /= total;
    seen[3 + c] = std::log1p(seen[c]);
    length += normal[c] * normal[c];
    facing -= normal[c] * d[c];
  }
  seen[kSeenHit] = 1;
  seen[kSeenDistance] = std::log(depth / total) + 1.6;
  seen[kSeenCosine] = facing / std::sqrt(length);
  return seen;
}

/// The share of rays whose columns differ by more than rounding: at the edge of a disc a ray meets
/// it or not by its last bit.
double share_apart(const at::Tensor& got, const at::Tensor& expected) {
  const at::Tensor apart = (got.to(at::kDouble) - expected.to(at::kDouble)).abs() >
                           1e-3 * expected.to(at::kDouble).abs().clamp_min(1);
  return apart.any(2).to(at::kDouble).mean().item<double>();
}

class SurfelRays : public test::PerDevice {};
LTE_FOR_EACH_DEVICE(SurfelRays);

TEST_P(SurfelRays, SeeWhatASearchThroughAllDiscsFinds) {
  const Rays rays(60, 8);
  for (const int64_t M : {1, 15, 400}) {
    const at::Tensor discs = soup(M, M > 100 ? 0.09 : 0.3, 0);
    const SurfelGrid grid = make_surfel_grid(put(discs));
    const at::Tensor seen = see_surfels(put(rays.position), put(rays.directions), grid).cpu();
    at::Tensor expected = at::zeros({60, 8, kSeenColumns}, at::kDouble);
    for (int64_t q = 0; q < 60; ++q)
      for (int64_t n = 0; n < 8; ++n)
        expected[q][n].copy_(
            at::tensor(look_at_all(discs, rays.position[q], rays.directions[q][n]), at::kDouble));
    EXPECT_LT(share_apart(seen, expected), 0.005) << M << " discs";
    if (M == 400) {
      EXPECT_GT(seen.select(2, kSeenHit).mean().item<double>(), 0.3);
      EXPECT_LT(seen.select(2, kSeenHit).mean().item<double>(), 0.99);
    }
  }
}

TEST_P(SurfelRays, ANearDiscIsSeenBeforeMoreThanCount) {
  at::Tensor discs = at::zeros({41, kSurfelColumns});
  discs.narrow(1, Column::kPosition, 3).copy_(at::tensor({0.5f, 0.5f, 2.0f}));
  discs.select(1, Column::kNormal + 2).fill_(-1);
  discs.select(1, Column::kRadius).fill_(1);
  discs.narrow(1, Column::kFront, 3).fill_(5);
  // The nearest is the last of its cell.
  discs[40][2] = 1;
  discs[40][Column::kRadius] = 0.4f;
  discs[40].narrow(0, Column::kFront, 3).fill_(2);
  const at::Tensor seen =
      see_surfels(put(at::tensor({0.5f, 0.5f, 0.0f}).view({1, 3})),
                  put(at::tensor({0.0f, 0.0f, 1.0f}).view({1, 1, 3})), make_surfel_grid(put(discs)))
          .cpu();
  EXPECT_FLOAT_EQ(seen[0][0][kSeenRadiance].item<float>(), 2);
}

TEST_P(SurfelRays, OfNoDiscsAndNoRaysAreNothing) {
  const Rays rays(3, 2);
  const SurfelGrid empty = make_surfel_grid(put(at::zeros({0, kSurfelColumns})));
  EXPECT_EQ(see_surfels(put(rays.position), put(rays.directions), empty).abs().sum().item<float>(),
            0);
  const SurfelGrid grid = make_surfel_grid(put(soup(9, 0.3, 0)));
  EXPECT_EQ(see_surfels(put(at::zeros({0, 3})), put(at::zeros({0, 2, 3})), grid).sizes(),
            (at::IntArrayRef{0, 2, kSeenColumns}));
}

TEST(SurfelRaysOnTheCpu, LanesSeeWhatThePlainWalkOfTheCudaTwinSees) {
  const Rays rays(200, 20);
  // Metal too, whose reflections go on; and discs on top of each other, more to a cell than lanes.
  for (const at::Tensor& discs :
       {soup(500, 0.05, 1),
        soup(300, 0.02, 0.5).mul_(at::cat({at::full({3}, 0.2f), at::ones({18})}))}) {
    const SurfelGrid grid = make_surfel_grid(discs);
    const at::Tensor seen = see_surfels(rays.position, rays.directions, grid);
    at::Tensor plain = at::empty_like(seen);
    const SurfelView view = view_of(grid);
    for (int64_t i = 0; i < 200 * 20; ++i)
      see(view, PlainCells(),
          {triple_at(rays.position.const_data_ptr<float>() + i / 20 * 3),
           triple_at(rays.directions.const_data_ptr<float>() + 3 * i)},
          plain.data_ptr<float>() + i * kSeenColumns);
    EXPECT_LT(share_apart(seen, plain), 0.005);
    EXPECT_GT(seen.select(2, kSeenMetal).max().item<float>(), 0.3);
  }
}

TEST(SurfelRaysOnTheCpu, AreTheSameForAnyNumberOfThreads) {
  const Rays rays(200, 20);
  const SurfelGrid grid = make_surfel_grid(soup(500, 0.05, 1));
  const auto seen = [&] { return see_surfels(rays.position, rays.directions, grid); };
  EXPECT_TRUE(at::equal(seen(), test::with_threads(3, seen)));
}

TEST(SurfelRaysOnTheCpu, RefuseWhatDoesNotFit) {
  const Rays rays(3, 2);
  const at::Tensor discs = soup(9, 0.3, 0);
  SurfelGrid grid = make_surfel_grid(discs);
  EXPECT_TRUE(test::throws_saying([&] { make_surfel_grid(discs.narrow(1, 0, 20)); },
                                  "discs must be [9, 21]"));
  EXPECT_TRUE(test::throws_saying(
      [&] { see_surfels(rays.position.narrow(0, 0, 2), rays.directions, grid); },
      "position must be [3, 3]"));
  EXPECT_TRUE(test::throws_saying(
      [&] { see_surfels(rays.position, rays.directions.to(at::kDouble), grid); },
      "directions must be [3, 2, 3]"));
  grid.first = grid.first.narrow(0, 1, grid.first.size(0) - 1);
  EXPECT_TRUE(test::throws_saying([&] { see_surfels(rays.position, rays.directions, grid); },
                                  "first must be"));
}

}  // namespace
}  // namespace lte::ops
