// What each edit does to an edited scene, and what it refuses.
#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "infer/session/scene_edits.h"
#include "lte/base/check.h"
#include "lte/scene/inverse_transpose.h"
#include "lte/scene/number_check.h"

namespace lte::infer {
namespace {

using scene::kNone;

constexpr double kMaxGain = 1e6;

std::string text_of(const Vec3& v) { return concat(v.x, " ", v.y, " ", v.z); }

void check_transform(const Affine& to_world, const std::string& name) {
  for (const auto& row : to_world.m) {
    for (const float value : row)
      LTE_CHECK(std::isfinite(value), "instance ", name, ": its transform is not finite");
  }
  LTE_CHECK(scene::is_place(to_world.point({0, 0, 0})), "instance ", name,
            ": it would lie farther than ", scene::kMaxCoordinate, " from the origin");
  const double stretch = scene::inverse_stretch(to_world);
  LTE_CHECK(stretch <= 1 / scene::kMinScale, "instance ", name,
            ": its transform is singular: expected a scale of ", scene::kMinScale, " or more");
}

Vec3 unit_direction(const Vec3& direction, const std::string& name) {
  LTE_CHECK(is_finite(direction) && length(direction) > 0, "light ", name, ": direction ",
            text_of(direction), ": expected finite numbers that are not all 0");
  return normalize(direction);
}

void check_place(const Vec3& position, const std::string& name) {
  LTE_CHECK(scene::is_place(position), "light ", name, ": position ", text_of(position),
            ": expected finite numbers of at most ", scene::kMaxCoordinate);
}

void check_emission(const Rgb& emission, const std::string& what) {
  LTE_CHECK(scene::is_radiance(emission) && emission.x >= 0 && emission.y >= 0 && emission.z >= 0,
            what, ": ", text_of(emission), ": expected numbers from 0 to ", scene::kMaxRadiance);
}

/// Makes the edits of an edited scene.
class Editor {
 public:
  Editor(SceneEdits* edits, NextIds* ids, EditReport* report)
      : edits_(*edits), ids_(*ids), report_(*report) {}

  void operator()(const MoveInstance& edit) {
    const size_t at = index_of(edits_.instance_labels, edit.instance, "instance");
    check_transform(edit.to_world, edits_.instance_labels[at].name);
    edits_.instances[at].to_world = edit.to_world;
  }

  void operator()(const SetLight& edit) {
    const size_t group = group_of(edits_, edit.light);
    LightSetting& setting = edits_.settings[group];
    const std::string& name = setting.label.name;
    LTE_CHECK(setting.brightness > 0, "light ", name,
              ": it is black in the file, and stays so at any gain");
    if (edit.gain) {
      LTE_CHECK(*edit.gain >= 0 && *edit.gain <= kMaxGain, "light ", name, ": gain ", *edit.gain,
                ": expected a number from 0 to ", kMaxGain);
      setting.gain = *edit.gain;
    }
    if (edit.color) set_color(group, *edit.color);
    check_emission(Rgb{1, 1, 1} * (setting.brightness * static_cast<float>(setting.gain)),
                   concat("light ", name));
    setting.touched = true;
  }

  void operator()(const MoveLight& edit) {
    const size_t group = group_of(edits_, edit.light);
    const std::string& name = edits_.settings[group].label.name;
    const auto found = std::find_if(
        edits_.lights.begin(), edits_.lights.end(),
        [&](const scene::PunctualLight& l) { return l.light_group == static_cast<int>(group); });
    LTE_CHECK(found != edits_.lights.end(), "light ", name,
              ": it is a surface or the environment: move its instance instead");
    const bool sun = found->kind == scene::LightKind::Directional;
    LTE_CHECK(!edit.position || !sun, "light ", name, ": a sun has a direction and no position");
    LTE_CHECK(!edit.direction || found->kind != scene::LightKind::Point, "light ", name,
              ": a point light has a position and no direction");
    if (edit.position) check_place(*edit.position, name);
    if (edit.position) found->position = *edit.position;
    if (edit.direction) found->direction = unit_direction(*edit.direction, name);
  }

  void operator()(const SetMaterial& edit) {
    const size_t first = index_of(edits_.material_labels, edit.material, "material");
    const Rgb& c = edit.base_color;
    const auto within = [](float value) { return value >= 0 && value <= 1; };
    LTE_CHECK(within(c.x) && within(c.y) && within(c.z), "material ",
              edits_.material_labels[first].name, ": base color ", text_of(c),
              ": expected numbers from 0 to 1");
    for (size_t m = first; m < edits_.materials.size(); ++m) {
      if (edits_.material_labels[m].id == edit.material) edits_.materials[m].base_color = c;
    }
  }

  void operator()(const AddInstance& edit) {
    const size_t like = index_of(edits_.instance_labels, edit.like, "instance");
    const std::string name = unused_name(edits_.instance_labels[like].name, instance_names());
    check_transform(edit.to_world, name);
    scene::Instance instance = edits_.instances[like];
    instance.to_world = edit.to_world;
    int light = kNone;
    if (instance.light_group != kNone) light = copy_luminaire(&instance);
    edits_.instances.push_back(instance);
    edits_.instance_labels.push_back({ids_.instance++, name});
    report_.added_instances.push_back(edits_.instance_labels.back().id);
    report_.added_lights.push_back(light);
  }

  void operator()(const RemoveInstance& edit) {
    const size_t at = index_of(edits_.instance_labels, edit.instance, "instance");
    LTE_CHECK(edits_.instances.size() > 1, "the last instance of a scene cannot be removed");
    erase_instance(at);
    tidy();
  }

  void operator()(const AddLight& edit) {
    scene::PunctualLight light = edit.light;
    const std::string wanted =
        light.name.empty() ? concat("light ", edits_.settings.size() + 1) : light.name;
    light.name = unused_name(wanted, light_names());
    check_place(light.position, light.name);
    light.direction = unit_direction(light.direction, light.name);
    check_emission(light.intensity, concat("light ", light.name, ": intensity"));
    LTE_CHECK(light.range > 0, "light ", light.name, ": range ", light.range,
              ": expected a number above 0");
    LTE_CHECK(light.inner_cone >= 0 && light.inner_cone <= light.outer_cone &&
                  light.outer_cone <= kPi / 2 + 1e-6f,
              "light ", light.name, ": cones ", light.inner_cone, " and ", light.outer_cone,
              ": expected 0 to 90 degrees, the inner one no wider");
    light.light_group = add_group(light.name);
    edits_.lights.push_back(std::move(light));
    describe_lights(&edits_);
    report_.added_instances.push_back(kNone);
    report_.added_lights.push_back(edits_.settings.back().label.id);
  }

  void operator()(const RemoveLight& edit) {
    const int group = static_cast<int>(group_of(edits_, edit.light));
    std::erase_if(edits_.lights,
                  [&](const scene::PunctualLight& light) { return light.light_group == group; });
    if (edits_.environment && edits_.environment->light_group == group) edits_.environment.reset();
    for (size_t i = edits_.instances.size(); i-- > 0;) {
      if (edits_.instances[i].light_group == group) erase_instance(i);
    }
    LTE_CHECK(!edits_.instances.empty(), "the last instance of a scene cannot be removed");
    tidy();
  }

  void operator()(const SetEnvironment& edit) {
    if (!edit.environment) {
      edits_.environment.reset();
      return tidy();
    }
    scene::check_environment("environment", *edit.environment);
    const int group = edits_.environment ? edits_.environment->light_group
                                         : add_group(unused_name("environment", light_names()));
    edits_.environment = edit.environment;
    edits_.environment->light_group = group;
    LightSetting& setting = edits_.settings[static_cast<size_t>(group)];
    setting.gain = 1;
    setting.color.reset();
    describe_lights(&edits_);
  }

 private:
  void set_color(size_t group, const Rgb& color) {
    LightSetting& setting = edits_.settings[group];
    check_emission(color, concat("light ", setting.label.name, ": color"));
    const float peak = max_component(color);
    LTE_CHECK(peak > 0, "light ", setting.label.name,
              ": color 0 0 0: expected one of its numbers above 0; gain 0 switches a light off");
    const bool has_zero =
        !setting.tint || setting.tint->x <= 0 || setting.tint->y <= 0 || setting.tint->z <= 0;
    if (has_zero) make_white(static_cast<int>(group));
    setting.color = color / peak;
  }

  /// No factor brings a color to a channel that is dark: such a luminaire is white at gain 1 from
  /// now on, as bright as before.
  void make_white(int group) {
    const auto white = [](Rgb* emission) {
      const float peak = max_component(*emission);
      *emission = {peak, peak, peak};
    };
    const std::vector<int> groups = group_of_material(edits_);
    for (size_t m = 0; m < groups.size(); ++m) {
      if (groups[m] == group) white(&edits_.materials[m].emission);
    }
    for (scene::PunctualLight& light : edits_.lights) {
      if (light.light_group == group) white(&light.intensity);
    }
    if (edits_.environment && edits_.environment->light_group == group)
      white(&edits_.environment->radiance);
    describe_lights(&edits_);
  }

  int add_group(const std::string& name) {
    LightSetting setting;
    setting.label = {ids_.light++, name};
    edits_.settings.push_back(std::move(setting));
    return static_cast<int>(edits_.settings.size()) - 1;
  }

  /// A luminaire of its own for a copy of one: its mesh and material as well. Returns its number.
  int copy_luminaire(scene::Instance* instance) {
    const LightSetting like = edits_.settings[static_cast<size_t>(instance->light_group)];
    const MeshUse use = edits_.meshes[static_cast<size_t>(instance->mesh)];
    instance->light_group = add_group(unused_name(like.label.name, light_names()));
    LightSetting& setting = edits_.settings.back();
    setting.gain = like.gain;
    setting.color = like.color;
    setting.touched = like.gain != 1 || like.color.has_value();
    instance->mesh = static_cast<int>(edits_.meshes.size());
    edits_.meshes.push_back({use.base, static_cast<int>(edits_.materials.size())});
    edits_.materials.push_back(edits_.materials[static_cast<size_t>(use.material)]);
    edits_.material_labels.push_back(edits_.material_labels[static_cast<size_t>(use.material)]);
    setting.brightness = like.brightness;
    setting.tint = like.tint;
    return setting.label.id;
  }

  void erase_instance(size_t at) {
    edits_.instances.erase(edits_.instances.begin() + static_cast<ptrdiff_t>(at));
    edits_.instance_labels.erase(edits_.instance_labels.begin() + static_cast<ptrdiff_t>(at));
  }

  /// Drops luminaires without any part, and copies of meshes and materials that nothing uses.
  void tidy() {
    tidy_groups();
    const auto used_meshes = [&] {
      std::vector<bool> used(edits_.meshes.size());
      for (const scene::Instance& instance : edits_.instances)
        used[static_cast<size_t>(instance.mesh)] = true;
      return used;
    }();
    const std::vector<int> mesh = keep(used_meshes, edits_.base_meshes, &edits_.meshes);
    for (scene::Instance& instance : edits_.instances)
      instance.mesh = mesh[static_cast<size_t>(instance.mesh)];
    std::vector<bool> used(edits_.materials.size());
    for (const MeshUse& use : edits_.meshes) used[static_cast<size_t>(use.material)] = true;
    const std::vector<int> material = keep(used, edits_.base_materials, &edits_.materials);
    keep(used, edits_.base_materials, &edits_.material_labels);
    for (MeshUse& use : edits_.meshes) use.material = material[static_cast<size_t>(use.material)];
  }

  void tidy_groups() {
    std::vector<bool> used(edits_.settings.size());
    const auto each = [&](const auto& visit) {
      for (scene::Instance& instance : edits_.instances) visit(&instance.light_group);
      for (scene::PunctualLight& light : edits_.lights) visit(&light.light_group);
      if (edits_.environment) visit(&edits_.environment->light_group);
    };
    each([&](const int* group) {
      if (*group != kNone) used[static_cast<size_t>(*group)] = true;
    });
    const std::vector<int> number = keep(used, 0, &edits_.settings);
    each([&](int* group) {
      if (*group != kNone) *group = number[static_cast<size_t>(*group)];
    });
  }

  /// Keeps the first entries and those that are used. Returns the new index of each.
  template <typename T>
  static std::vector<int> keep(const std::vector<bool>& used, size_t first,
                               std::vector<T>* values) {
    std::vector<int> number(values->size(), kNone);
    std::vector<T> kept;
    for (size_t i = 0; i < values->size(); ++i) {
      if (i >= first && !used[i]) continue;
      number[i] = static_cast<int>(kept.size());
      kept.push_back(std::move((*values)[i]));
    }
    *values = std::move(kept);
    return number;
  }

  std::vector<std::string> light_names() const {
    std::vector<std::string> names;
    for (const LightSetting& setting : edits_.settings) names.push_back(setting.label.name);
    return names;
  }
  std::vector<std::string> instance_names() const {
    std::vector<std::string> names;
    for (const Label& label : edits_.instance_labels) names.push_back(label.name);
    return names;
  }

  SceneEdits& edits_;
  NextIds& ids_;
  EditReport& report_;
};

}  // namespace

void apply_edit(const Edit& edit, SceneEdits* edits, NextIds* ids, EditReport* report) {
  std::visit(Editor(edits, ids, report), edit);
}

}  // namespace lte::infer
