#include "lte/pathtrace/incident/guide_field.h"

#include "lte/base/check.h"
#include "lte/pathtrace/materials/lambert.h"

namespace lte::pathtrace {

GuideField::GuideField(SharedPlaces places, std::vector<std::shared_ptr<const GuideTable>> tables,
                       float material_share)
    : places_(std::move(places)), tables_(std::move(tables)), material_share_(material_share) {
  LTE_CHECK(tables_.size() == places_.position().size(), "a field of ", places_.position().size(),
            " places needs as many tables, got ", tables_.size());
  LTE_CHECK(material_share > 0 && material_share < 1,
            "a field's material share must lie in (0, 1), got ", material_share);
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

}  // namespace lte::pathtrace
