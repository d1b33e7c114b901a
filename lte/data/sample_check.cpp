#include "lte/data/sample_check.h"

#include <cmath>

#include "lte/base/check.h"

namespace lte::data {
namespace {

/// float32 directions written by any sane program are closer to unit length than this.
constexpr float kUnitTolerance = 1e-3f;

/// Names file and tensor in every message.
class Checker {
 public:
  explicit Checker(std::string file) : file_(std::move(file)) {}

  template <typename T>
  void size(const std::string& tensor, const std::vector<T>& values, int64_t expected) const {
    LTE_CHECK(static_cast<int64_t>(values.size()) == expected, file_, ": tensor ", tensor,
              ": expected ", expected, " entries, got ", values.size());
  }

  void finite(const std::string& tensor, const std::vector<Vec3>& values) const {
    for (size_t i = 0; i < values.size(); ++i)
      if (!is_finite(values[i])) fail(tensor, i, values[i], "is not finite");
  }

  /// Finite and not negative: radiance, irradiance.
  void non_negative(const std::string& tensor, const std::vector<Rgb>& values) const {
    finite(tensor, values);
    for (size_t i = 0; i < values.size(); ++i)
      if (values[i].x < 0 || values[i].y < 0 || values[i].z < 0)
        fail(tensor, i, values[i], "is negative");
  }

  void non_negative(const std::string& tensor, const std::vector<float>& values) const {
    for (size_t i = 0; i < values.size(); ++i)
      LTE_CHECK(std::isfinite(values[i]) && values[i] >= 0, file_, ": tensor ", tensor, ": entry ",
                i, " is ", values[i], "; expected a finite value that is not negative");
  }

  void non_negative(const std::string& tensor, const std::vector<int32_t>& values) const {
    for (size_t i = 0; i < values.size(); ++i)
      LTE_CHECK(values[i] >= 0, file_, ": tensor ", tensor, ": entry ", i, " is ", values[i],
                "; expected a count that is not negative");
  }

  void non_negative(const std::string& tensor, const std::vector<Half>& values) const {
    for (size_t i = 0; i < values.size(); ++i) {
      LTE_CHECK(is_finite(values[i]) && to_float(values[i]) >= 0, file_, ": tensor ", tensor,
                ": value ", i, " is ", to_float(values[i]),
                "; expected a finite value that is not negative");
    }
  }

  void share(const std::string& tensor, const std::vector<float>& values) const {
    for (size_t i = 0; i < values.size(); ++i)
      LTE_CHECK(values[i] >= 0 && values[i] <= 1, file_, ": tensor ", tensor, ": entry ", i, " is ",
                values[i], "; expected a value in [0, 1]");
  }

  void positive(const std::string& tensor, const std::vector<float>& values) const {
    for (size_t i = 0; i < values.size(); ++i)
      LTE_CHECK(std::isfinite(values[i]) && values[i] > 0, file_, ": tensor ", tensor, ": entry ",
                i, " is ", values[i], "; expected a finite value above 0");
  }

  void albedo(const std::string& tensor, const std::vector<Rgb>& values) const {
    non_negative(tensor, values);
    for (size_t i = 0; i < values.size(); ++i)
      if (max_component(values[i]) > 1 + 1e-4f) fail(tensor, i, values[i], "exceeds 1");
  }

  /// Unit vectors; where `mask` is given and 0, anything finite.
  void unit(const std::string& tensor, const std::vector<Vec3>& values,
            const std::vector<uint8_t>* mask) const {
    finite(tensor, values);
    for (size_t i = 0; i < values.size(); ++i) {
      if (mask && !(*mask)[i]) continue;
      if (std::abs(length(values[i]) - 1) > kUnitTolerance)
        fail(tensor, i, values[i], "is not a unit vector");
    }
  }

  void perpendicular(const std::string& tensor, const std::vector<Vec3>& values,
                     const std::vector<Vec3>& normals) const {
    for (size_t i = 0; i < values.size(); ++i)
      if (std::abs(dot(values[i], normals[i])) > kUnitTolerance)
        fail(tensor, i, values[i], "is not perpendicular to the normal");
  }

  void light(const std::vector<int32_t>& values, int64_t groups) const {
    for (size_t i = 0; i < values.size(); ++i)
      LTE_CHECK(values[i] >= -1 && values[i] < groups, file_, ": tensor scene_light: entry ", i,
                " is ", values[i], "; expected -1 or a light group below ", groups);
  }

  void zero_outside(const std::string& tensor, const std::vector<Vec3>& values,
                    const std::vector<uint8_t>& mask) const {
    for (size_t i = 0; i < values.size(); ++i)
      if (!mask[i % mask.size()] && !(values[i] == Vec3{}))
        fail(tensor, i, values[i], "is not zero outside the mask");
  }

  void mask(const std::string& tensor, const std::vector<uint8_t>& values) const {
    for (size_t i = 0; i < values.size(); ++i)
      LTE_CHECK(values[i] <= 1, file_, ": tensor ", tensor, ": entry ", i, " is ", int{values[i]},
                "; expected 0 or 1");
  }

 private:
  [[noreturn]] void fail(const std::string& tensor, size_t i, const Vec3& v,
                         const char* what) const {
    throw Error(concat(file_, ": tensor ", tensor, ": entry ", i, " (", v.x, ", ", v.y, ", ", v.z,
                       ") ", what));
  }

  std::string file_;
};

void check_scene_points(const Checker& check, const SceneSample& sample) {
  const int64_t M = sample.scene_points();
  check.size("scene_normal", sample.scene_normal, M);
  check.size("scene_albedo", sample.scene_albedo, M);
  check.size("scene_emission", sample.scene_emission, M);
  check.size("scene_area", sample.scene_area, M);
  check.size("scene_light", sample.scene_light, M);
  check.finite("scene_position", sample.scene_position);
  check.unit("scene_normal", sample.scene_normal, nullptr);
  check.albedo("scene_albedo", sample.scene_albedo);
  check.non_negative("scene_emission", sample.scene_emission);
  check.non_negative("scene_area", sample.scene_area);
  check.light(sample.scene_light, sample.light_groups);
  if (!sample.scene_direct.empty() || !sample.scene_indirect.empty()) {
    check.size("scene_direct", sample.scene_direct, sample.light_groups * M);
    check.size("scene_indirect", sample.scene_indirect, sample.light_groups * M);
  }
  check.non_negative("scene_direct", sample.scene_direct);
  check.non_negative("scene_indirect", sample.scene_indirect);
  if (sample.scene_metallic.empty() && sample.scene_roughness.empty()) return;
  check.size("scene_metallic", sample.scene_metallic, M);
  check.size("scene_roughness", sample.scene_roughness, M);
  check.share("scene_metallic", sample.scene_metallic);
  check.share("scene_roughness", sample.scene_roughness);
}

void check_incident(const Checker& check, const IncidentField& field, int64_t G) {
  const int64_t P = field.points(), cells = int64_t{field.bins} * field.bins;
  check.size("incident_normal", field.normal, P);
  check.size("incident_tangent", field.tangent, P);
  check.size("incident_albedo", field.albedo, P);
  check.size("incident_metallic", field.metallic, P);
  check.size("incident_roughness", field.roughness, P);
  check.size("incident_scale", field.scale, P);
  check.size("incident_direct", field.direct, G * P * cells * 3);
  check.size("incident_indirect", field.indirect, G * P * cells * 3);
  check.size("incident_direction", field.direction, cells);
  check.size("incident_pdf", field.pdf, cells);
  check.finite("incident_position", field.position);
  check.unit("incident_normal", field.normal, nullptr);
  check.unit("incident_tangent", field.tangent, nullptr);
  check.perpendicular("incident_tangent", field.tangent, field.normal);
  check.albedo("incident_albedo", field.albedo);
  check.share("incident_metallic", field.metallic);
  check.share("incident_roughness", field.roughness);
  check.positive("incident_scale", field.scale);
  check.non_negative("incident_direct", field.direct);
  check.non_negative("incident_indirect", field.indirect);
  check.unit("incident_direction", field.direction, nullptr);
  check.positive("incident_pdf", field.pdf);
}

void check_query_points(const Checker& check, const SceneSample& sample) {
  const int64_t N = sample.query_points(), G = sample.light_groups;
  check.size("query_normal", sample.query_normal, N);
  check.size("query_albedo", sample.query_albedo, N);
  check.size("direct", sample.direct, G * N);
  check.size("indirect", sample.indirect, G * N);
  check.size("variance", sample.variance, N);
  if (!sample.query_rays.empty()) check.size("query_rays", sample.query_rays, N);
  check.non_negative("query_rays", sample.query_rays);
  if (!sample.path_traced_64.empty()) check.size("path_traced_64", sample.path_traced_64, N);
  check.finite("query_position", sample.query_position);
  check.unit("query_normal", sample.query_normal, nullptr);
  check.albedo("query_albedo", sample.query_albedo);
  check.non_negative("direct", sample.direct);
  check.non_negative("indirect", sample.indirect);
  check.non_negative("variance", sample.variance);
  check.non_negative("path_traced_64", sample.path_traced_64);
}

void check_view(const Checker& check, const std::string& prefix, const View& view, int64_t G) {
  const int64_t pixels = int64_t{view.width} * view.height;
  check.size(prefix + "mask", view.mask, pixels);
  check.size(prefix + "position", view.position, pixels);
  check.size(prefix + "normal", view.normal, pixels);
  check.size(prefix + "albedo", view.albedo, pixels);
  check.size(prefix + "direct", view.direct, G * pixels);
  check.size(prefix + "indirect", view.indirect, G * pixels);
  check.size(prefix + "variance", view.variance, pixels);
  if (!view.path_traced_64.empty())
    check.size(prefix + "path_traced_64", view.path_traced_64, pixels);
  check.mask(prefix + "mask", view.mask);
  check.finite(prefix + "position", view.position);
  check.unit(prefix + "normal", view.normal, &view.mask);
  check.albedo(prefix + "albedo", view.albedo);
  check.non_negative(prefix + "direct", view.direct);
  check.non_negative(prefix + "indirect", view.indirect);
  check.non_negative(prefix + "variance", view.variance);
  check.non_negative(prefix + "path_traced_64", view.path_traced_64);
  for (size_t i = 0; i < kFewPaths.size(); ++i) {
    const std::string name = concat(prefix, "path_traced_", kFewPaths[i]);
    if (!view.path_traced_few[i].empty()) check.size(name, view.path_traced_few[i], pixels);
    check.non_negative(name, view.path_traced_few[i]);
  }
  check.zero_outside(prefix + "position", view.position, view.mask);
  check.zero_outside(prefix + "normal", view.normal, view.mask);
  check.zero_outside(prefix + "albedo", view.albedo, view.mask);
  check.zero_outside(prefix + "direct", view.direct, view.mask);
  check.zero_outside(prefix + "indirect", view.indirect, view.mask);
}

}  // namespace

void check_sample(const std::string& file, const SceneSample& sample) {
  LTE_CHECK(sample.scene_points() >= 1, file,
            ": tensor scene_position: expected at least one scene point");
  LTE_CHECK(sample.query_points() >= 1, file,
            ": tensor query_position: expected at least one query point");
  LTE_CHECK(sample.light_groups >= 0, file,
            ": expected a number of light groups that is not negative");
  LTE_CHECK(sample.rays >= 0 && sample.max_depth >= 1, file, ": rays ", sample.rays,
            " or max_depth ", sample.max_depth, " is out of range");
  const Vec3 extent = sample.bounds_high - sample.bounds_low;
  LTE_CHECK(is_finite(extent) && extent.x >= 0 && extent.y >= 0 && extent.z >= 0, file,
            ": bounds are not finite or not in order");
  const Checker check(file);
  check_scene_points(check, sample);
  check_query_points(check, sample);
  if (!sample.incident.empty()) check_incident(check, sample.incident, sample.light_groups);
  for (size_t k = 0; k < sample.views.size(); ++k) {
    const View& view = sample.views[k];
    LTE_CHECK(view.width >= 1 && view.height >= 1, file, ": view ", k,
              ": expected a positive width and height");
    check_view(check, concat("view", k, "_"), view, sample.light_groups);
  }
}

}  // namespace lte::data
