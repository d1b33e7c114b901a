#include "infer/view/messages.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include <nlohmann/json.hpp>

#include "lte/base/check.h"

namespace lte::infer::view {
namespace {

using nlohmann::json;

constexpr double kFarthest = 1e7;                 // units of the scene
constexpr double kMaxGain = 1e6;                  // of a light
constexpr double kMaxIntensity = 1e9;             // of a lamp that is added, W/sr
constexpr int kMaxIndex = 1 << 30;                // of anything in a scene
constexpr int64_t kMaxNumber = int64_t{1} << 53;  // what JavaScript counts exactly

enum class LampKind { Point, Spot };
constexpr EnumNames<LampKind, 2> enum_names(LampKind) {
  return {{{LampKind::Point, "point"}, {LampKind::Spot, "spot"}}};
}

/// The keys of one message. Each is read once; what is left at the end is unknown.
class Fields {
 public:
  Fields(const json& object, std::string type) : object_(object), type_(std::move(type)) {
    read_ = {"type", "n"};
  }

  bool has(const char* key) const { return object_.contains(key); }

  double number(const char* key, double low, double high) {
    return number_of(value(key), key, low, high);
  }

  int64_t integer(const char* key, int64_t low, int64_t high) {
    const json& found = value(key);
    const bool good = found.is_number_integer() &&
                      !(found.is_number_unsigned() && found.get<uint64_t>() > INT64_MAX) &&
                      found.get<int64_t>() >= low && found.get<int64_t>() <= high;
    LTE_CHECK(good, where(key), "expected a whole number of ", low, " to ", high);
    return found.get<int64_t>();
  }

  int index(const char* key) { return static_cast<int>(integer(key, 0, kMaxIndex)); }

  Vec3 vector(const char* key, double low, double high) {
    const json& found = value(key);
    LTE_CHECK(found.is_array() && found.size() == 3, where(key), "expected three numbers");
    Vec3 out;
    for (int axis = 0; axis < 3; ++axis)
      out[axis] = static_cast<float>(number_of(found[static_cast<size_t>(axis)], key, low, high));
    return out;
  }

  template <typename Enum>
  Enum word(const char* key) {
    return parse_enum<Enum>(concat("message ", type_, ": ", key), text(key));
  }

  /// A word of any letters, printable where it comes back in an answer.
  std::string text(const char* key) {
    const json& found = value(key);
    LTE_CHECK(found.is_string() && found.get_ref<const std::string&>().size() <= kMaxWordBytes,
              where(key), "expected a word");
    return printable(found.get<std::string>());
  }

  PictureSize size(const char* key) {
    const json& found = value(key);
    LTE_CHECK(found.is_array() && found.size() == 2 && found[0].is_number_integer() &&
                  found[1].is_number_integer(),
              where(key), "expected width and height");
    const double width = number_of(found[0], key, kMinSide, kMaxSide);
    const double height = number_of(found[1], key, kMinSide, kMaxSide);
    return {static_cast<int>(width), static_cast<int>(height)};
  }

  bool flag(const char* key) {
    const json& found = value(key);
    LTE_CHECK(found.is_boolean(), where(key), "expected true or false");
    return found.get<bool>();
  }

  void finish() const {
    for (const auto& [key, ignored] : object_.items())
      LTE_CHECK(read_.count(key) > 0, "message ", type_, ": unknown key \"", printable(key), "\"");
  }

  /// At most 40 bytes of a text, with what is no printable ASCII as '?'.
  static std::string printable(const std::string& text) {
    std::string out = text.substr(0, kMaxWordBytes);
    std::replace_if(
        out.begin(), out.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
    return out;
  }

 private:
  std::string where(const char* key) const { return concat("message ", type_, ": ", key, ": "); }

  const json& value(const char* key) {
    read_.insert(key);
    const auto found = object_.find(key);
    LTE_CHECK(found != object_.end(), where(key), "is missing");
    return *found;
  }

  double number_of(const json& found, const char* key, double low, double high) const {
    const double value = found.is_number() ? found.get<double>() : NAN;
    LTE_CHECK(value >= low && value <= high, where(key), "expected a number of ", low, " to ",
              high);
    return value;
  }

  const json& object_;
  std::string type_;
  std::set<std::string> read_;
};

MoveCamera read_camera(Fields* fields) {
  scene::Camera camera;
  camera.origin = fields->vector("origin", -kFarthest, kFarthest);
  camera.target = fields->vector("target", -kFarthest, kFarthest);
  camera.up = fields->vector("up", -kFarthest, kFarthest);
  camera.vfov = static_cast<float>(fields->number("vfov", 1, 170));
  const Vec3 view = normalize(camera.target - camera.origin);
  LTE_CHECK(length(view) > 0.5f, "message camera: target: expected another point than origin");
  LTE_CHECK(length(cross(view, normalize(camera.up))) > 1e-4f,
            "message camera: up: expected another direction than that of the view");
  return {camera};
}

ChangeView read_view(Fields* fields) {
  ChangeView view;
  if (fields->has("shown")) view.shown = fields->word<Shown>("shown");
  if (fields->has("ev")) view.ev = static_cast<float>(fields->number("ev", -30, 30));
  if (fields->has("curve")) view.curve = fields->word<ToneCurve>("curve");
  if (fields->has("size")) view.size = fields->size("size");
  if (fields->has("meter")) view.meter = fields->flag("meter");
  return view;
}

Vec3 read_direction(const char* type, Fields* fields) {
  const Vec3 direction = fields->vector("direction", -1e3, 1e3);
  LTE_CHECK(length(direction) > 1e-6f, "message ", type,
            ": direction: expected numbers that are not all 0");
  return direction;
}

LightSetting read_light(Fields* fields) {
  LightSetting light;
  light.light = fields->index("light");
  light.gain = static_cast<float>(fields->number("gain", 0, kMaxGain));
  light.color = fields->vector("color", 0, 1);
  LTE_CHECK(max_component(light.color) > 0,
            "message light: color: expected one that is not black (gain 0 switches a light off)");
  if (fields->has("position")) light.position = fields->vector("position", -kFarthest, kFarthest);
  if (fields->has("direction")) light.direction = read_direction("light", fields);
  return light;
}

AddLamp read_lamp(Fields* fields) {
  AddLamp lamp;
  const auto kind = fields->word<LampKind>("kind");
  lamp.kind = kind == LampKind::Spot ? scene::LightKind::Spot : scene::LightKind::Point;
  lamp.position = fields->vector("position", -kFarthest, kFarthest);
  if (fields->has("direction")) lamp.direction = read_direction("add_light", fields);
  if (fields->has("intensity")) lamp.intensity = fields->vector("intensity", 0, kMaxIntensity);
  return lamp;
}

PageEdit read_edit(const std::string& type, Fields* fields) {
  if (type == "light") return read_light(fields);
  if (type == "material")
    return MaterialSetting{fields->index("material"), fields->vector("albedo", 0, 1)};
  return ObjectSetting{fields->index("object"),
                       {fields->vector("move", -kFarthest, kFarthest),
                        static_cast<float>(fields->number("turn", -360, 360)),
                        static_cast<float>(fields->number("scale", 0.01, 100))}};
}

Request read_request(const std::string& type, Fields* fields) {
  if (type == "hello") return Hello{static_cast<int>(fields->integer("protocol", 0, kMaxIndex))};
  if (type == "camera") return read_camera(fields);
  if (type == "view") return read_view(fields);
  if (type == "light" || type == "material" || type == "object") {
    const int64_t gesture = fields->integer("gesture", 0, kMaxNumber);
    return MakeEdit{read_edit(type, fields), gesture};
  }
  if (type == "copy_object")
    return CopyObject{fields->index("object"), fields->vector("move", -kFarthest, kFarthest)};
  if (type == "remove_object") return RemoveObject{fields->index("object")};
  if (type == "add_light") return read_lamp(fields);
  if (type == "remove_light") return RemoveLamp{fields->index("light")};
  if (type == "pick") {
    return PickAt{static_cast<float>(fields->number("x", 0, 1)),
                  static_cast<float>(fields->number("y", 0, 1))};
  }
  if (type == "save") return Save{fields->word<SaveFormat>("format")};
  if (type == "undo") return Undo{};
  if (type == "redo") return Redo{};
  if (type == "reset") return Reset{};
  if (type == "shows") return Shows{fields->integer("picture", 0, kMaxNumber)};
  throw Error(concat("unknown message type \"", Fields::printable(type), "\""));
}

}  // namespace

Message parse_message(std::string_view text) {
  LTE_CHECK(text.size() <= kMaxMessageBytes, "message of ", text.size(), " bytes: expected ",
            kMaxMessageBytes, " at most");
  const json object = json::parse(text, nullptr, /*allow_exceptions=*/false);
  LTE_CHECK(object.is_object(), "expected a JSON object");
  const auto type = object.find("type");
  LTE_CHECK(type != object.end() && type->is_string(), "expected a message with a \"type\"");
  Fields fields(object, Fields::printable(type->get<std::string>()));
  Message message;
  message.request = read_request(type->get<std::string>(), &fields);
  message.number = fields.integer("n", 1, kMaxNumber);
  fields.finish();
  return message;
}

}  // namespace lte::infer::view
