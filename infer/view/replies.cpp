#include "infer/view/replies.h"

#include <nlohmann/json.hpp>

#include "infer/check/check_report.h"

namespace lte::infer::view {
namespace {

using nlohmann::json;

json vector_json(const Vec3& v) { return {v.x, v.y, v.z}; }

json camera_json(const scene::Camera& camera) {
  return {{"name", camera.name},
          {"origin", vector_json(camera.origin)},
          {"target", vector_json(camera.target)},
          {"up", vector_json(camera.up)},
          {"vfov", camera.vfov},
          {"mirrored", camera.mirrored}};
}

json edit_json(const PageEdit& edit) {
  if (const auto* light = std::get_if<LightSetting>(&edit)) {
    json out = {{"kind", "light"},
                {"light", light->light},
                {"gain", light->gain},
                {"color", vector_json(light->color)}};
    if (light->position) out["position"] = vector_json(*light->position);
    if (light->direction) out["direction"] = vector_json(*light->direction);
    return out;
  }
  if (const auto* material = std::get_if<MaterialSetting>(&edit)) {
    return {{"kind", "material"},
            {"material", material->material},
            {"albedo", vector_json(material->albedo)}};
  }
  const auto& object = std::get<ObjectSetting>(edit);
  return {{"kind", "object"},
          {"object", object.object},
          {"move", vector_json(object.placement.move)},
          {"turn", object.placement.turn},
          {"scale", object.placement.scale}};
}

json cost_json(const EditCost& cost) {
  return {{"ms", cost.milliseconds},
          {"total", cost.total_ms},
          {"encodings", cost.encodings},
          {"accuracy", enum_name(cost.accuracy)}};
}

/// Names of a file may be any bytes.
std::string text_of(const json& value) {
  return value.dump(-1, ' ', false, json::error_handler_t::replace);
}

std::string frame_of(const json& header, const std::string& bytes) {
  const std::string text = text_of(header);
  std::string out;
  for (int byte = 0; byte < 4; ++byte) out += static_cast<char>(text.size() >> (8 * byte) & 0xff);
  return out + text + bytes;
}

json line_json(const char* type, const std::string& line) {
  return {{"type", type}, {"message", line}};
}

}  // namespace

std::string welcome_reply(int client, const std::string& phase) {
  return text_of(
      {{"type", "welcome"}, {"protocol", kProtocol}, {"client", client}, {"phase", phase}});
}

std::string scene_reply(const SceneDescription& scene, const std::vector<PageEdit>& settings,
                        const UndoSteps& undo) {
  json out = {{"type", "scene"},
              {"name", scene.name},
              {"low", vector_json(scene.bounds.low)},
              {"high", vector_json(scene.bounds.high)},
              {"lights", json::array()},
              {"materials", json::array()},
              {"objects", json::array()},
              {"cameras", json::array()},
              {"outputs", json::array()},
              {"undo", undo.back},
              {"redo", undo.forth}};
  for (const PageEdit& setting : settings) {
    json entry = edit_json(setting);
    if (const auto* light = std::get_if<LightSetting>(&setting)) {
      const LightDescription& described = *find_entry(scene.lights, light->light);
      entry.update({{"name", described.name}, {"sort", described.sort}});
      out["lights"].push_back(entry);
    } else if (const auto* material = std::get_if<MaterialSetting>(&setting)) {
      const MaterialDescription& described = *find_entry(scene.materials, material->material);
      entry.update({{"name", described.name},
                    {"textured", described.textured},
                    {"emissive", described.emissive}});
      out["materials"].push_back(entry);
    } else {
      const int number = std::get<ObjectSetting>(setting).object;
      const ObjectDescription& described = *find_entry(scene.objects, number);
      entry.update({{"name", described.name},
                    {"low", vector_json(described.bounds.low)},
                    {"high", vector_json(described.bounds.high)},
                    {"shines", described.shines}});
      out["objects"].push_back(entry);
    }
  }
  for (const scene::Camera& camera : scene.cameras) out["cameras"].push_back(camera_json(camera));
  for (const Shown shown : scene.outputs) out["outputs"].push_back(enum_name(shown));
  return text_of(out);
}

std::string edits_reply(int client, const std::vector<PageEdit>& edits, const EditCost& cost,
                        const UndoSteps& undo) {
  json out = {{"type", "edits"},         {"client", client},  {"edits", json::array()},
              {"cost", cost_json(cost)}, {"undo", undo.back}, {"redo", undo.forth}};
  for (const PageEdit& edit : edits) out["edits"].push_back(edit_json(edit));
  return text_of(out);
}

std::string picked_reply(const Picked& picked) {
  return text_of({{"type", "picked"},
                  {"x", picked.x},
                  {"y", picked.y},
                  {"object", picked.object},
                  {"material", picked.material},
                  {"light", picked.light},
                  {"position", vector_json(picked.position)},
                  {"normal", vector_json(picked.normal)}});
}

std::string added_reply(const Added& added) {
  return text_of({{"type", "added"}, {"object", added.object}, {"light", added.light}});
}

std::string error_reply(const std::string& line) { return text_of(line_json("error", line)); }

std::string failed_reply(const std::string& line) { return text_of(line_json("failed", line)); }

namespace {

/// Nothing before the check, and where nothing was compared.
json check_json_of(const PictureHeader& header) {
  if (!header.check || header.check->regions.empty()) return nullptr;
  const std::string who = header.answered_by == "gather" ? "the gathered" : "the network's";
  json out = check_json(*header.check);
  out["note"] = check_note(*header.check, who, "the picture");
  return out;
}

}  // namespace

std::string picture_frame(const PictureHeader& header, const std::string& jpeg) {
  json handled = json::object();
  for (const auto& [client, numbers] : header.handled)
    handled[std::to_string(client)] = {numbers.view, numbers.edits};
  return frame_of({{"type", "picture"},
                   {"picture", header.picture},
                   {"camera", camera_json(header.camera)},
                   {"shown", enum_name(header.shown)},
                   {"ev", header.ev},
                   {"curve", enum_name(header.curve)},
                   {"size", {header.size.width, header.size.height}},
                   {"width", header.width},
                   {"height", header.height},
                   {"pass", header.pass},
                   {"passes", header.passes},
                   {"done", header.done},
                   {"light", enum_name(header.light)},
                   {"answered_by", header.answered_by},
                   {"check", check_json_of(header)},
                   {"paths", header.paths},
                   {"elapsed", header.elapsed_ms},
                   {"path", header.path_ms},
                   {"ms", header.milliseconds},
                   {"handled", handled}},
                  jpeg);
}

std::string file_frame(const std::string& name, const std::string& media_type,
                       const std::string& bytes) {
  return frame_of({{"type", "file"}, {"name", name}, {"media", media_type}}, bytes);
}

}  // namespace lte::infer::view
