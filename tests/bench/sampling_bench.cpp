// One timed farthest point sampling for scripts/witnesses/compare_sampling.py:
//   lte_sampling_bench POINTS COUNT REPEATS PICKS
// POINTS holds raw float32 [N, 3]. Raw int64 [COUNT] is written to PICKS, and the least seconds are
// printed.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <vector>

#include <ATen/core/grad_mode.h>
#include <ATen/ops/from_blob.h>

#include "lte/base/timer.h"
#include "lte/ops/farthest_point.h"

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fputs("usage: lte_sampling_bench POINTS COUNT REPEATS PICKS\n", stderr);
    return 2;
  }
  std::ifstream file(argv[1], std::ios::binary);
  std::vector<char> bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const auto N = static_cast<int64_t>(bytes.size() / (3 * sizeof(float)));
  const int64_t count = std::atoll(argv[2]), repeats = std::atoll(argv[3]);
  if (!file || count < 1 || count > N) {
    std::fprintf(stderr, "lte_sampling_bench: %s: not %lld points\n", argv[1],
                 static_cast<long long>(count));
    return 1;
  }
  const at::Tensor points = at::from_blob(bytes.data(), {N, 3}, at::kFloat).clone();
  double least = 1e9;
  at::Tensor picks;
  for (int64_t i = 0; i <= repeats; ++i) {  // the first warms up
    const lte::Timer timer;
    picks = std::get<0>(lte::ops::farthest_point_sampling(points, count));
    if (i > 0) least = std::min(least, timer.seconds());
  }
  std::ofstream out(argv[4], std::ios::binary);
  out.write(reinterpret_cast<const char*>(picks.const_data_ptr<int64_t>()),
            static_cast<std::streamsize>(picks.nbytes()));
  std::printf("%.9f\n", least);
  return out ? 0 : 1;
}
