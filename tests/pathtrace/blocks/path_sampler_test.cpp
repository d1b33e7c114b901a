// The Sobol points against another implementation, and how they reach the vertices of a path.
#include "lte/pathtrace/blocks/path_sampler.h"

#include <algorithm>
#include <memory>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

namespace lte::pathtrace {
namespace {

/// Points 37 and 101 of the unscrambled sequence, in units of 1/1024, as SciPy 1.17
/// (scipy.stats.qmc.Sobol, whose k-th point is that of index k ^ (k >> 1)) computes them.
TEST(Sobol, IsTheSequenceThatSciPyHas) {
  const std::vector<std::pair<uint32_t, std::array<uint32_t, kSobolDimensions>>> known{
      {1, {512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
           512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512}},
      {37, {656, 944, 752, 848, 496, 784, 720, 16,  976, 976, 304, 48,  688, 144,
            976, 400, 720, 784, 848, 368, 368, 432, 272, 176, 336, 528, 80,  176}},
      {101, {664, 280, 200, 472, 24,  584, 552, 88, 632, 504,  840, 616,  312, 408,
             440, 136, 264, 968, 488, 584, 856, 72, 184, 1000, 424, 1016, 632, 184}}};
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

/// Of 64 consecutive points one lies at each place, and tile_index() finds it.
TEST(TileSequence, PlacesTakeTurns) {
  for (const uint32_t number : {0u, 1u, 2u, 77u, 5000u, (1u << 24) + 3}) {
    for (uint32_t place = 0; place < kTilePlaces; ++place) {
      const uint32_t index = tile_index(number, place);
      EXPECT_EQ(index / kTilePlaces, number);
      EXPECT_EQ(tile_place(index), place);
    }
  }
}

/// The paths of one sampler as a block, in sets.
class Blocks {
 public:
  Blocks(int set_size, uint64_t seed, uint64_t stream)
      : set_size_(set_size),
        sampler_(std::make_unique<PathSampler>(Sampling::Sobol, set_size)),
        light_(std::make_unique<LightNumbers>()),
        direction_(std::make_unique<DirectionNumbers>()) {
    sampler_->start_stream(seed, stream);
  }

  /// The next set, as a block.
  void next_set() {
    sampler_->clear();
    sampler_->start_set();
    for (int i = 0; i < set_size_; ++i) sampler_->add_path();
  }

  /// Every number of the paths given through `vertices` vertices, in [0, 1): [path][number].
  std::vector<std::vector<double>> numbers(int vertices, const std::vector<int32_t>& path) {
    const auto count = static_cast<int>(path.size());
    std::vector<std::vector<double>> out(path.size());
    const auto take = [&](const uint32_t* values) {
      for (size_t i = 0; i < path.size(); ++i) out[i].push_back(values[i] * 0x1p-32);
    };
    for (int v = 0; v < vertices; ++v) {
      sampler_->light(v, path.data(), count, light_.get());
      take(light_->point_x);
      take(light_->point_y);
      take(light_->choice);
      sampler_->direction(v, path.data(), count, direction_.get());
      take(direction_->x);
      take(direction_->y);
      if (v == 0) continue;
      std::vector<uint32_t> roulette(path.size());
      sampler_->roulette(v, path.data(), count, roulette.data());
      take(roulette.data());
    }
    return out;
  }

  std::vector<std::vector<double>> numbers(int vertices) {
    std::vector<int32_t> all(static_cast<size_t>(set_size_));
    std::iota(all.begin(), all.end(), 0);
    return numbers(vertices, all);
  }

 private:
  int set_size_;
  std::unique_ptr<PathSampler> sampler_;
  std::unique_ptr<LightNumbers> light_;
  std::unique_ptr<DirectionNumbers> direction_;
};

/// Each number of each vertex, over the first n paths of a set, has one value in each n-th of the
/// unit interval: for joint and for padded sets.
TEST(PathSampler, EveryNumberIsStratified) {
  for (const int size : {16, 32, 64, 256}) {
    Blocks blocks(size, 3, 8);
    for (int set = 0; set < 5; ++set) {
      blocks.next_set();
      const auto paths = blocks.numbers(PathSampler::kStratifiedVertices - 1);
      for (size_t k = 0; k < paths[0].size(); ++k) {
        std::vector<int> cells(static_cast<size_t>(size));
        for (const auto& path : paths) ++cells[static_cast<size_t>(path[k] * size)];
        EXPECT_EQ(cells, std::vector<int>(static_cast<size_t>(size), 1)) << k;
      }
    }
  }
}

/// The first direction and the light point at the query point fill every elementary interval of
/// each aligned block: (0, 2)-sequences.
TEST(PathSampler, FirstPairsFillElementaryIntervals) {
  constexpr size_t kPairs[] = {0, 3};  // light point, direction
  for (const int size : {32, 64}) {    // padded and joint
    Blocks blocks(size, 12, 0);
    for (int set = 0; set < 5; ++set) {
      blocks.next_set();
      const auto paths = blocks.numbers(1);
      for (int block = 0; block < size / 16; ++block) {
        for (int split = 0; split <= 4; ++split) {  // 2^split columns by 2^(4 − split) rows
          for (const size_t pair : kPairs) {
            std::vector<int> cells(16);
            for (int i = 16 * block; i < 16 * (block + 1); ++i) {
              const auto& path = paths[static_cast<size_t>(i)];
              const auto column = static_cast<size_t>(path[pair] * (1 << split));
              const auto row = static_cast<size_t>(path[pair + 1] * (16 >> split));
              ++cells[column * (16u >> split) + row];
            }
            EXPECT_EQ(cells, std::vector<int>(16, 1)) << "split " << split;
          }
        }
      }
    }
  }
}

/// Directions at one place of a tile: of 16 points each sixteenth of the square has one, of all
/// places' four together each 256th has one or two, and of 16 a place each has four.
TEST(PathSampler, PlacesOfATileFillTheirOwnGapsAndThoseOfAll) {
  constexpr int kEach = 16;
  const auto sampler = std::make_unique<PathSampler>(Sampling::Sobol, 1 << 30, kTileDimensions);
  const auto numbers = std::make_unique<DirectionNumbers>();
  sampler->start_stream(5, 0);
  sampler->start_set();
  std::vector<int> fine_of_few(256), fine(256);
  for (uint32_t place = 0; place < kTilePlaces; ++place) {
    sampler->clear();
    std::vector<int32_t> path;
    for (int k = 0; k < kEach; ++k) {
      sampler->go_to(tile_index(static_cast<uint32_t>(k), place));
      path.push_back(sampler->paths());
      sampler->add_path();
    }
    sampler->direction(0, path.data(), kEach, numbers.get());
    std::vector<int> coarse(16);
    for (int k = 0; k < kEach; ++k) {
      const uint32_t x = numbers->x[k], y = numbers->y[k];
      ++coarse[(x >> 30) * 4 + (y >> 30)];
      ++fine[(x >> 28) * 16 + (y >> 28)];
      if (k < 4) ++fine_of_few[(x >> 28) * 16 + (y >> 28)];
    }
    EXPECT_EQ(coarse, std::vector<int>(16, 1)) << place;
  }
  EXPECT_EQ(fine, std::vector<int>(256, 4));
  for (const int count : fine_of_few) EXPECT_LE(count, 2);
}

/// The numbers of a path are those of its index, however it has been come to.
TEST(PathSampler, GoesToAnyPathOfASet) {
  constexpr int kPaths = 40;
  const auto numbers_of = [](const std::vector<uint32_t>& indices) {
    const auto sampler = std::make_unique<PathSampler>(Sampling::Sobol, 256);
    const auto numbers = std::make_unique<DirectionNumbers>();
    sampler->start_stream(9, 4);
    sampler->start_set();
    std::vector<int32_t> path;
    for (const uint32_t index : indices) {
      sampler->go_to(index);
      path.push_back(sampler->paths());
      sampler->add_path();
    }
    std::vector<uint32_t> out;
    for (const int vertex : {0, PathSampler::kStratifiedVertices + 2}) {  // Sobol, independent
      sampler->direction(vertex, path.data(), static_cast<int>(path.size()), numbers.get());
      out.insert(out.end(), numbers->x, numbers->x + path.size());
    }
    return out;
  };
  std::vector<uint32_t> forward(kPaths);
  std::iota(forward.begin(), forward.end(), 0u);
  const std::vector<uint32_t> expected = numbers_of(forward);
  const std::vector<uint32_t> backward(forward.rbegin(), forward.rend());
  std::vector<uint32_t> found = numbers_of(backward);
  std::reverse(found.begin(), found.begin() + kPaths);
  std::reverse(found.begin() + kPaths, found.end());
  EXPECT_EQ(found, expected);
}

/// Sets are independent: the product of the same number in two sets has mean 1/4.
TEST(PathSampler, SetsAndNumbersAreUncorrelated) {
  constexpr int kSets = 20'000;
  std::vector<double> previous;
  double across_sets = 0, across_numbers = 0;
  Blocks blocks(8, 5, 1);
  for (int set = 0; set < kSets; ++set) {
    blocks.next_set();
    const std::vector<double> values = blocks.numbers(3, {0})[0];
    if (!previous.empty()) across_sets += values[4] * previous[4] / (kSets - 1);
    across_numbers += values[5] * values[9] / kSets;
    previous = values;
  }
  EXPECT_NEAR(across_sets, 0.25, 0.01);  // 6 standard errors
  EXPECT_NEAR(across_numbers, 0.25, 0.01);
}

/// Past the last stratified vertex: independent from path to path, vertex to vertex and number to
/// number, and uniform.
TEST(PathSampler, LaterNumbersAreIndependent) {
  constexpr int kSets = 300, kSize = 64, kFirstNumber = 5 + 6 * 4;  // of vertex 5
  double mean = 0, across_paths = 0, across_numbers = 0, across_vertices = 0;
  Blocks blocks(kSize, 5, 3);
  for (int set = 0; set < kSets; ++set) {
    blocks.next_set();
    const auto paths = blocks.numbers(7);
    for (int i = 0; i < kSize; ++i) {
      const auto& a = paths[static_cast<size_t>(i)];
      const auto& b = paths[static_cast<size_t>((i + 1) % kSize)];
      const double x = a[kFirstNumber];
      mean += x / (kSets * kSize);
      across_paths += x * b[kFirstNumber] / (kSets * kSize);
      across_numbers += x * a[kFirstNumber + 1] / (kSets * kSize);
      across_vertices += x * a[kFirstNumber + 6] / (kSets * kSize);
    }
  }
  EXPECT_NEAR(mean, 0.5, 0.01);  // 5 standard errors
  EXPECT_NEAR(across_paths, 0.25, 0.01);
  EXPECT_NEAR(across_numbers, 0.25, 0.01);
  EXPECT_NEAR(across_vertices, 0.25, 0.01);
}

/// A path's numbers depend neither on which others are asked for nor on what was asked before.
TEST(PathSampler, NumbersDoNotDependOnHowManyAreTaken) {
  for (const int size : {32, 64}) {
    Blocks some(size, 7, 2), all(size, 7, 2);
    some.next_set();
    all.next_set();
    const auto paths = all.numbers(9);
    const auto few = some.numbers(9, {3, 11, 30});
    EXPECT_EQ(few[0], paths[3]);
    EXPECT_EQ(few[1], paths[11]);
    EXPECT_EQ(few[2], paths[30]);
    EXPECT_EQ(some.numbers(2, {5})[0],
              std::vector<double>(paths[5].begin(), paths[5].begin() + 11));
  }
}

/// A set that goes on in the next block goes on in its points; the next point of the sequence is
/// not lost, and its seeds stay.
TEST(PathSampler, SetsGoOnOverBlocks) {
  constexpr int kSize = 2 * kBlock;
  const auto sampler = std::make_unique<PathSampler>(Sampling::Sobol, kSize);
  sampler->start_stream(4, 4);
  sampler->start_set();
  std::vector<int> cells(kSize);
  const auto numbers = std::make_unique<DirectionNumbers>();
  std::vector<int32_t> all(kBlock);
  std::iota(all.begin(), all.end(), 0);
  for (int block = 0; block < 2; ++block) {
    for (int i = 0; i < kBlock; ++i) sampler->add_path();
    sampler->direction(2, all.data(), kBlock, numbers.get());
    for (const uint32_t x : numbers->x) ++cells[static_cast<size_t>(x * 0x1p-32 * kSize)];
    sampler->clear();
  }
  EXPECT_EQ(cells, std::vector<int>(kSize, 1));
}

}  // namespace
}  // namespace lte::pathtrace
