// The state machine of PBRT scene files: transforms, attribute blocks, objects.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "lte/scene/pbrt/parser.h"
#include "lte/scene/pbrt/world.h"

namespace lte::scene::pbrt {

/// Collects a World from directives in the order of the file.
class Builder {
 public:
  explicit Builder(Files* files);

  /// nullptr for a directive that PBRT does not have.
  static const Syntax* syntax(const std::string& directive);
  /// @throws lte::Error with file and line.
  void execute(Call&& call);
  /// @param scene  name of the scene's file, for what is missing at its end
  World finish(const std::string& scene);

 private:
  using Defaults = std::vector<std::shared_ptr<const ParameterList>>;

  struct State {
    std::array<Transform, 2> transform;  ///< at the start and the end of the shutter
    std::array<bool, 2> active{true, true};
    bool reverse_orientation = false;
    int material = 0;
    int area_light = kNone;
    std::map<std::string, Defaults> defaults;  ///< of Attribute, by target
  };
  enum class Block { Attribute, Transform, Object };
  struct Saved {
    Block block;
    State state;
    Location at;
  };
  struct Entry {
    Syntax syntax;
    void (Builder::*handle)(Call& call);
  };
  static const std::map<std::string, Entry>& directives();

  void ignore(Call& call);
  void ignore_and_record(Call& call);
  void color_space(Call& call);
  void identity(Call& call);
  void translate(Call& call);
  void scale(Call& call);
  void rotate(Call& call);
  void look_at(Call& call);
  void set_transform(Call& call);
  void concat_transform(Call& call);
  void coordinate_system(Call& call);
  void coord_sys_transform(Call& call);
  void active_transform(Call& call);
  void reverse_orientation(Call& call);
  void block_begin(Call& call);
  void block_end(Call& call);
  void object_begin(Call& call);
  void object_end(Call& call);
  void object_instance(Call& call);
  void attribute(Call& call);
  void camera(Call& call);
  void film(Call& call);
  void world_begin(Call& call);
  void texture(Call& call);
  void material(Call& call);
  void make_named_material(Call& call);
  void named_material(Call& call);
  void area_light_source(Call& call);
  void light_source(Call& call);
  void shape(Call& call);

  void apply(const Transform& next);
  void set_active(const Transform& value);
  const Transform& current(const Location& at);
  Params params(Call& call, const char* target);
  void need_world(const Call& call) const;
  void need_options(const Call& call) const;
  void push(Block block, const Call& call);
  void pop(Block block, const Call& call);
  int material_number(const std::string& name, const Location& at);

  Files* files_;
  const LoadLimits& limits_;
  World world_;
  State state_;
  std::vector<Saved> stack_;
  std::map<std::string, std::array<Transform, 2>> named_transforms_;
  bool in_world_ = false;
  std::optional<std::string> object_;  ///< the one that is being defined
  std::vector<Placement> object_parts_;
  std::set<std::pair<bool, std::string>> texture_names_;  ///< is_float, name
  std::map<std::string, int> quadrics_;                   ///< equal ones are stored once
  int64_t triangles_ = 0;

  struct CameraCall {
    std::string type;
    Params params;
    Transform world_to_camera;
  };
  std::optional<CameraCall> camera_;
  std::optional<Params> film_;
};

}  // namespace lte::scene::pbrt
