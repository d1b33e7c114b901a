// What a PBRT scene defines, before materials and textures are followed.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lte/image/image.h"
#include "lte/scene/pbrt/files.h"
#include "lte/scene/pbrt/params.h"
#include "lte/scene/pbrt/transform.h"
#include "lte/scene/scene.h"

namespace lte::scene::pbrt {

/// A Material, or a MakeNamedMaterial; a name that was used before it was made has no params yet.
struct MaterialDef {
  std::string name;  ///< of a named one; else its type
  std::string type;
  Location at;  ///< of its definition; of its first use as long as there is none
  std::optional<Params> params;
};

struct TextureDef {
  std::string name;
  bool is_float = false;  ///< float and spectrum textures have names of their own
  std::string type;       ///< "imagemap", "scale", ...
  Params params;
};

/// A shape in its own frame. `mesh.material` is unset.
struct ShapeDef {
  Mesh mesh;
  int64_t parts = 1;  ///< pbrt makes one area light of each triangle, patch or quadric
  int material = 0;   ///< index into World::materials
  int area_light = kNone;
  Location at;
};

/// The infinite lights of a scene, as one: L(ω) = constant + picture(ω).
struct InfiniteLight {
  Rgb constant{0, 0, 0};
  std::optional<image::Image> picture;  ///< radiance, "scale" and "illuminance" included
  SphereMapping mapping = SphereMapping::EqualArea;
  std::array<Vec3, 3> axes{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  ///< of the picture, in the world
};

/// A shape, or an object of several, in the world.
struct Placement {
  int shape = kNone;
  std::string object;  ///< name, if `shape` is kNone
  Transform to_world;
  Location at;
};

struct World {
  std::vector<MaterialDef> materials;
  std::map<std::string, int> named_materials;
  std::vector<TextureDef> textures;
  std::vector<Params> area_lights;
  std::vector<ShapeDef> shapes;
  std::vector<Placement> placements;
  std::map<std::string, std::vector<Placement>> objects;
  std::vector<PunctualLight> lights;
  std::optional<InfiniteLight> infinite;
  std::optional<Camera> camera;
  IgnoredFeatures ignored;
};

/// The mesh of a Shape directive in its own frame, wound so that the front is where pbrt's normal
/// points. `reverse` is the state of ReverseOrientation.
struct BuiltShape {
  Mesh mesh;  ///< without triangles if lte has no such shape (recorded)
  int64_t parts = 1;
};
BuiltShape build_shape(const std::string& type, const Params& params, bool reverse,
                       const Files& files, IgnoredFeatures* ignored);

/// Records what a Shape directive says and build_shape() does not read.
void ignore_left_out(const Params& params, IgnoredFeatures* ignored);

/// Quadrics as meshes whose vertices lie on them; see kChordError.
Mesh make_sphere(const Params& params);
Mesh make_cylinder(const Params& params);
Mesh make_disk(const Params& params);

/// Largest distance between a full circle and its polygon, over the radius.
inline constexpr double kChordError = 1e-3;

/// A LightSource, which lte may not have (recorded). Light groups are numbered later.
std::optional<PunctualLight> build_light(const std::string& type, const Params& params,
                                         const Transform& to_world, const Files& files,
                                         IgnoredFeatures* ignored);

/// The color of "I" or "L" of a light (white where it is left out) times its "scale".
Rgb light_color(const Params& params, const std::string& name, const Files& files,
                IgnoredFeatures* ignored);

/// Adds a LightSource "infinite" to those before. A second picture cannot be added (recorded).
void add_infinite_light(const Params& params, const Transform& to_world, const Files& files,
                        IgnoredFeatures* ignored, std::optional<InfiniteLight>* lights);
/// The environment that they make, without a light group.
Environment to_environment(InfiniteLight light);

/// The camera of the Camera and Film directives (either may be missing).
/// @param world_to_camera  current transform at the Camera directive
std::optional<Camera> build_camera(const std::string& type, const Params& params,
                                   const Transform& world_to_camera, const Params* film,
                                   IgnoredFeatures* ignored);

/// Records every parameter of the directive that nothing asked for.
void ignore_unused(const Params& params, IgnoredFeatures* ignored);

}  // namespace lte::scene::pbrt
