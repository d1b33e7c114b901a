// Uses one function of a layer with LibTorch and one without, from the installed headers.
#include <cstdio>

#include <ATen/ops/tensor.h>

#include "lte/lte.h"

int main() {
  const at::Tensor points = at::tensor({0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 5.f, 0.f, 0.f}).view({3, 3});
  const at::Tensor picks = std::get<0>(lte::ops::farthest_point_sampling(points, 2));
  std::printf("%s %lld\n", lte::data::split_name(lte::data::Split::Test),
              static_cast<long long>(picks[1].item<int64_t>()));
  return picks[1].item<int64_t>() == 2 ? 0 : 1;
}
