#include "lte/ops/knn.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <vector>

#include <ATen/ATen.h>
#include <gtest/gtest.h>

#include "tests/ops/fixtures.h"
#include "tests/ops/per_device.h"

namespace lte::ops {
namespace {

using test::throws_saying;

/// Sorts all pairs; float32 and the operation order that the contract fixes.
std::pair<at::Tensor, at::Tensor> brute_force(const at::Tensor& queries, const at::Tensor& points,
                                              int64_t k) {
  const int64_t Q = queries.size(0), N = points.size(0), K = std::min(k, N);
  at::Tensor index = at::empty({Q, K}, at::kLong), distance = at::empty({Q, K});
  const auto* q = queries.const_data_ptr<float>();
  const auto* p = points.const_data_ptr<float>();
  std::vector<std::pair<float, int64_t>> all(N);
  for (int64_t i = 0; i < Q; ++i) {
    for (int64_t j = 0; j < N; ++j) {
      volatile float squares[3];  // rounded one by one: no fused multiply-add
      for (int a = 0; a < 3; ++a) {
        const float d = p[3 * j + a] - q[3 * i + a];
        squares[a] = d * d;
      }
      const float xy = squares[0] + squares[1];
      all[j] = {xy + squares[2], j};
    }
    std::partial_sort(all.begin(), all.begin() + K, all.end());
    for (int64_t j = 0; j < K; ++j) {
      distance.data_ptr<float>()[i * K + j] = all[j].first;
      index.data_ptr<int64_t>()[i * K + j] = all[j].second;
    }
  }
  return {index, distance};
}

class Knn : public test::PerDevice {
 protected:
  /// knn() on this device, its results on the CPU.
  std::pair<at::Tensor, at::Tensor> find(const at::Tensor& queries, const at::Tensor& points,
                                         int64_t k) const {
    const auto [index, distance] = knn(put(queries), put(points), k);
    EXPECT_EQ(index.device().type(), GetParam());
    return {index.cpu(), distance.cpu()};
  }

  void expect_exact(const at::Tensor& queries, const at::Tensor& points, int64_t k,
                    const std::string& what) const {
    const auto [index, distance] = find(queries, points, k);
    const auto [expected_index, expected_distance] = brute_force(queries, points, k);
    EXPECT_TRUE(at::equal(index, expected_index)) << what;
    EXPECT_TRUE(at::equal(distance, expected_distance)) << what;
  }
};
LTE_FOR_EACH_DEVICE(Knn);

TEST_P(Knn, GivesNearestFirst) {
  const at::Tensor points = at::tensor({0.f, 0.f, 0.f, 3.f, 0.f, 0.f, 1.f, 0.f, 0.f}).view({3, 3});
  const auto [index, distance] = find(at::tensor({0.f, 0.f, 2.f}).view({1, 3}), points, 3);
  EXPECT_TRUE(at::equal(index, at::tensor({0, 2, 1}).view({1, 3})));
  EXPECT_TRUE(at::equal(distance, at::tensor({4.f, 5.f, 13.f}).view({1, 3})));
}

TEST_P(Knn, BreaksTiesByLowerIndex) {
  const at::Tensor points = at::full({100, 3}, 2.0f);
  const auto [index, distance] = find(at::zeros({5, 3}), points, 7);
  EXPECT_TRUE(at::equal(index, at::arange(7).expand({5, 7})));
  EXPECT_TRUE(distance.eq(12).all().item<bool>());
}

TEST_P(Knn, MatchesBruteForceBitForBitAtEverySize) {
  for (const int64_t N : {1, 2, 7, 8, 9, 15, 16, 17, 31, 32, 33, 1023, 1024, 1025}) {
    for (const int64_t k : {1, 8, 32}) {
      for (const int64_t Q : {1, 63, 65}) {
        expect_exact(test::uniform({Q, 3}, 1), test::uniform({N, 3}, 2), k,
                     "N " + std::to_string(N) + " k " + std::to_string(k));
      }
    }
  }
}

TEST_P(Knn, MatchesBruteForceOnAwkwardPoints) {
  for (const auto& [name, points] : test::awkward_points(1500)) {
    expect_exact(points, points, 32, name + ", every point a query");
    const at::Tensor near = (points + points * test::normal({1500, 3}, 3, at::kFloat) * 1e-3f)
                                .narrow(0, 0, 400)
                                .contiguous();
    expect_exact(near, points, 9, name + ", queries beside them");
    expect_exact(test::uniform({100, 3}, 4), points, 40, name + ", queries in the unit cube");
  }
}

TEST_P(Knn, MatchesBruteForceForManyNeighbours) {
  const at::Tensor points = test::uniform({2000, 3}, 1);
  for (const int64_t k : {255, 256, 257, 1999, 2000, 2001}) {
    expect_exact(points.narrow(0, 0, 20), points, k, "k " + std::to_string(k));
  }
}

TEST_P(Knn, MatchesBruteForceForManyMoreQueriesThanPoints) {
  // Packets of queries that share candidates, repeated queries among them.
  const at::Tensor dense = test::uniform({20000, 3}, 5).mul(60).floor().div(60);
  for (const auto& [name, points] : test::awkward_points(300)) {
    expect_exact(dense.narrow(0, 0, name == "uniform" ? 20000 : 2000), points, 32, name);
  }
}

/// Enough for boxes over boxes over boxes, some of them far from all others.
TEST_P(Knn, MatchesBruteForceAmongManyPoints) {
  at::Tensor points = test::uniform({70000, 3}, 6);
  points.narrow(0, 1000, 40).add_(1e4);
  const at::Tensor queries = at::cat({test::uniform({200, 3}, 7), points.narrow(0, 990, 60)});
  for (const int64_t k : {1, 32, 60}) expect_exact(queries, points, k, "70000 points");
}

TEST_P(Knn, DoesNotDependOnThreadsNorOnTheOrderOfQueries) {
  const at::Tensor points = test::uniform({3000, 3}, 1), queries = test::uniform({5000, 3}, 2);
  const auto one = test::with_threads(1, [&] { return find(queries, points, 16); });
  const auto two = test::with_threads(2, [&] { return find(queries, points, 16); });
  EXPECT_TRUE(at::equal(std::get<0>(one), std::get<0>(two)));
  EXPECT_TRUE(at::equal(std::get<1>(one), std::get<1>(two)));
  const at::Tensor order = test::uniform({5000}, 3).argsort();
  const auto shuffled = find(queries.index_select(0, order).contiguous(), points, 16);
  EXPECT_TRUE(at::equal(std::get<0>(one).index_select(0, order), std::get<0>(shuffled)));
}

TEST_P(Knn, NoQueriesGiveNoRows) {
  EXPECT_EQ(find(at::empty({0, 3}), at::empty({0, 3}), 4).first.sizes(), (at::IntArrayRef{0, 0}));
  EXPECT_EQ(find(at::empty({0, 3}), at::zeros({9, 3}), 4).second.sizes(), (at::IntArrayRef{0, 4}));
}

TEST_P(Knn, RefusesBadInput) {
  const auto refused = [](const at::Tensor& queries, const at::Tensor& points, int64_t k,
                          const char* words) {
    return throws_saying([&] { knn(queries, points, k); }, words);
  };
  const at::Tensor good = put(at::zeros({4, 3}));
  EXPECT_TRUE(refused(good, good, 0, "k must be at least 1"));
  EXPECT_TRUE(refused(good, good.narrow(0, 0, 0), 1, "no points"));
  EXPECT_TRUE(refused(put(at::zeros({4, 2})), good, 1, "queries must be [N, 3]"));
  EXPECT_TRUE(refused(good, put(at::zeros({4})), 1, "points must be [N, 3]"));
  EXPECT_TRUE(refused(good.to(at::kDouble), good, 1, "Float"));
  EXPECT_TRUE(refused(put(at::zeros({3, 4})).t(), good, 1, "contiguous"));
  if (!on_cpu()) {
    EXPECT_TRUE(refused(good, good.cpu(), 1, "points on cpu"));
  }
}

// On a GPU the host would have to wait for a look at the values.
TEST(KnnOnTheCpu, RefusesWhatIsNotFinite) {
  const at::Tensor good = at::zeros({4, 3});
  at::Tensor bad = good.clone();
  bad[3][2] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(throws_saying([&] { knn(bad, good, 1); }, "row 3 of queries is not finite"));
  bad[1][0] = std::numeric_limits<float>::infinity();
  EXPECT_TRUE(throws_saying([&] { knn(good, bad, 1); }, "row 1 of points is not finite"));
}

TEST(KnnIndex, AnswersAsKnnDoes) {
  for (const int64_t N : {1, 7, 40, 3000}) {
    const at::Tensor points = test::uniform({N, 3}, 31);
    for (const int64_t k : {1, 8, 32}) {
      const KnnIndex index(points, k);
      for (const int64_t Q : {0, 1, 2, 255, 256, 1025}) {
        const at::Tensor queries = test::uniform({Q, 3}, 32 + static_cast<uint64_t>(Q));
        const auto [found, distance] = index.search(queries);
        const auto [expected, expected_distance] = knn(queries, points, k);
        EXPECT_TRUE(at::equal(found, expected)) << N << " points, " << Q << " queries, k " << k;
        EXPECT_TRUE(at::equal(distance, expected_distance));
      }
    }
  }
}

TEST(KnnIndex, RefusesWhatKnnRefuses) {
  const at::Tensor good = test::uniform({4, 3}, 33);
  at::Tensor bad = good.clone();
  bad[2][1] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(throws_saying([&] { KnnIndex(bad, 1); }, "row 2 of points is not finite"));
  EXPECT_TRUE(throws_saying([&] { KnnIndex(good, 0); }, "k must be at least 1"));
  EXPECT_TRUE(throws_saying([&] { KnnIndex(at::zeros({0, 3}), 1); }, "needs points"));
  EXPECT_TRUE(throws_saying([&] { KnnIndex(good, 1).search(bad); }, "row 2 of queries"));
}

}  // namespace
}  // namespace lte::ops
