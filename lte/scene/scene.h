// A scene in memory: meshes stored once, instances that place them, materials, textures, lights,
// cameras.
//
// World space is the file's own; for glTF that is metres, Y up. Radiance is in W sr^-1 m^-2, linear
// Rec.709.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lte/base/math.h"
#include "lte/scene/environment.h"
#include "lte/scene/texture.h"

namespace lte::scene {

inline constexpr int kNone = -1;
/// UV sets of a mesh: as many as Blender has.
inline constexpr int kUvSets = 8;

/// A texture as a material uses it: image, wrap modes, UV set and KHR_texture_transform.
struct TextureRef {
  int texture = kNone;  ///< index into Scene::textures, kNone for none
  int uv_set = 0;       ///< 0 to kUvSets - 1
  Wrap wrap_u = Wrap::Repeat, wrap_v = Wrap::Repeat;
  Vec2 offset{0, 0}, scale{1, 1};
  float rotation = 0;  ///< radians, counter-clockwise as KHR_texture_transform has it

  /// UV after offset * rotation * scale.
  Vec2 transform(const Vec2& uv) const;
};

struct Material {
  std::string name;
  Rgb base_color{1, 1, 1};  ///< linear factor
  TextureRef base_color_texture;
  Rgb emission{0, 0, 0};  ///< radiance factor, KHR_materials_emissive_strength included
  TextureRef emission_texture;
  bool double_sided = false;  ///< decides whether emission leaves the back face too
  /// [0, 1]: share of a rough conductor that reflects the base color at normal incidence (GGX,
  /// Schlick's Fresnel); the rest is Lambertian with the base color as albedo.
  float metallic = 0;
  float roughness = 1;  ///< [0, 1], of the conductor: α = roughness²
  /// Linear: G times `roughness`, B times `metallic`.
  TextureRef metallic_roughness_texture;
  /// Linear: directions that stand in for the normal (shading_normal.h), x along the picture's
  /// columns, y up its rows, z outwards, each from [−1, 1] to [0, 1].
  TextureRef normal_texture;
  float normal_scale = 1;  ///< of x and y

  bool emissive() const { return max_component(emission) > 0; }
};

/// Where a normal map's x points, at a vertex.
struct Tangent {
  Vec3 direction;  ///< of any length
  float sign = 1;  ///< y is this times normal × tangent
};

/// Triangles of one material, in their own frame.
struct Mesh {
  std::string name;
  std::vector<Vec3> positions;
  std::vector<std::array<uint32_t, 3>> triangles;  ///< counter-clockwise seen from the front
  std::array<std::vector<Vec2>, kUvSets> uvs;      ///< each empty or one a vertex
  std::vector<Rgb> colors;                         ///< COLOR_0, linear; empty or one a vertex
  /// What a normal map bends, and along which directions: empty, or one a vertex. Without, the
  /// geometric normal and the UV's directions. Meshes without a normal map have none.
  std::vector<Vec3> normals;
  std::vector<Tangent> tangents;
  int material = 0;  ///< index into Scene::materials; always valid
};

/// A mesh placed in the world. A mirroring transform flips the winding, so that front stays front.
struct Instance {
  int mesh = 0;
  Affine to_world;
  int light_group = kNone;  ///< group of its emission, kNone if it does not emit
};

enum class LightKind { Point, Spot, Directional };

/// KHR_lights_punctual: intensity in W/sr (directional: W/m²), no photometric factor.
struct PunctualLight {
  std::string name;
  LightKind kind = LightKind::Point;
  Vec3 position;
  Vec3 direction{0, 0, -1};  ///< unit, the way light travels; spot and directional
  Rgb intensity;
  /// Metres, as the extension's windowing has it.
  float range = std::numeric_limits<float>::infinity();
  float inner_cone = 0, outer_cone = 0.785398163f;  ///< radians, spot only
  int light_group = kNone;
};

/// A perspective camera. Pixel (0, 0) is the top left; the image plane spans vfov vertically.
struct Camera {
  std::string name;
  Vec3 origin, target{0, 0, -1}, up{0, 1, 0};
  float vfov = 45;        ///< degrees
  bool mirrored = false;  ///< left and right change places, as for a camera of a left-handed frame

  /// Unit direction through the image point (x, y) in [0, 1]², (0, 0) top left.
  Vec3 direction(float x, float y, float aspect) const;
};

struct Scene {
  std::string name;  ///< of the file, without folder and extension
  /// What a unit of length is taken to be, and on whose word.
  std::string unit = "metre";
  std::vector<Mesh> meshes;
  std::vector<Instance> instances;
  std::vector<Material> materials;  ///< never empty: entry 0 may be the default
  std::vector<std::shared_ptr<const Texture>> textures;
  std::vector<PunctualLight> lights;
  std::optional<Environment> environment;
  std::vector<Camera> cameras;
  /// One a luminaire: an emissive instance, a punctual light or the environment. Names for people.
  std::vector<std::string> light_groups;
  /// What the importer met and does not understand, e.g. "extension KHR_materials_sheen (3
  /// materials)".
  std::vector<std::string> ignored;

  int64_t triangle_count() const;  ///< instanced
  Bounds bounds() const;           ///< world, of all instanced vertices
};

}  // namespace lte::scene
