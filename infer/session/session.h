// A scene in memory that takes edits and answers pictures and points.
//
// What an edit needs is decided here:
// - A dimmed or recolored luminaire needs no encoding, as light is linear. The luminaire and the
//   others are encoded apart when it is first touched; from then on a gain by channel is all.
// - A new albedo leaves every point in its place; the light there and the encoding are made anew.
// - A moved, added or removed object leaves the meshes' trees as they are and builds that of the
//   instances; scene points, the light there and the encoding are made anew.
//
// Readers take a SessionState, which never changes: any number of threads may ask one at the same
// time, and an edit makes another. So a picture never sees half of an edit.
//
// The answers depend on the scene as edited, on which luminaires have been touched and on what the
// cameras see, not on the way there.
//
// Who cannot wait for an encoding takes less accurate light first (Accuracy) and has it refined.
//
// Light that does not reach what the cameras see (the sky outside a closed room) is no input of the
// network, which would let a little of it through walls. Which that is, is found anew for other
// cameras and after edits of anything but gains and colors; only where it is other light than
// before is the scene encoded anew.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "infer/renderer/renderer.h"
#include "infer/session/edit.h"
#include "lte/base/enum_names.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights/lights.h"
#include "lte/runtime/network.h"
#include "lte/runtime/points.h"
#include "lte/scene/scene.h"

namespace lte::infer {

struct SessionSettings {
  EmbedSettings embedding;  ///< of every encoding; `culled_lights` is not read
  /// How pictures get their indirect light. Gather takes over from Network in a scene with light
  /// that the network was not trained with. Path: no cache is kept.
  Method pictures = Method::Path;
  render::CacheSettings cache = {};         ///< of gather and network; the seed is the embedding's
  int undo_steps = 100;                     ///< that are kept
  std::vector<scene::Camera> cameras = {};  ///< as of Session::look_from()
};

/// How much of the edits a state's indirect light knows. Surfaces and direct light are those of the
/// scene as edited, whatever this is.
enum class Accuracy {
  Kept,    ///< what the network said before the last edits, at the surfaces of now
  Coarse,  ///< half the scene points, a quicker search for those in the light, one encoding of all
           ///< luminaires
  Full,    ///< all of it: what a fresh session says
};
constexpr EnumNames<Accuracy, 3> enum_names(Accuracy) {
  return {{{Accuracy::Kept, "kept"}, {Accuracy::Coarse, "draft"}, {Accuracy::Full, "full"}}};
}

/// What was redone for an edit, and the wall-clock milliseconds of it; 0 where nothing was.
struct EditReport {
  uint64_t version = 0;  ///< of the state that holds the edit
  double scene_ms = 0;   ///< the copy of the scene, and the list of its lights
  double bvh_ms = 0;     ///< the tree over the instances
  double points_ms = 0;  ///< scene points, and what light reaches
  double light_ms = 0;   ///< estimates of the light on them; light that gathered pictures read
  double encode_ms = 0;  ///< the network
  double total_ms = 0;
  int encodings = 0;         ///< how often the network encoded: once a layer
  int layers = 0;            ///< that answers are summed over: touched luminaires, and the others
  int64_t points_drawn = 0;  ///< scene points that were drawn anew
  bool bvh_rebuilt = false;
  Accuracy accuracy = Accuracy::Full;  ///< of the state
  /// Numbers that AddInstance and AddLight gave, in the order of the edits; kNone if there are none
  /// of the kind (a punctual light has no instance).
  std::vector<int> added_instances, added_lights;

  /// Adds what was redone next. What was added stays that of each report.
  EditReport& operator+=(const EditReport& next);
};

enum class LuminaireKind { Surface, Point, Spot, Directional, Environment };

/// A luminaire for people and programs.
struct LuminaireInfo {
  int id = scene::kNone;
  std::string name;  ///< unique
  LuminaireKind kind = LuminaireKind::Surface;
  double gain = 1;
  Rgb color;             ///< largest component 1; {1, 1, 1} for one whose parts differ in color
  float brightness = 0;  ///< largest component of what it emits at gain 1, in its unit
  Vec3 position;         ///< middle of its bounds; zero for a sun or an environment
  Vec3 direction;        ///< of a spot or sun; zero for others
  std::vector<int> instances;  ///< that shine as it
  bool touched = false;        ///< encoded apart from the others
};

struct InstanceInfo {
  int id = scene::kNone;
  std::string name;  ///< unique: the luminaire's or mesh's, "#2" and so on behind repeated ones
  int material = scene::kNone;
  int light = scene::kNone;  ///< luminaire, kNone for one that does not shine
  Affine to_world;
  Bounds bounds;  ///< world
};

struct MaterialInfo {
  int id = scene::kNone;
  std::string name;  ///< unique
  Rgb base_color;    ///< the factor beside the texture
  bool textured = false, emissive = false;
};

/// What the ray through a point of a picture meets.
struct Pick {
  int instance = scene::kNone, material = scene::kNone, light = scene::kNone;
  Vec3 position, normal;  ///< world; the normal faces the camera
  Rgb albedo;
  float distance = 0;
};

/// The scene at one moment. Immutable; thread-safe.
class SessionState {
 public:
  ~SessionState();
  SessionState(const SessionState&) = delete;
  SessionState& operator=(const SessionState&) = delete;

  /// Grows with every edit, undo and redo of its session. States of equal numbers answer the same.
  uint64_t version() const;
  Accuracy accuracy() const;
  /// The scene as edited, gains and colors included. Its indices are not the session's numbers.
  const scene::Scene& scene() const;
  const pathtrace::Bvh& bvh() const;
  const pathtrace::Lights& lights() const;
  bool has_light() const;
  /// Whether the network answers for indirect light: there is one, and it knows such light.
  bool has_network() const;
  /// Who answers for indirect light in pictures; nothing: paths do.
  std::optional<Method> answered_by() const;

  /// Light groups of scene() that the network does not read, in order: those that did not reach
  /// what the cameras see when light was last found.
  std::vector<int> culled_lights() const;

  std::vector<LuminaireInfo> luminaires() const;
  std::vector<InstanceInfo> instances() const;
  std::vector<MaterialInfo> materials() const;

  /// Numbers of what goes by a name.
  /// @throws lte::Error with the nearest names if there is none, or several
  int find_luminaire(const std::string& name) const;
  int find_instance(const std::string& name) const;
  int find_material(const std::string& name) const;

  /// A picture, as Renderer::render() gives it; `method` of the settings is set here, as
  /// answered_by() has it, but for Method::Path, which stays.
  /// @param seconds  set to the times of its stages; may be null
  Frame render(const scene::Camera& camera, RenderSettings settings,
               StageSeconds* seconds = nullptr) const;

  /// Indirect irradiance in W/m² as the network says it, an entry a query; total irradiance for a
  /// network that predicts that.
  /// @throws lte::Error without a network, and as SceneEmbedding::decode()
  std::vector<Rgb> irradiance(const runtime::QueryPoints& queries) const;

  /// What lies under the image point (x, y) in [0, 1]², (0, 0) top left; nothing for background.
  std::optional<Pick> pick(const scene::Camera& camera, float x, float y, float aspect) const;

  /// The scene as edited as a .glb (lte/scene/export.h).
  void write_glb(const std::filesystem::path& path) const;

  struct Parts;  ///< infer/session/state.h
  /// For what belongs to sessions.
  const Parts& parts() const { return *parts_; }

 private:
  friend class Session;
  explicit SessionState(std::unique_ptr<const Parts> parts);
  std::unique_ptr<const Parts> parts_;
};

using StatePtr = std::shared_ptr<const SessionState>;

/// Owns the state of now and the way back. Thread-safe: edits wait for one another, readers for
/// nothing.
class Session {
 public:
  /// Prepares the scene and encodes it.
  /// @param network  none for a session that answers by paths alone
  /// @throws as Renderer::embed()
  Session(scene::Scene scene, std::optional<runtime::Network> network,
          const SessionSettings& settings = {});
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// The state of now.
  StatePtr state() const;
  /// The work that making the first state took.
  const EditReport& first_report() const;

  /// Makes edits as one step: all of them or, where one is refused, none.
  ///
  /// @param merge  the step goes on with the one before, as while a slider is dragged: one undo()
  ///               takes both back
  /// @param least  what the state is to have. It is more accurate where that costs no points and no
  ///               encoding, and where there is nothing to keep.
  /// @throws lte::Error naming the number that does not exist, or the value that is out of range
  EditReport apply(std::span<const Edit> edits, bool merge = false,
                   Accuracy least = Accuracy::Full);
  EditReport apply(const Edit& edit, bool merge = false, Accuracy least = Accuracy::Full);

  /// Takes the last step back, or makes it again. Nothing where there is none.
  std::optional<EditReport> undo(Accuracy least = Accuracy::Full);
  std::optional<EditReport> redo(Accuracy least = Accuracy::Full);
  bool can_undo() const;
  bool can_redo() const;
  /// Takes all edits back, as one step. Nothing where the scene is as it began.
  std::optional<EditReport> reset(Accuracy least = Accuracy::Full);
  /// Whether an instance is in the scene of now, or comes back by undo(), redo() or reset().
  bool remembers(int instance) const;

  /// Called now and then by any thread; true ends what is under way, and nothing has changed.
  using Stop = std::function<bool()>;

  /// Makes the light of now more accurate: `to` at least. No step of undo().
  /// @return  nothing if it is so already, or `stop` has ended it
  std::optional<EditReport> refine(Accuracy to = Accuracy::Full, const Stop& stop = {});

  /// From now on answers are asked for where these cameras see surfaces; none: anywhere. Where
  /// points are pruned, light that does not get there is left out. No step of undo().
  /// @return  nothing if the input of the network has not changed, and no answer with it, or
  ///          `stop` has ended it
  std::optional<EditReport> look_from(std::vector<scene::Camera> cameras,
                                      Accuracy least = Accuracy::Full, const Stop& stop = {});

  /// Encodes luminaires apart before they are dimmed, so that the first dimming takes no longer
  /// than the next: all that are lit, if `lights` is empty. No step of undo().
  /// @return  nothing if `stop` has ended it
  std::optional<EditReport> separate(std::span<const int> lights = {}, const Stop& stop = {});

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lte::infer
