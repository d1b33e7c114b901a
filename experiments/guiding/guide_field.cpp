#include "experiments/guiding/guide_field.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "lte/base/check.h"
#include "lte/base/random.h"
#include "lte/pathtrace/materials/lambert.h"
#include "lte/scene/scene.h"

namespace lte::experiments {

using namespace pathtrace;

GuideField::GuideField(SharedPlaces places, std::vector<std::shared_ptr<const GuideTable>> tables,
                       float material_share, int hits)
    : width_(0.5f * places.radius()),
      places_(std::move(places)),
      tables_(std::move(tables)),
      material_share_(material_share),
      hits_(hits) {
  LTE_CHECK(tables_.size() == places_.position().size(), "a field of ", places_.position().size(),
            " places needs as many tables, got ", tables_.size());
  LTE_CHECK(material_share > 0 && material_share < 1,
            "a field's material share must lie in (0, 1), got ", material_share);
  LTE_CHECK(hits >= 1, "a field must guide at one hit of a path at least, got ", hits);
  fill();
}

GuideField::Voxel GuideField::voxel_of(const Vec3& position, const Vec3& normal) const {
  const auto along = [this](float x) {
    return static_cast<int32_t>(std::clamp(std::floor(x / width_), -1e9f, 1e9f));
  };
  const float x = std::fabs(normal.x), y = std::fabs(normal.y), z = std::fabs(normal.z);
  const int32_t face = x >= y && x >= z ? (normal.x < 0 ? 0 : 1)
                       : y >= z         ? (normal.y < 0 ? 2 : 3)
                                        : (normal.z < 0 ? 4 : 5);
  return {{along(position.x), along(position.y), along(position.z)}, face};
}

size_t GuideField::entry_of(const Voxel& voxel) const {
  uint64_t hash = static_cast<uint64_t>(voxel.face);
  for (const int32_t at : voxel.at) hash = mix_bits(hash ^ static_cast<uint32_t>(at)) + hash;
  const size_t last = entries_.size() - 1;
  size_t at = static_cast<size_t>(mix_bits(hash)) & last;
  while (entries_[at].place != scene::kNone && !(entries_[at].voxel == voxel)) at = (at + 1) & last;
  return at;
}

int32_t GuideField::at(const Vec3& position, const Vec3& normal) const {
  return entries_[entry_of(voxel_of(position, normal))].place;
}

/// Gives each voxel around each place that which is nearest to its middle.
void GuideField::fill() {
  // A place reaches two voxels to each side.
  constexpr int32_t kReach = 2, kSide = 2 * kReach + 1;
  const size_t most = places_.position().size() * kSide * kSide * kSide;
  entries_.assign(std::bit_ceil(2 * most + 1), {{}, scene::kNone});
  const auto apart2 = [this](const Voxel& voxel, int32_t place) {
    const auto middle = [&](size_t axis) {
      return (static_cast<float>(voxel.at[axis]) + 0.5f) * width_;
    };
    const Vec3 apart =
        Vec3{middle(0), middle(1), middle(2)} - places_.position()[static_cast<size_t>(place)];
    return dot(apart, apart);
  };
  for (size_t i = 0; i < places_.position().size(); ++i) {
    const auto place = static_cast<int32_t>(i);
    const Voxel home = voxel_of(places_.position()[i], places_.normal()[i]);
    for (int32_t n = 0; n < kSide * kSide * kSide; ++n) {
      const Voxel voxel{{home.at[0] + n % kSide - kReach, home.at[1] + n / kSide % kSide - kReach,
                         home.at[2] + n / (kSide * kSide) - kReach},
                        home.face};
      Entry& entry = entries_[entry_of(voxel)];
      if (entry.place == scene::kNone || apart2(voxel, place) < apart2(voxel, entry.place))
        entry = {voxel, place};
    }
  }
}

Vec3 GuideField::direction(int32_t place, const Vec3& normal, Vec2 u) const {
  float cosine_density = 0;
  return takes_first(material_share_, &u.x) ? sample_lambert(normal, u, &cosine_density)
                                            : tables_[static_cast<size_t>(place)]->sample(u);
}

float GuideField::pdf(int32_t place, float cosine, const Vec3& direction) const {
  return material_share_ * lambert_pdf(cosine) +
         (1 - material_share_) * tables_[static_cast<size_t>(place)]->pdf(direction);
}

}  // namespace lte::experiments
