// What one sees and what has been edited: the state that all pages share.
#pragma once

#include <optional>
#include <variant>

#include "lte/base/enum_names.h"
#include "lte/base/math.h"
#include "lte/image/tone_curve.h"

namespace lte::infer::view {

/// What the picture shows. Difference is the network's full picture less the reference's.
enum class Shown { Full, Indirect, Direct, Irradiance, Reference, Difference, Albedo, Normal };

using image::ToneCurve;

struct PictureSize {
  int width = 640, height = 480;
  friend bool operator==(const PictureSize&, const PictureSize&) = default;
};
inline constexpr int kMinSide = 16, kMaxSide = 2048;

/// Where an object stands, relative to its place in the file: scaled and turned about the vertical
/// through its foot, then moved.
struct Placement {
  Vec3 move;
  float turn = 0;  ///< degrees, counter-clockwise from above
  float scale = 1;
  friend bool operator==(const Placement&, const Placement&) = default;
};

struct LightSetting {
  int light = 0;
  float gain = 1;                      ///< of the light's radiance in the file
  Rgb color{1, 1, 1};                  ///< largest component 1
  std::optional<Vec3> position = {};   ///< of a point or spot light; others move as objects
  std::optional<Vec3> direction = {};  ///< the way a spot's or sun's light travels; any length
  friend bool operator==(const LightSetting&, const LightSetting&) = default;
};
struct MaterialSetting {
  int material = 0;
  Rgb albedo{1, 1, 1};  ///< linear; of a textured material the factor of its texture
  friend bool operator==(const MaterialSetting&, const MaterialSetting&) = default;
};
struct ObjectSetting {
  int object = 0;
  Placement placement;
  friend bool operator==(const ObjectSetting&, const ObjectSetting&) = default;
};
/// What a page sets of one light, material or object.
using PageEdit = std::variant<LightSetting, MaterialSetting, ObjectSetting>;

/// Whether both change the same light, material or object.
inline bool same_target(const PageEdit& a, const PageEdit& b) {
  if (a.index() != b.index()) return false;
  if (const auto* light = std::get_if<LightSetting>(&a))
    return light->light == std::get<LightSetting>(b).light;
  if (const auto* material = std::get_if<MaterialSetting>(&a))
    return material->material == std::get<MaterialSetting>(b).material;
  return std::get<ObjectSetting>(a).object == std::get<ObjectSetting>(b).object;
}

constexpr EnumNames<Shown, 8> enum_names(Shown) {
  return {{{Shown::Full, "full"},
           {Shown::Indirect, "indirect"},
           {Shown::Direct, "direct"},
           {Shown::Irradiance, "irradiance"},
           {Shown::Reference, "reference"},
           {Shown::Difference, "difference"},
           {Shown::Albedo, "albedo"},
           {Shown::Normal, "normal"}}};
}

}  // namespace lte::infer::view
