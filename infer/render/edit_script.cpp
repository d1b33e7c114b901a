#include "infer/render/edit_script.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "lte/base/check.h"
#include "lte/base/config.h"
#include "lte/base/config_tree.h"
#include "lte/base/file.h"
#include "lte/base/text.h"
#include "lte/base/to_number.h"

namespace lte::infer {
namespace {

constexpr size_t kMaxScriptBytes = size_t{16} << 20;
constexpr int kMaxFrames = 1'000'000;

struct PropertyRow {
  const char* key;
  const char* target;  ///< the key that names what it is of
  TrackProperty property;
  int numbers;
  double least, most;
};
constexpr double kAny = std::numeric_limits<float>::max();
constexpr std::array<PropertyRow, 8> kProperties = {
    {{"gain", "light", TrackProperty::Gain, 1, 0, 1e6},
     {"color", "light", TrackProperty::Color, 3, 0, 1e12},
     {"position", "light", TrackProperty::Position, 3, -1e9, 1e9},
     {"direction", "light", TrackProperty::Direction, 3, -kAny, kAny},
     {"move", "instance", TrackProperty::Move, 3, -1e9, 1e9},
     {"turn", "instance", TrackProperty::Turn, 1, -1e9, 1e9},
     {"scale", "instance", TrackProperty::Scale, 1, 1e-6, 1e6},
     {"base_color", "material", TrackProperty::BaseColor, 3, 0, 1}}};
constexpr std::array<const char*, 3> kTargets = {"light", "instance", "material"};

[[noreturn]] void refuse(const ConfigTree& at, const std::string& key, const std::string& message) {
  throw Error(concat(at.where, ": ", key, ": ", message));
}

double number_of(const ConfigTree& tree, const std::string& key) {
  const bool plain = tree.kind == ConfigTree::Kind::Scalar && !tree.quoted;
  const auto value = to_number<double>(without_plus(tree.text));
  if (!plain || !value || !std::isfinite(*value))
    refuse(tree, key, concat("expected a finite number, got ", shown(tree)));
  return *value;
}

int integer_of(const ConfigTree& tree, const std::string& key, int least, int most) {
  const double value = number_of(tree, key);
  if (value != std::floor(value) || value < least || value > most)
    refuse(tree, key,
           concat("expected a whole number from ", least, " to ", most, ", got ", shown(tree)));
  return static_cast<int>(value);
}

std::string text_of(const ConfigTree& tree, const std::string& key) {
  if (tree.kind != ConfigTree::Kind::Scalar || tree.text.empty())
    refuse(tree, key, concat("expected a name, got ", shown(tree)));
  return tree.text;
}

std::vector<double> numbers_of(const ConfigTree& tree, const std::string& key, int count,
                               double least = -kAny, double most = kAny) {
  std::vector<double> out;
  if (count == 1) {
    out.push_back(number_of(tree, key));
  } else {
    if (tree.kind != ConfigTree::Kind::List || tree.items.size() != static_cast<size_t>(count))
      refuse(tree, key, concat("expected ", count, " numbers in brackets, got ", shown(tree)));
    for (const ConfigTree& item : tree.items) out.push_back(number_of(item, key));
  }
  for (const double value : out) {
    if (value < least || value > most)
      refuse(tree, key, concat(value, ": expected from ", least, " to ", most));
  }
  return out;
}

Vec3 vector_of(const ConfigTree& tree, const std::string& key) {
  const std::vector<double> v = numbers_of(tree, key, 3);
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

/// Refuses keys that are none of `known`.
void check_keys(const ConfigTree& map, const std::vector<std::string>& known) {
  for (const auto& [key, value] : map.entries) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    const std::string near = nearest_name(key, known);
    std::string list;
    for (const std::string& each : known) list += concat(list.empty() ? "" : ", ", each);
    throw Error(concat(
        value.where, ": unknown key ", quote(key), "; ",
        near.empty() ? concat("expected ", list) : concat("did you mean ", quote(near), "?")));
  }
}

/// Reads the entries of `edits:`.
class ScriptReader {
 public:
  explicit ScriptReader(EditScript* script) : script_(*script) {}

  void read(const ConfigTree& entry) {
    if (entry.kind != ConfigTree::Kind::Map)
      refuse(entry, "edits",
             concat("expected a map such as {light: NAME, ...}, got ", shown(entry)));
    for (const char* target : kTargets) {
      if (const ConfigTree* name = entry.find(target))
        return read_tracks(entry, target, text_of(*name, target));
    }
    if (const ConfigTree* light = entry.find("add_light")) return add_light(entry, *light);
    if (const ConfigTree* like = entry.find("add_instance")) {
      EditEvent event = start(entry, EditEvent::Kind::AddInstance, {"add_instance", "move"});
      event.target = text_of(*like, "add_instance");
      if (const ConfigTree* move = entry.find("move")) event.move = vector_of(*move, "move");
      return script_.events.push_back(std::move(event));
    }
    if (const ConfigTree* text = entry.find("environment")) {
      EditEvent event = start(entry, EditEvent::Kind::SetEnvironment, {"environment"});
      event.environment = text_of(*text, "environment");
      return script_.events.push_back(std::move(event));
    }
    for (const auto& [key, kind] :
         {std::pair("remove_light", EditEvent::Kind::RemoveLight),
          std::pair("remove_instance", EditEvent::Kind::RemoveInstance)}) {
      const ConfigTree* name = entry.find(key);
      if (name == nullptr) continue;
      EditEvent event = start(entry, kind, {key});
      event.target = text_of(*name, key);
      return script_.events.push_back(std::move(event));
    }
    throw Error(concat(entry.where,
                       ": expected one of light, instance, material, add_light, add_instance, "
                       "remove_light, remove_instance and environment"));
  }

 private:
  EditEvent start(const ConfigTree& entry, EditEvent::Kind kind,
                  std::vector<std::string> keys) const {
    keys.emplace_back("frame");
    check_keys(entry, keys);
    EditEvent event;
    event.where = entry.where;
    event.kind = kind;
    if (const ConfigTree* frame = entry.find("frame"))
      event.frame = integer_of(*frame, "frame", 0, script_.frames - 1);
    return event;
  }

  void add_light(const ConfigTree& entry, const ConfigTree& map) {
    EditEvent event = start(entry, EditEvent::Kind::AddLight, {"add_light"});
    if (map.kind != ConfigTree::Kind::Map)
      refuse(map, "add_light", concat("expected a map of name, kind and so on, got ", shown(map)));
    check_keys(map, {"name", "kind", "position", "direction", "intensity", "inner_cone",
                     "outer_cone", "range"});
    scene::PunctualLight& light = event.light;
    const ConfigTree* intensity = map.find("intensity");
    if (intensity == nullptr)
      throw Error(concat(map.where,
                         ": add_light: intensity is missing: [R, G, B] in W/sr, of a "
                         "directional light in W/m²"));
    const std::vector<double> rgb = numbers_of(*intensity, "intensity", 3, 0, 1e12);
    for (int c = 0; c < 3; ++c)
      light.intensity[c] = static_cast<float>(rgb[static_cast<size_t>(c)]);
    if (const ConfigTree* name = map.find("name")) light.name = text_of(*name, "name");
    if (const ConfigTree* kind = map.find("kind")) {
      using scene::LightKind;
      light.kind = parse_enum<LightKind, 3>(concat(kind->where, ": kind"), text_of(*kind, "kind"),
                                            {{{LightKind::Point, "point"},
                                              {LightKind::Spot, "spot"},
                                              {LightKind::Directional, "directional"}}});
    }
    if (const ConfigTree* at = map.find("position")) light.position = vector_of(*at, "position");
    if (const ConfigTree* way = map.find("direction"))
      light.direction = vector_of(*way, "direction");
    const auto radians = [&](const char* key, float* value) {
      const ConfigTree* degrees = map.find(key);
      if (degrees != nullptr)
        *value = static_cast<float>(numbers_of(*degrees, key, 1, 0, 90)[0]) * (kPi / 180);
    };
    radians("inner_cone", &light.inner_cone);
    radians("outer_cone", &light.outer_cone);
    if (const ConfigTree* range = map.find("range"))
      light.range = static_cast<float>(numbers_of(*range, "range", 1, 1e-6, 1e9)[0]);
    script_.events.push_back(std::move(event));
  }

  /// The keys of an entry: `frame: 3` for one, `frames: [0, 10]` for several; 0 without either.
  std::vector<int> frames_of(const ConfigTree& entry) const {
    const ConfigTree *one = entry.find("frame"), *several = entry.find("frames");
    if (one != nullptr && several != nullptr)
      refuse(*several, "frames", "stands beside frame: expected one of the two");
    if (one != nullptr) return {integer_of(*one, "frame", 0, script_.frames - 1)};
    if (several == nullptr) return {0};
    if (several->kind != ConfigTree::Kind::List || several->items.empty())
      refuse(*several, "frames", concat("expected a list such as [0, 10], got ", shown(*several)));
    std::vector<int> out;
    for (const ConfigTree& item : several->items) {
      out.push_back(integer_of(item, "frames", 0, script_.frames - 1));
      if (out.size() > 1 && out.back() <= out[out.size() - 2])
        refuse(item, "frames",
               concat(out.back(), " after ", out[out.size() - 2], ": expected numbers that grow"));
    }
    return out;
  }

  void read_tracks(const ConfigTree& entry, const std::string& target, const std::string& name) {
    std::vector<std::string> keys = {target, "frame", "frames"};
    for (const PropertyRow& row : kProperties) {
      if (row.target == target) keys.emplace_back(row.key);
    }
    check_keys(entry, keys);
    const std::vector<int> frames = frames_of(entry);
    const bool list = entry.find("frames") != nullptr;
    bool any = false;
    for (const PropertyRow& row : kProperties) {
      const ConfigTree* value = row.target == target ? entry.find(row.key) : nullptr;
      if (value == nullptr) continue;
      any = true;
      EditTrack track{value->where, name, row.property, frames, {}};
      if (list && (value->kind != ConfigTree::Kind::List || value->items.size() != frames.size()))
        refuse(*value, row.key,
               concat("expected a list of ", frames.size(), " values, one for each of frames, got ",
                      shown(*value)));
      for (size_t i = 0; i < frames.size(); ++i)
        track.values.push_back(
            numbers_of(list ? value->items[i] : *value, row.key, row.numbers, row.least, row.most));
      script_.tracks.push_back(std::move(track));
    }
    if (any) return;
    keys.erase(keys.begin(), keys.begin() + 3);
    std::string text;
    for (const std::string& key : keys) text += concat(text.empty() ? "" : ", ", key);
    throw Error(concat(entry.where, ": ", target, " ", quote(name),
                       ": nothing is changed; expected one of ", text));
  }

  EditScript& script_;
};

}  // namespace

std::vector<double> EditTrack::at(double frame) const {
  const auto after = std::upper_bound(frames.begin(), frames.end(), frame);
  if (after == frames.begin()) return values.front();
  if (after == frames.end()) return values.back();
  const auto k = static_cast<size_t>(after - frames.begin());
  const double share = (frame - frames[k - 1]) / (frames[k] - frames[k - 1]);
  std::vector<double> out(values[k].size());
  for (size_t i = 0; i < out.size(); ++i)
    out[i] = values[k - 1][i] + share * (values[k][i] - values[k - 1][i]);
  return out;
}

EditScript parse_edit_script(const std::string& text, const std::string& name) {
  const ConfigTree root = parse_config_tree(text, name);
  check_keys(root, {"frames", "fps", "edits"});
  EditScript script;
  const ConfigTree* frames = root.find("frames");
  LTE_CHECK(frames != nullptr, name, ": frames is missing: the number of pictures");
  script.frames = integer_of(*frames, "frames", 1, kMaxFrames);
  if (const ConfigTree* fps = root.find("fps"))
    script.fps = numbers_of(*fps, "fps", 1, 0.01, 1000)[0];
  const ConfigTree* edits = root.find("edits");
  LTE_CHECK(edits != nullptr, name, ": edits is missing: a list of edits");
  if (edits->kind != ConfigTree::Kind::List)
    refuse(*edits, "edits", concat("expected a list, got ", shown(*edits)));
  ScriptReader reader(&script);
  for (const ConfigTree& entry : edits->items) reader.read(entry);
  std::stable_sort(script.events.begin(), script.events.end(),
                   [](const EditEvent& a, const EditEvent& b) { return a.frame < b.frame; });
  return script;
}

EditScript load_edit_script(const std::filesystem::path& path) {
  return parse_edit_script(read_file(path, kMaxScriptBytes), path.string());
}

}  // namespace lte::infer
