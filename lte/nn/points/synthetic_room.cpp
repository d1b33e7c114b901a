#include "lte/nn/points/synthetic_room.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "lte/base/random.h"
#include "lte/tensor/functions.h"

namespace lte::nn {

PointSet synthetic_room(int64_t count, uint64_t seed) {
  // A 6 x 4 x 2.7 m box holds twelve smaller ones; faces are drawn by area.
  Rng rng(seed);
  struct Box {
    float low[3], high[3];
  };
  std::vector<Box> boxes{{{0, 0, 0}, {6, 2.7f, 4}}};
  for (int i = 0; i < 12; ++i) {
    const float x = rng.uniform(0.2f, 4.6f), z = rng.uniform(0.2f, 2.8f);
    boxes.push_back(
        {{x, 0, z},
         {x + rng.uniform(0.3f, 1.2f), rng.uniform(0.3f, 1.8f), z + rng.uniform(0.3f, 1.0f)}});
  }
  std::vector<float> cumulative;
  for (const Box& box : boxes) {
    for (int face = 0; face < 6; ++face) {
      const int u = (face / 2 + 1) % 3, v = (face / 2 + 2) % 3;
      const float area = (box.high[u] - box.low[u]) * (box.high[v] - box.low[v]);
      cumulative.push_back((cumulative.empty() ? 0 : cumulative.back()) + area);
    }
  }
  PointSet points = {
      at::empty({count, 3}),
      at::zeros({count, 3}),
      at::empty({count, 3}),
      at::zeros({count, 3}),
      at::full({count}, cumulative.back() / static_cast<float>(std::max<int64_t>(count, 1))),
      at::zeros({count, 3}),
      at::zeros({count, 3}),
      {},
      {},
      {},
      {}};
  auto* position = points.position.data_ptr<float>();
  auto* normal = points.normal.data_ptr<float>();
  auto* albedo = points.albedo.data_ptr<float>();
  auto* emission = points.emission.data_ptr<float>();
  for (int64_t i = 0; i < count; ++i) {
    const float pick = rng.uniform() * cumulative.back();
    const auto face = std::min<int64_t>(
        std::upper_bound(cumulative.begin(), cumulative.end(), pick) - cumulative.begin(),
        static_cast<int64_t>(cumulative.size()) - 1);
    const Box& box = boxes[static_cast<size_t>(face / 6)];
    const int axis = static_cast<int>(face % 6) / 2;
    const bool high = face % 2 == 1;
    for (int a = 0; a < 3; ++a) {
      position[3 * i + a] =
          a == axis ? (high ? box.high[a] : box.low[a]) : rng.uniform(box.low[a], box.high[a]);
      albedo[3 * i + a] = rng.uniform(0.2f, 0.8f);
    }
    // The room faces inwards, furniture outwards.
    normal[3 * i + axis] = (high == (face >= 6)) ? 1.0f : -1.0f;
    const bool lamp = face == 3 && std::abs(position[3 * i] - 3) < 0.4f &&
                      std::abs(position[3 * i + 2] - 2) < 0.3f;
    for (int a = 0; lamp && a < 3; ++a) emission[3 * i + a] = 15;
  }
  for (const at::Tensor& irradiance : {points.direct, points.indirect}) {
    auto* values = irradiance.data_ptr<float>();
    for (int64_t i = 0; i < irradiance.numel(); ++i) values[i] = rng.uniform(0, 10);
  }
  // Furniture and the room are closed: of three points in four the back is dark.
  points.direct_back = at::zeros({count, 3});
  points.indirect_back = at::zeros({count, 3});
  points.indirect_error = at::empty({count, 2});
  for (const auto& [both, back] : {std::pair{points.direct, points.direct_back},
                                   std::pair{points.indirect, points.indirect_back}}) {
    const auto* all = both.const_data_ptr<float>();
    auto* values = back.data_ptr<float>();
    for (int64_t i = 0; i < both.numel(); ++i)
      if (i / 3 % 4 == 0) values[i] = all[i] * rng.uniform();
  }
  auto* error = points.indirect_error.data_ptr<float>();
  for (int64_t i = 0; i < points.indirect_error.numel(); ++i) error[i] = rng.uniform();
  return points;
}

}  // namespace lte::nn
