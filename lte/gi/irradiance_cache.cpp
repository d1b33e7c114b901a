#include "lte/gi/irradiance_cache.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "lte/base/check.h"

namespace lte::gi {
namespace {

// Least sum of weights for an answer; a single record at its own place has 1.
constexpr float kLeastWeight = 0.4f;
// Standard deviation of direct irradiance between the records around a place beyond which the cache
// does not know the light there, over their mean total irradiance: smoothing would carry light past
// edges of shadows, gaps and walls. Paths go on there without bias. Noise of the records is no such
// difference: its variance is taken off.
constexpr float kUneven = 0.35f;
// Added to that bound, over the mean total irradiance of all lit records by area.
constexpr float kEvenBelow = 0.05f;

float gray(const Rgb& light) { return light.x + light.y + light.z; }

}  // namespace

IrradianceCache::IrradianceCache(std::shared_ptr<const CacheGeometry> geometry,
                                 const CacheRecords& records, std::span<const Rgb> irradiance,
                                 std::span<const Rgb> direct,
                                 std::span<const float> direct_variance,
                                 std::span<const Rgb> shorter)
    : geometry_(std::move(geometry)), records_(records.position.size()) {
  LTE_CHECK(geometry_ != nullptr && geometry_->size() == size(),
            "irradiance cache: the geometry is not of its records");
  LTE_CHECK(direct.empty() || direct.size() == records_.size(),
            "irradiance cache: ", records_.size(), " records but ", direct.size(),
            " of direct light");
  LTE_CHECK(direct_variance.empty() || direct_variance.size() == direct.size(),
            "irradiance cache: ", direct.size(), " of direct light but ", direct_variance.size(),
            " variances");
  for (size_t i = 0; i < direct.size(); ++i) {
    LTE_CHECK(is_finite(direct[i]), "irradiance cache: direct light ", i, " is not finite");
    records_[i].direct = gray(direct[i]);
    if (!direct_variance.empty()) records_[i].noise = direct_variance[i];
  }
  set_light(records, irradiance, shorter);
}

IrradianceCache::IrradianceCache(const pathtrace::Bvh& bvh, const CacheRecords& records,
                                 std::span<const Rgb> irradiance, std::span<const Rgb> direct,
                                 std::span<const float> direct_variance,
                                 std::span<const Rgb> shorter)
    : IrradianceCache(std::make_shared<const CacheGeometry>(bvh, records), records, irradiance,
                      direct, direct_variance, shorter) {}

IrradianceCache IrradianceCache::of(std::shared_ptr<const CacheGeometry> geometry,
                                    const CacheRecords& records, const RecordLight& light) {
  return {std::move(geometry),   records,        light.total(), light.direct,
          light.direct_variance, light.shorter()};
}

IrradianceCache IrradianceCache::relit(const CacheRecords& records, std::span<const Rgb> irradiance,
                                       std::span<const Rgb> shorter) const {
  IrradianceCache out(*this);
  out.set_light(records, irradiance, shorter);
  return out;
}

IrradianceCache IrradianceCache::answering(std::span<const Rgb> irradiance) const {
  LTE_CHECK(irradiance.size() == records_.size(), "irradiance cache: ", records_.size(),
            " records but ", irradiance.size(), " irradiances");
  IrradianceCache out(*this);
  for (size_t i = 0; i < irradiance.size(); ++i) {
    out.records_[i].irradiance = out.records_[i].shorter = irradiance[i];
  }
  return out;
}

void IrradianceCache::set_light(const CacheRecords& records, std::span<const Rgb> irradiance,
                                std::span<const Rgb> shorter) {
  LTE_CHECK(records.position.size() == records_.size() && irradiance.size() == records_.size(),
            "irradiance cache: ", records.size(), " records but ", irradiance.size(),
            " irradiances");
  LTE_CHECK(shorter.empty() || shorter.size() == irradiance.size(),
            "irradiance cache: ", irradiance.size(), " irradiances but ", shorter.size(),
            " of a bounce less");
  double light = 0, area = 0;
  std::vector<uint8_t> lit(irradiance.size());
  for (size_t i = 0; i < irradiance.size(); ++i) {
    LTE_CHECK(is_finite(irradiance[i]), "irradiance cache: irradiance ", i, " is not finite");
    records_[i].irradiance = irradiance[i];
    records_[i].shorter = shorter.empty() ? irradiance[i] : shorter[i];
    records_[i].total = gray(irradiance[i]);
    light += double{gray(irradiance[i])} * double{records.area[i]};
    lit[i] = gray(irradiance[i]) > 0;
    area += lit[i] ? double{records.area[i]} : 0;
  }
  even_below_ = area > 0 ? kEvenBelow * static_cast<float>(light / area) : 0;
  // Records that paths have found no light at say so beside lit ones: without them the cache would
  // be too bright where light is rare. Of those that no lit one leads to nothing is known.
  const std::vector<uint8_t> dark = geometry_->dark_sheets(records, lit);
  for (size_t i = 0; i < records_.size(); ++i) {
    // What stands near a lamp knows light that ends there: it would carry it on.
    records_[i].silent =
        dark[i] != 0 || geometry_->near_lamp(records.position[i], records.normal[i]);
  }
  bright_ = BrightPlaces(records, irradiance);
}

bool IrradianceCache::lookup(const Vec3& position, const Vec3& normal, Rgb* irradiance,
                             int hit) const {
  if (geometry_->near_lamp(position, normal)) return false;
  Rgb sum;
  float weights = 0, shares = 0, total = 0, direct = 0, squares = 0, noise = 0;
  geometry_->for_each(position, normal, [&](uint32_t i, float weight, const Vec3& offset) {
    const Record& record = records_[i];
    if (record.silent || geometry_->hidden(i, offset)) return;
    const float share = geometry_->share(i);
    sum += (hit > 1 ? record.shorter : record.irradiance) * (weight * share);
    shares += weight * share;
    weights += weight;
    total += record.total * weight;
    direct += record.direct * weight;
    squares += (record.direct * record.direct - record.noise) * weight;
    noise += record.noise * weight * weight;
  });
  if (!(weights >= kLeastWeight)) return false;
  const float scale = 1 / weights, mean = direct * scale;
  *irradiance = sum / shares;
  const float bound = kUneven * total * scale + even_below_;
  // Expected squares hold the variance of each record, that of the mean what is left in the mean.
  return squares * scale - mean * mean + noise * scale * scale <= bound * bound;
}

}  // namespace lte::gi
