#include "lte/radiosity/patches.h"

#include <cmath>

#include "lte/base/vector_clones.h"

namespace lte::radiosity {
namespace {

/// Of `count` patches; pointers, as the compiler keeps no loop over vectors in lanes.
struct Arrays {
  const float *x, *y, *z, *nx, *ny, *nz, *area;
};

LTE_VECTOR_CLONES
void weigh(const Arrays& patches, const Vec3& p, const Vec3& n, size_t count,
           float* __restrict weight, int32_t* __restrict sides) {
  const float *x = patches.x, *y = patches.y, *z = patches.z, *nx = patches.nx, *ny = patches.ny,
              *nz = patches.nz, *area = patches.area;
  const float px = p.x, py = p.y, pz = p.z, ux = n.x, uy = n.y, uz = n.z;
  for (size_t k = 0; k < count; ++k) {
    const float dx = x[k] - px, dy = y[k] - py, dz = z[k] - pz;
    const float d2 = dx * dx + dy * dy + dz * dz;
    const float here = dx * ux + dy * uy + dz * uz, there = dx * nx[k] + dy * ny[k] + dz * nz[k];
    const float w = std::abs(here * there) / d2 * area[k] / (d2 + area[k] / kPi);
    weight[k] = d2 > 0 ? w : 0;
    sides[k] = (there > 0 ? Transfers::kFromBack : 0) + (here < 0 ? Transfers::kToBack : 0);
  }
}

}  // namespace

void Patches::add(const Vec3& position, const Vec3& normal, float area) {
  x_.push_back(position.x);
  y_.push_back(position.y);
  z_.push_back(position.z);
  nx_.push_back(normal.x);
  ny_.push_back(normal.y);
  nz_.push_back(normal.z);
  area_.push_back(area);
}

void Patches::transfer_to(const Place& point, Transfers* transfers) const {
  transfers->weight.resize(size());
  transfers->sides.resize(size());
  weigh({x_.data(), y_.data(), z_.data(), nx_.data(), ny_.data(), nz_.data(), area_.data()},
        point.position, point.normal, size(), transfers->weight.data(), transfers->sides.data());
}

}  // namespace lte::radiosity
