#include "lte/ops/farthest_point.h"

#include <limits>
#include <vector>

#include <ATen/ATen.h>
#include <gtest/gtest.h>

#include "tests/ops/fixtures.h"
#include "tests/ops/per_device.h"

namespace lte::ops {
namespace {

using test::throws_saying;

/// The definition: after each pick, all distances again.
std::pair<at::Tensor, at::Tensor> brute_force(const at::Tensor& points, int64_t count) {
  const int64_t N = points.size(0);
  const auto* p = points.const_data_ptr<float>();
  std::vector<float> distance(N, std::numeric_limits<float>::infinity());
  std::vector<bool> picked(N);
  at::Tensor index = at::empty({count}, at::kLong), insertion = at::empty({count});
  for (int64_t i = 0; i < count; ++i) {
    int64_t best = -1;
    for (int64_t j = 0; j < N; ++j) {
      if (!picked[j] && (best < 0 || distance[j] > distance[best])) best = j;
    }
    picked[best] = true;
    index[i] = best;
    insertion[i] = distance[best];
    for (int64_t j = 0; j < N; ++j) {
      volatile float squares[3];  // rounded one by one: no fused multiply-add
      for (int a = 0; a < 3; ++a) {
        const float d = p[3 * j + a] - p[3 * best + a];
        squares[a] = d * d;
      }
      const float xy = squares[0] + squares[1];
      distance[j] = std::min(distance[j], xy + squares[2]);
    }
  }
  return {index, insertion};
}

class FarthestPoint : public test::PerDevice {
 protected:
  /// Picks on this device, as tensors on the CPU.
  std::pair<at::Tensor, at::Tensor> sample(const at::Tensor& points, int64_t count) const {
    const auto [index, distance] = farthest_point_sampling(put(points), count);
    EXPECT_EQ(index.device().type(), GetParam());
    return {index.cpu(), distance.cpu()};
  }
};
LTE_FOR_EACH_DEVICE(FarthestPoint);

TEST_P(FarthestPoint, PicksTheEndsThenTheMiddleOfALine) {
  at::Tensor points = at::zeros({5, 3});
  points.select(1, 0).copy_(at::arange(5));
  const auto [index, distance] = sample(points, 5);
  EXPECT_TRUE(at::equal(index, at::tensor({0, 4, 2, 1, 3})));
  EXPECT_TRUE(at::equal(distance,
                        at::tensor({std::numeric_limits<float>::infinity(), 16.f, 4.f, 1.f, 1.f})));
}

TEST_P(FarthestPoint, MatchesBruteForceAtEverySize) {
  for (const int64_t N : {1, 2, 15, 16, 17, 63, 64, 65, 127, 129, 1023, 1024, 1025}) {
    const at::Tensor points = test::uniform({N, 3}, 11);
    for (const int64_t count : {int64_t{1}, (N + 1) / 2, N}) {
      const auto [index, distance] = sample(points, count);
      const auto [expected_index, expected_distance] = brute_force(points, count);
      EXPECT_TRUE(at::equal(index, expected_index)) << count << " of " << N;
      EXPECT_TRUE(at::equal(distance, expected_distance)) << count << " of " << N;
    }
  }
}

TEST_P(FarthestPoint, MatchesBruteForceOnAwkwardPoints) {
  for (const auto& [name, points] : test::awkward_points(700)) {
    const auto [index, distance] = sample(points, 700);
    const auto [expected_index, expected_distance] = brute_force(points, 700);
    EXPECT_TRUE(at::equal(index, expected_index)) << name;
    EXPECT_TRUE(at::equal(distance, expected_distance)) << name;
  }
}

TEST_P(FarthestPoint, RunsAreNestedAndDistancesFall) {
  const at::Tensor points = test::uniform({3000, 3}, 12);
  const auto [index, distance] = sample(points, 1500);
  const auto [half_index, half_distance] = sample(points, 750);
  EXPECT_TRUE(at::equal(index.narrow(0, 0, 750), half_index));
  EXPECT_TRUE(at::equal(distance.narrow(0, 0, 750), half_distance));
  EXPECT_TRUE(distance.diff().narrow(0, 1, 1498).le(0).all().item<bool>());
}

TEST_P(FarthestPoint, PicksEveryPointOnceAndDuplicatesLast) {
  const at::Tensor once = test::uniform({300, 3}, 13);
  const auto [index, distance] = sample(at::cat({once, once, once}), 900);
  EXPECT_TRUE(at::equal(std::get<0>(index.sort()), at::arange(900)));
  EXPECT_TRUE(index.narrow(0, 0, 300).lt(300).all().item<bool>());
  EXPECT_TRUE(at::equal(index.narrow(0, 300, 600), at::arange(300, 900)));
  EXPECT_TRUE(distance.narrow(0, 300, 600).eq(0).all().item<bool>());
}

TEST_P(FarthestPoint, MatchesTheCpuInAnyMemory) {
  // Points and distances in a GPU's registers, distances alone, and neither.
  for (const int64_t N : {3000, 8000, 8200, 16500, 33000}) {
    const at::Tensor points = test::uniform({N, 3}, 15);
    // So many sets that a GPU does not leave them to the host.
    const std::vector<at::Tensor> sets(5, put(points));
    const auto [index, distance] =
        farthest_point_sampling_of_sets(sets, std::vector<int64_t>(sets.size(), 300));
    const auto [expected_index, expected_distance] = farthest_point_sampling(points, 300);
    EXPECT_TRUE(at::equal(index.back().cpu(), expected_index)) << N;
    EXPECT_TRUE(at::equal(distance.back().cpu(), expected_distance)) << N;
  }
}

TEST_P(FarthestPoint, SetsArePickedFromEachAsByItself) {
  std::vector<at::Tensor> sets;
  std::vector<int64_t> counts;
  for (int64_t i = 0; i < 19; ++i) {
    sets.push_back(put(test::uniform({1 + 61 * i, 3}, 16 + static_cast<uint64_t>(i))));
    counts.push_back(i == 3 ? 0 : 1 + 30 * i);
  }
  const auto [picks, distances] = farthest_point_sampling_of_sets(sets, counts);
  ASSERT_EQ(picks.size(), sets.size());
  for (size_t i = 0; i < sets.size(); ++i) {
    const auto [index, distance] = farthest_point_sampling(sets[i].cpu(), counts[i]);
    EXPECT_TRUE(at::equal(picks[i].cpu(), index)) << i;
    EXPECT_TRUE(at::equal(distances[i].cpu(), distance)) << i;
  }
  EXPECT_TRUE(throws_saying([&] { farthest_point_sampling_of_sets(sets, {1, 2}); }, "2 counts"));
}

TEST_P(FarthestPoint, PicksNothingFromNothing) {
  EXPECT_EQ(sample(at::empty({0, 3}), 0).first.size(0), 0);
  EXPECT_EQ(sample(at::zeros({5, 3}), 0).second.size(0), 0);
}

TEST_P(FarthestPoint, DoesNotDependOnThreads) {
  const at::Tensor points = test::uniform({20000, 3}, 14);
  const auto picks = [&] { return sample(points, 5000); };
  const auto one = test::with_threads(1, picks), two = test::with_threads(2, picks);
  EXPECT_TRUE(at::equal(one.first, two.first));
  EXPECT_TRUE(at::equal(one.second, two.second));
}

TEST_P(FarthestPoint, RefusesBadInput) {
  const auto refused = [](const at::Tensor& points, int64_t count, const char* words) {
    return throws_saying([&] { farthest_point_sampling(points, count); }, words);
  };
  const at::Tensor good = put(at::zeros({4, 3}));
  EXPECT_TRUE(refused(good, 5, "count must be 0 to 4"));
  EXPECT_TRUE(refused(good, -1, "count must be 0 to 4"));
  EXPECT_TRUE(refused(put(at::zeros({4, 4})), 1, "[N, 3]"));
  EXPECT_TRUE(refused(good.to(at::kDouble), 1, "Float"));
  EXPECT_TRUE(refused(put(at::zeros({3, 4})).t(), 1, "contiguous"));
}

// On a GPU the host would have to wait for a look at the values.
TEST(FarthestPointOnTheCpu, RefusesWhatIsNotFinite) {
  at::Tensor bad = at::zeros({4, 3});
  bad[2][0] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(throws_saying([&] { farthest_point_sampling(bad, 1); }, "row 2 of points"));
}

}  // namespace
}  // namespace lte::ops
