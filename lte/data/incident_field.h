// Incident radiance by direction at some points of a scene, as a sample file may hold it: targets
// for glossy surfaces (the paper's section 5.3).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "lte/base/half.h"
#include "lte/base/math.h"
#include "lte/data/tensor_rule.h"

namespace lte::data {

/// P points, B × B cells of the hemisphere around each normal, G light groups. docs/dataset.md has
/// the tensors and their units.
struct IncidentField {
  int bins = 0;                        ///< B, even; 0 for no field
  int64_t samples = 0;                 ///< paths a cell
  std::vector<Vec3> position, normal;  ///< [P]
  std::vector<Vec3> tangent;           ///< [P] unit: x axis of the cells' frame, the normal is z
  std::vector<Rgb> albedo;             ///< [P]
  std::vector<float> metallic, roughness;  ///< [P] in [0, 1]
  std::vector<float> scale;                ///< [P] powers of two: radiance is scale × value
  std::vector<Half> direct, indirect;      ///< [G, P, B, B, 3]
  std::vector<Vec3> direction;             ///< [B, B] unit, of the cells' centres in that frame
  std::vector<float> pdf;                  ///< [B, B] 1/sr, mean over the cell

  int64_t points() const { return static_cast<int64_t>(position.size()); }
  bool empty() const { return bins == 0; }
  size_t size_bytes() const;  ///< of all tensors
};

/// Calls visit(const TensorRule&, std::vector<T>&) for every tensor of a field that is not empty.
/// Shapes follow from `bins` and the number of positions. See for_each_tensor() in scene_sample.h.
template <typename Field, typename Visitor>
void for_each_incident_tensor(Field& field, int64_t light_groups, Visitor&& visit) {
  using enum Values;
  const int64_t G = light_groups, P = field.points(), B = field.bins;
  visit({"incident_position", {P}, Finite}, field.position);
  visit({"incident_normal", {P}, Unit}, field.normal);
  visit({"incident_tangent", {P}, Unit}, field.tangent);
  visit({"incident_albedo", {P}, Albedo}, field.albedo);
  visit({"incident_metallic", {P}, Share}, field.metallic);
  visit({"incident_roughness", {P}, Share}, field.roughness);
  visit({"incident_scale", {P}, Positive}, field.scale);
  visit({"incident_direct", {G, P, B, B, 3}, NonNegative}, field.direct);
  visit({"incident_indirect", {G, P, B, B, 3}, NonNegative}, field.indirect);
  visit({"incident_direction", {B, B}, Unit}, field.direction);
  visit({"incident_pdf", {B, B}, Positive}, field.pdf);
}

/// The power of two that brings values up to `largest` into [2^14, 2^15), where half precision ends
/// at 65504: nothing overflows, and what is 2^29 times smaller still has all 11 bits. 1 for 0.
/// @param largest  finite, not negative
float half_scale(float largest);

}  // namespace lte::data
