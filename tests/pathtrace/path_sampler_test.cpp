// The Sobol points against another implementation, and how they reach the vertices of a path.
#include "lte/pathtrace/path_sampler.h"

#include <vector>

#include <gtest/gtest.h>

namespace lte::pathtrace {
namespace {

/// Points 37 and 101 of the unscrambled sequence, in units of 1/1024, as SciPy 1.17
/// (scipy.stats.qmc.Sobol, whose k-th point is that of index k ^ (k >> 1)) computes them.
TEST(Sobol, IsTheSequenceThatSciPyHas) {
  const std::vector<std::pair<uint32_t, std::array<uint32_t, kSobolDimensions>>> known{
      {1, {512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
           512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512}},
      {37, {656, 944, 752, 848, 496, 784, 720, 16,  976, 976, 304, 48,  688,
            144, 976, 400, 720, 784, 848, 368, 368, 432, 272, 176, 336, 528}},
      {101, {664, 280, 200, 472, 24,  584, 552, 88,  632, 504, 840,  616, 312,
             408, 440, 136, 264, 968, 488, 584, 856, 72,  184, 1000, 424, 1016}}};
  for (const auto& [index, expected] : known) {
    for (int d = 0; d < kSobolDimensions; ++d) {
      uint32_t x = 0;
      for (int bit = 0; bit < 32; ++bit) {
        if ((index >> bit) & 1) x ^= kSobolMatrix[bit][d];
      }
      EXPECT_EQ(reverse_bits(x), expected[d] << 22) << "index " << index << " dimension " << d;
    }
  }
}

/// Every number of a path through `vertices` vertices, in [0, 1).
std::vector<double> numbers(PathSampler& sampler, int vertices) {
  std::vector<double> out;
  sampler.next_path();
  for (int v = 0; v < vertices; ++v) {
    const Vec2 light = sampler.light_point(v), direction = sampler.direction(v);
    out.insert(out.end(), {light.x, light.y, sampler.light_choice(v), direction.x, direction.y});
    if (v > 0) out.push_back(sampler.roulette(v));
  }
  return out;
}

/// Each number of each vertex, over the first n paths of a set, has one value in each n-th of the
/// unit interval: for joint and for padded sets.
TEST(PathSampler, EveryNumberIsStratified) {
  for (const int size : {16, 32, 64, 256}) {
    PathSampler sampler(Sampling::Sobol, 3, 8);
    for (int set = 0; set < 5; ++set) {
      sampler.start_set(size);
      std::vector<std::vector<int>> cells;
      for (int i = 0; i < size; ++i) {
        const std::vector<double> values = numbers(sampler, PathSampler::kStratifiedVertices - 1);
        cells.resize(values.size(), std::vector<int>(static_cast<size_t>(size)));
        for (size_t k = 0; k < values.size(); ++k)
          ++cells[k][static_cast<size_t>(values[k] * size)];
      }
      for (size_t k = 0; k < cells.size(); ++k)
        EXPECT_EQ(cells[k], std::vector<int>(static_cast<size_t>(size), 1)) << k;
    }
  }
}

/// The first direction and the light point at the query point fill every elementary interval of
/// each aligned block: (0, 2)-sequences.
TEST(PathSampler, FirstPairsFillElementaryIntervals) {
  for (const int size : {32, 64}) {  // padded and joint
    PathSampler sampler(Sampling::Sobol, 12, 0);
    for (int set = 0; set < 5; ++set) {
      sampler.start_set(size);
      for (int block = 0; block < size / 16; ++block) {
        std::vector<Vec2> directions, lights;
        for (int i = 0; i < 16; ++i) {
          sampler.next_path();
          directions.push_back(sampler.direction(0));
          lights.push_back(sampler.light_point(0));
        }
        for (int split = 0; split <= 4; ++split) {  // 2^split columns by 2^(4 − split) rows
          for (const auto* pairs : {&directions, &lights}) {
            std::vector<int> cells(16);
            for (const Vec2& p : *pairs) {
              const int column = static_cast<int>(p.x * static_cast<float>(1 << split));
              const int row = static_cast<int>(p.y * static_cast<float>(16 >> split));
              ++cells[static_cast<size_t>(column * (16 >> split) + row)];
            }
            EXPECT_EQ(cells, std::vector<int>(16, 1)) << "split " << split;
          }
        }
      }
    }
  }
}

/// Sets are independent: the product of the same number in two sets has mean 1/4.
TEST(PathSampler, SetsAndNumbersAreUncorrelated) {
  constexpr int kSets = 20'000;
  std::vector<double> previous;
  double across_sets = 0, across_numbers = 0;
  PathSampler sampler(Sampling::Sobol, 5, 1);
  for (int set = 0; set < kSets; ++set) {
    sampler.start_set(8);
    const std::vector<double> values = numbers(sampler, 3);
    if (!previous.empty()) across_sets += values[4] * previous[4] / (kSets - 1);
    across_numbers += values[5] * values[9] / kSets;
    previous = values;
  }
  EXPECT_NEAR(across_sets, 0.25, 0.01);  // 6 standard errors
  EXPECT_NEAR(across_numbers, 0.25, 0.01);
}

/// How far a path goes changes neither its first numbers nor the next path's.
TEST(PathSampler, NumbersDoNotDependOnHowManyAreTaken) {
  PathSampler brief(Sampling::Sobol, 7, 2), thorough(Sampling::Sobol, 7, 2);
  brief.start_set(64), thorough.start_set(64);
  for (int i = 0; i < 64; ++i) {
    numbers(thorough, 9);
    brief.next_path();
    // thorough has just used up the numbers of the same path.
    EXPECT_EQ(brief.direction(4).x, thorough.direction(4).x);
    EXPECT_EQ(brief.light_choice(1), thorough.light_choice(1));
  }
}

}  // namespace
}  // namespace lte::pathtrace
