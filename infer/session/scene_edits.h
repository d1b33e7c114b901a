// What a session may change about a scene, apart from the meshes and textures, which it never does:
// small enough that every step of undo keeps one.
//
// It has each luminaire as bright as in its file. Gains and colors are factors beside it, so
// that light by luminaire, which is linear, is found once.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "infer/session/edit.h"
#include "infer/session/session.h"
#include "lte/scene/scene.h"

namespace lte::infer {

/// A mesh of the scene that the session began with, under a material of its own: luminaires that
/// share a mesh in the file are dimmed one by one.
struct MeshUse {
  int base = 0;      ///< index into the meshes of the first scene
  int material = 0;  ///< index into SceneEdits::materials
  friend bool operator==(const MeshUse&, const MeshUse&) = default;
};

/// A number of the session and the name that goes with it.
struct Label {
  int id = scene::kNone;
  std::string name;
};

/// A luminaire: an entry a light group.
struct LightSetting {
  Label label;
  double gain = 1;
  std::optional<Rgb> color = {};  ///< largest component 1; that of the file without
  bool touched = false;           ///< encoded apart
  float brightness = 0;           ///< largest component of its emission at gain 1
  /// Its color at gain 1, if all its parts have the same; nothing otherwise.
  std::optional<Rgb> tint = {};

  /// By channel, over its emission at gain 1. @note `color` goes with a `tint` without zeros.
  Rgb scale() const;
};

struct SceneEdits {
  std::vector<scene::Instance> instances;  ///< of `meshes`
  std::vector<Label> instance_labels;      ///< an entry an instance
  std::vector<MeshUse> meshes;
  std::vector<scene::Material> materials;
  std::vector<Label> material_labels;  ///< copies of a material share their label
  std::vector<scene::PunctualLight> lights;
  std::optional<scene::Environment> environment;
  std::vector<LightSetting> settings;          ///< by light group
  size_t base_meshes = 0, base_materials = 0;  ///< the first ones, which always stay
};

/// The next numbers of a session; they only grow.
struct NextIds {
  int instance = 0, light = 0, material = 0;
};

/// Luminaires that share a mesh or a material get one of their own.
SceneEdits make_edits(const scene::Scene& scene, NextIds* ids);

/// The scene as edited. @param base  has the meshes, textures and cameras
/// @param lit  with gains and colors; otherwise each luminaire as its file has it
scene::Scene make_scene(const scene::Scene& base, const SceneEdits& edits, bool lit);

/// Makes an edit; adds the numbers of what is new to the report.
/// @throws lte::Error naming what does not exist or is out of range; `edits` is then half edited
void apply_edit(const Edit& edit, SceneEdits* edits, NextIds* ids, EditReport* report);

/// Whether surfaces are the same and in the same places, under whatever color.
bool same_geometry(const SceneEdits& a, const SceneEdits& b);
/// Whether, in addition, colors and unscaled light are the same: what scene points depend on.
bool same_points(const SceneEdits& a, const SceneEdits& b);

/// Whether gains and colors of luminaires are the same, too: everything that one sees.
bool same_scene(const SceneEdits& a, const SceneEdits& b);

/// Where surfaces are gone or new, world, if nothing but that and colors differs: no luminaire has
/// moved, come or gone, and no surface has become black or ceased to be.
std::optional<std::vector<Bounds>> changed_places(const scene::Scene& base,
                                                  const SceneEdits& before, const SceneEdits& now);

/// World bounds of an instance of a mesh.
Bounds placed_bounds(const scene::Mesh& mesh, const Affine& to_world);

/// The index of the entry of this number.
/// @param what  for the message @throws lte::Error if there is none
size_t index_of(const std::vector<Label>& labels, int id, const char* what);
size_t group_of(const SceneEdits& edits, int id);
/// The light group that shines by each material, kNone for those that do not.
std::vector<int> group_of_material(const SceneEdits& edits);

/// Finds brightness and tint of every luminaire anew.
void describe_lights(SceneEdits* edits);

/// `name`, or with "#2" and so on behind it where others have it.
std::string unused_name(const std::string& name, const std::vector<std::string>& taken);

}  // namespace lte::infer
