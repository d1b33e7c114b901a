#include "experiments/paper/view_camera.h"

#include <cmath>
#include <vector>

#include <ATen/ATen.h>

namespace lte::experiments {
namespace {

constexpr int64_t kMinPixels = 6;
constexpr double kOnePlane = 1e-9;  // second least eigenvalue over the largest

at::Tensor unit(const at::Tensor& v) { return v / v.norm(); }

at::Tensor without(const at::Tensor& v, const at::Tensor& axis) {
  return v - at::dot(v, axis) * axis;
}

}  // namespace

std::optional<ViewCamera> camera_of(const data::View& view) {
  std::vector<double> world, pixel;
  for (int i = 0; i < view.width * view.height; ++i) {
    if (!view.mask[static_cast<size_t>(i)]) continue;
    const Vec3& p = view.position[static_cast<size_t>(i)];
    world.insert(world.end(), {p.x, p.y, p.z});
    pixel.insert(pixel.end(), {(i % view.width + 0.5) / view.width - 0.5,
                               (i / view.width + 0.5) / view.width - 0.5});
  }
  const auto N = static_cast<int64_t>(pixel.size() / 2);
  if (N < kMinPixels) return std::nullopt;
  const at::Tensor X = at::from_blob(world.data(), {N, 3}, at::kDouble),
                   u = at::from_blob(pixel.data(), {N, 2}, at::kDouble);
  const at::Tensor middle = X.mean(0), x = X - middle;
  const double size = x.norm(2, 1).mean().item<double>();
  const at::Tensor h = at::cat({x / size, at::ones({N, 1}, at::kDouble)}, 1);
  const at::Tensor zero = at::zeros_like(h);
  const at::Tensor rows = at::cat({at::cat({h, zero, -u.narrow(1, 0, 1) * h}, 1),
                                   at::cat({zero, h, -u.narrow(1, 1, 1) * h}, 1)});
  const auto [values, vectors] = at::linalg_eigh(rows.t().matmul(rows));
  if (!(values[1].item<double>() > kOnePlane * values[11].item<double>())) return std::nullopt;
  at::Tensor P = vectors.select(1, 0).view({3, 4});
  if (h.matmul(P[2]).mean().item<double>() < 0) P = -P;  // what is seen lies in front
  // P = K [R | t]: from the last row up, what is left of each row of R beside those below it.
  const at::Tensor M = P.narrow(1, 0, 3);
  const at::Tensor z = unit(M[2]), y = unit(without(M[1], z)),
                   right = unit(without(without(M[0], z), y));
  const at::Tensor center = -at::linalg_solve(M, P.select(1, 3));
  return ViewCamera{at::stack({right, y, z}), center * size + middle};
}

}  // namespace lte::experiments
