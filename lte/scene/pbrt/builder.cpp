#include "lte/scene/pbrt/builder.h"

#include <utility>

namespace lte::scene::pbrt {
const std::map<std::string, Builder::Entry>& Builder::directives() {
  const Syntax none{}, name{.strings = 1}, list{.params = true},
      name_list{.strings = 1, .params = true};
  static const std::map<std::string, Entry> table{
      {"Identity", {none, &Builder::identity}},
      {"Translate", {{.numbers = 3}, &Builder::translate}},
      {"Scale", {{.numbers = 3}, &Builder::scale}},
      {"Rotate", {{.numbers = 4}, &Builder::rotate}},
      {"LookAt", {{.numbers = 9}, &Builder::look_at}},
      {"Transform", {{.numbers = 16}, &Builder::set_transform}},
      {"ConcatTransform", {{.numbers = 16}, &Builder::concat_transform}},
      {"CoordinateSystem", {name, &Builder::coordinate_system}},
      {"CoordSysTransform", {name, &Builder::coord_sys_transform}},
      {"ActiveTransform", {{.word = true}, &Builder::active_transform}},
      {"TransformTimes", {{.numbers = 2}, &Builder::ignore}},
      {"ReverseOrientation", {none, &Builder::reverse_orientation}},
      {"AttributeBegin", {none, &Builder::block_begin}},
      {"AttributeEnd", {none, &Builder::block_end}},
      {"TransformBegin", {none, &Builder::block_begin}},
      {"TransformEnd", {none, &Builder::block_end}},
      {"Attribute", {name_list, &Builder::attribute}},
      {"ObjectBegin", {name, &Builder::object_begin}},
      {"ObjectEnd", {none, &Builder::object_end}},
      {"ObjectInstance", {name, &Builder::object_instance}},
      {"Camera", {name_list, &Builder::camera}},
      {"Film", {name_list, &Builder::film}},
      {"WorldBegin", {none, &Builder::world_begin}},
      {"WorldEnd", {none, &Builder::ignore_and_record}},  // pbrt-v3
      {"Texture", {{.strings = 3, .params = true}, &Builder::texture}},
      {"Material", {name_list, &Builder::material}},
      {"MakeNamedMaterial", {name_list, &Builder::make_named_material}},
      {"NamedMaterial", {name, &Builder::named_material}},
      {"AreaLightSource", {name_list, &Builder::area_light_source}},
      {"LightSource", {name_list, &Builder::light_source}},
      {"Shape", {name_list, &Builder::shape}},
      {"ColorSpace", {name, &Builder::color_space}},
      {"MakeNamedMedium", {name_list, &Builder::ignore_and_record}},
      {"MediumInterface", {{.strings = 1, .optional_strings = 1}, &Builder::ignore_and_record}},
      // How pbrt renders, which is no part of a scene.
      {"Option", {list, &Builder::ignore}},
      {"Sampler", {name_list, &Builder::ignore}},
      {"Integrator", {name_list, &Builder::ignore}},
      {"PixelFilter", {name_list, &Builder::ignore}},
      {"Accelerator", {name_list, &Builder::ignore}},
      {"SurfaceIntegrator", {name_list, &Builder::ignore}},  // pbrt-v2
      {"VolumeIntegrator", {name_list, &Builder::ignore}},
      {"Renderer", {name_list, &Builder::ignore}}};
  return table;
}

Builder::Builder(Files* files) : files_(files), limits_(files->limits()) {
  // What shapes have before the first Material.
  MaterialDef standard{"default", "diffuse", {}, Params("Material \"diffuse\"", {}, {})};
  world_.materials.push_back(std::move(standard));
}

const Syntax* Builder::syntax(const std::string& directive) {
  const auto found = directives().find(directive);
  return found == directives().end() ? nullptr : &found->second.syntax;
}

void Builder::execute(Call&& call) { (this->*directives().at(call.directive).handle)(call); }

World Builder::finish(const std::string& scene) {
  LTE_CHECK(stack_.empty(), stack_.back().at, ": ",
            stack_.back().block == Block::Object      ? "ObjectBegin"
            : stack_.back().block == Block::Transform ? "TransformBegin"
                                                      : "AttributeBegin",
            " is never ended");
  LTE_CHECK(in_world_, scene, ": the file has no WorldBegin");
  if (camera_) {
    world_.camera = build_camera(camera_->type, camera_->params, camera_->world_to_camera,
                                 film_ ? &*film_ : nullptr, &world_.ignored);
  }
  return std::move(world_);
}

void Builder::ignore(Call& /*call*/) {}

void Builder::ignore_and_record(Call& call) {
  const bool named = call.directive == "MakeNamedMedium";
  world_.ignored.add(named ? concat(call.directive, " ", quote(call.strings[0])) : call.directive,
                     call.at);
}

void Builder::color_space(Call& call) {
  if (call.strings[0] != "srgb")
    world_.ignored.add("ColorSpace " + quote(call.strings[0]) + ": sRGB taken", call.at);
}

void Builder::need_world(const Call& call) const {
  if (!in_world_) fail(call.at, call.directive, " stands before WorldBegin");
}

void Builder::need_options(const Call& call) const {
  if (in_world_) fail(call.at, call.directive, " stands behind WorldBegin");
}

/// The parameters of a directive, with the defaults that Attribute gave to `target` behind them.
Params Builder::params(Call& call, const char* target) {
  const auto found = state_.defaults.find(target);
  std::string what = call.directive;
  if (!call.strings.empty()) what = concat(what, " ", quote(call.strings.back()));
  return {std::move(what), call.at, std::move(call.params),
          found == state_.defaults.end() ? Defaults{} : found->second};
}

// Transforms.

void Builder::apply(const Transform& next) {
  for (size_t i = 0; i < 2; ++i) {
    if (state_.active[i]) state_.transform[i] = state_.transform[i] * next;
  }
}

void Builder::set_active(const Transform& value) {
  for (size_t i = 0; i < 2; ++i) {
    if (state_.active[i]) state_.transform[i] = value;
  }
}

/// The transform at the start of the shutter; motion is left out.
const Transform& Builder::current(const Location& at) {
  if (!(state_.transform[0] == state_.transform[1]))
    world_.ignored.add("animated transform: its start is taken", at);
  return state_.transform[0];
}

void Builder::identity(Call& /*call*/) { set_active({}); }

void Builder::translate(Call& call) {
  apply(pbrt::translate(call.numbers[0], call.numbers[1], call.numbers[2]));
}

void Builder::scale(Call& call) {
  apply(pbrt::scale(call.numbers[0], call.numbers[1], call.numbers[2]));
}

void Builder::rotate(Call& call) {
  apply(pbrt::rotate(call.numbers[0], call.numbers[1], call.numbers[2], call.numbers[3]));
}

void Builder::look_at(Call& call) { apply(pbrt::look_at(call.numbers, call.at)); }

void Builder::set_transform(Call& call) { set_active(from_columns(call.numbers)); }

void Builder::concat_transform(Call& call) { apply(from_columns(call.numbers)); }

void Builder::coordinate_system(Call& call) {
  named_transforms_[call.strings[0]] = state_.transform;
}

void Builder::coord_sys_transform(Call& call) {
  const auto found = named_transforms_.find(call.strings[0]);
  if (found != named_transforms_.end()) {
    state_.transform = found->second;
  } else {  // pbrt warns, too, and goes on
    world_.ignored.add("CoordSysTransform: no coordinate system " + quote(call.strings[0]),
                       call.at);
  }
}

void Builder::active_transform(Call& call) {
  const std::string& which = call.strings[0];
  if (which != "StartTime" && which != "EndTime" && which != "All")
    fail(call.at, "ActiveTransform: expected StartTime, EndTime or All, got ", quote(which));
  state_.active = {which != "EndTime", which != "StartTime"};
}

void Builder::reverse_orientation(Call& call) {
  need_world(call);
  state_.reverse_orientation = !state_.reverse_orientation;
}

// Blocks and objects.

void Builder::push(Block block, const Call& call) {
  if (stack_.size() >= static_cast<size_t>(limits_.node_depth))
    fail(call.at, "blocks are nested deeper than ", limits_.node_depth, " levels");
  stack_.push_back({block, state_, call.at});
}

void Builder::pop(Block block, const Call& call) {
  if (stack_.empty()) fail(call.at, call.directive, " ends nothing");
  if (stack_.back().block != block)
    fail(call.at, call.directive, " ends another kind of block, begun at ", stack_.back().at);
  if (block == Block::Transform) {
    state_.transform = stack_.back().state.transform;  // v3: only they were saved
    state_.active = stack_.back().state.active;
  } else {
    state_ = std::move(stack_.back().state);
  }
  stack_.pop_back();
}

void Builder::block_begin(Call& call) {
  const bool transform = call.directive == "TransformBegin";
  if (!transform) need_world(call);
  push(transform ? Block::Transform : Block::Attribute, call);
}

void Builder::block_end(Call& call) {
  pop(call.directive == "TransformEnd" ? Block::Transform : Block::Attribute, call);
}

void Builder::object_begin(Call& call) {
  need_world(call);
  if (object_) fail(call.at, "ObjectBegin inside of the object ", quote(*object_));
  if (world_.objects.contains(call.strings[0]))
    fail(call.at, "the object ", quote(call.strings[0]), " is defined twice");
  push(Block::Object, call);
  object_ = call.strings[0];
}

void Builder::object_end(Call& call) {
  pop(Block::Object, call);
  world_.objects[*object_] = std::move(object_parts_);
  object_parts_.clear();
  object_.reset();
}

void Builder::object_instance(Call& call) {
  need_world(call);
  if (object_) fail(call.at, "ObjectInstance inside of the object ", quote(*object_));
  world_.placements.push_back({kNone, call.strings[0], current(call.at), call.at});
}

void Builder::attribute(Call& call) {
  const std::string& target = call.strings[0];
  for (const char* known : {"shape", "light", "material", "medium", "texture"}) {
    if (target != known) continue;
    state_.defaults[target].push_back(
        std::make_shared<const ParameterList>(std::move(call.params)));
    return;
  }
  fail(call.at, "Attribute of ", quote(target),
       ", expected shape, light, material, medium or texture");
}

}  // namespace lte::scene::pbrt
