#include "lte/data/sample_check.h"

#include <cmath>
#include <set>

#include "lte/base/check.h"

namespace lte::data {
namespace {

/// float32 directions written by any sane program are closer to unit length than this.
constexpr float kUnitTolerance = 1e-3f;
constexpr float kAlbedoTolerance = 1e-4f;

/// Visits tensors and collects the optional groups (TensorRule::with) of which any is there.
struct PresentGroups {
  std::set<std::string>* groups;

  template <typename T>
  void operator()(const TensorRule& rule, const std::vector<T>& values) const {
    if (rule.optional() && !values.empty()) groups->insert(rule.with);
  }
};

/// Visits tensors and checks their lengths.
struct LengthCheck {
  const std::string& file;
  const std::set<std::string>& groups;

  template <typename T>
  void operator()(const TensorRule& rule, const std::vector<T>& values) const {
    if (rule.optional() && !groups.contains(rule.with)) return;
    LTE_CHECK(static_cast<int64_t>(values.size()) == rule.entries(), file, ": tensor ", rule.name,
              ": expected ", rule.entries(), " entries, got ", values.size());
  }
};

/// Visits tensors of the right length and checks every value.
class ValueCheck {
 public:
  ValueCheck(const std::string& file, int64_t light_groups)
      : file_(file), light_groups_(light_groups) {}

  void operator()(const TensorRule& rule, const std::vector<Vec3>& values) const {
    for (size_t i = 0; i < values.size(); ++i) {
      const bool hidden = rule.mask != nullptr && !(*rule.mask)[i % rule.mask->size()];
      if (const char* const fault = fault_of(rule.values, values[i], hidden))
        fail(rule.name, i, values[i], fault);
    }
  }

  void operator()(const TensorRule& rule, const std::vector<float>& values) const {
    for (size_t i = 0; i < values.size(); ++i) {
      if (const char* const expected = expected_of(rule.values, values[i]))
        fail(rule.name, "entry", i, values[i], expected);
    }
  }

  void operator()(const TensorRule& rule, const std::vector<Half>& values) const {
    for (size_t i = 0; i < values.size(); ++i) {
      const float value = to_float(values[i]);
      if (const char* const expected = expected_of(rule.values, value))
        fail(rule.name, "value", i, value, expected);
    }
  }

  void operator()(const TensorRule& rule, const std::vector<int32_t>& values) const {
    for (size_t i = 0; i < values.size(); ++i) {
      if (rule.values == Values::LightGroup) {
        if (values[i] < -1 || values[i] >= light_groups_)
          fail(rule.name, "entry", i, values[i],
               concat("-1 or a light group below ", light_groups_));
      } else if (values[i] < 0) {
        fail(rule.name, "entry", i, values[i], "a count that is not negative");
      }
    }
  }

  void operator()(const TensorRule& rule, const std::vector<uint8_t>& values) const {
    for (size_t i = 0; i < values.size(); ++i)
      if (values[i] > 1) fail(rule.name, "entry", i, int{values[i]}, "0 or 1");
  }

  void perpendicular(const std::string& tensor, const std::vector<Vec3>& values,
                     const std::vector<Vec3>& normals) const {
    for (size_t i = 0; i < values.size(); ++i)
      if (std::abs(dot(values[i], normals[i])) > kUnitTolerance)
        fail(tensor, i, values[i], "is not perpendicular to the normal");
  }

 private:
  /// What is wrong with a vector, null for nothing.
  /// @param hidden  it is a pixel that shows no surface
  static const char* fault_of(Values rule, const Vec3& v, bool hidden) {
    if (!is_finite(v)) return "is not finite";
    const bool color = rule == Values::NonNegative || rule == Values::Albedo;
    if (color && (v.x < 0 || v.y < 0 || v.z < 0)) return "is negative";
    if (rule == Values::Albedo && max_component(v) > 1 + kAlbedoTolerance) return "exceeds 1";
    if (hidden) return v == Vec3{} ? nullptr : "is not zero outside the mask";
    if (rule == Values::Unit && std::abs(length(v) - 1) > kUnitTolerance)
      return "is not a unit vector";
    return nullptr;
  }

  /// What a number should have been, null if it is.
  static const char* expected_of(Values rule, float v) {
    switch (rule) {
      case Values::Share:
        return v >= 0 && v <= 1 ? nullptr : "a value in [0, 1]";
      case Values::Positive:
        return std::isfinite(v) && v > 0 ? nullptr : "a finite value above 0";
      default:
        return std::isfinite(v) && v >= 0 ? nullptr : "a finite value that is not negative";
    }
  }

  [[noreturn]] void fail(const std::string& tensor, size_t i, const Vec3& v,
                         const char* fault) const {
    throw Error(concat(file_, ": tensor ", tensor, ": entry ", i, " (", v.x, ", ", v.y, ", ", v.z,
                       ") ", fault));
  }

  template <typename T>
  [[noreturn]] void fail(const std::string& tensor, const char* what, size_t i, T value,
                         const std::string& expected) const {
    throw Error(concat(file_, ": tensor ", tensor, ": ", what, " ", i, " is ", value, "; expected ",
                       expected));
  }

  const std::string& file_;
  const int64_t light_groups_;
};

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
  for (size_t k = 0; k < sample.views.size(); ++k) {
    LTE_CHECK(sample.views[k].width >= 1 && sample.views[k].height >= 1, file, ": view ", k,
              ": expected a positive width and height");
  }
  std::set<std::string> groups;
  for_each_tensor(sample, PresentGroups{&groups});
  for_each_tensor(sample, LengthCheck{file, groups});
  const ValueCheck values(file, sample.light_groups);
  for_each_tensor(sample, values);
  values.perpendicular("incident_tangent", sample.incident.tangent, sample.incident.normal);
}

}  // namespace lte::data
