#include "lte/scene/load_camera.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include <nlohmann/json.hpp>

#include "lte/base/check.h"
#include "lte/base/config.h"
#include "lte/base/file.h"
#include "lte/base/text.h"
#include "lte/base/to_number.h"
#include "lte/image/exr.h"
#include "lte/scene/number_check.h"

namespace lte::scene {
namespace {

using Json = nlohmann::ordered_json;

constexpr size_t kMaxBytes = 16 << 20;  // an `info` of a scene with many textures has them too
constexpr size_t kMaxCameras = 100'000;
const std::vector<std::string> kKeys = {"name", "origin", "target", "up", "vfov", "mirrored"};
/// Shorter, `up` is taken for parallel to the view.
constexpr float kMinSine = 1e-5f;

float read_number(const Json& value, const std::string& where) {
  LTE_CHECK(value.is_number() && std::isfinite(value.get<float>()), where,
            " must be a finite number, got ", value.dump());
  return value.get<float>();
}

Vec3 read_vector(const Json& json, const std::string& key, const std::string& file) {
  const std::string where = concat(file, ": \"", key, "\"");
  LTE_CHECK(json.contains(key), file, ": key \"", key, "\" is missing");
  LTE_CHECK(json[key].is_array() && json[key].size() == 3, where,
            " must be an array of 3 numbers, got ", json[key].dump());
  return {read_number(json[key][0], where), read_number(json[key][1], where),
          read_number(json[key][2], where)};
}

/// Sine of the angle between a view and an up vector; 0 if either has no length.
float sine(const Vec3& view, const Vec3& up) {
  return length(cross(normalize(view), normalize(up)));
}

void check_keys(const Json& json, const std::string& file) {
  for (const auto& [key, value] : json.items()) {
    if (std::find(kKeys.begin(), kKeys.end(), key) != kKeys.end()) continue;
    const std::string near = nearest_name(key, kKeys);
    throw Error(concat(file, ": unknown key \"", key, "\"",
                       near.empty() ? "" : ", did you mean \"" + near + "\"?"));
  }
}

Camera read_camera(const Json& json, const std::string& file, const std::string& name) {
  LTE_CHECK(json.is_object(), file,
            R"(: expected {"origin":[..],"target":[..],"up":[..],"vfov":degrees})");
  check_keys(json, file);
  Camera camera;
  camera.name = name;
  if (json.contains("name")) {
    LTE_CHECK(json["name"].is_string(), file, ": \"name\" must be a text, got ",
              json["name"].dump());
    camera.name = json["name"].get<std::string>();
  }
  camera.origin = read_vector(json, "origin", file);
  camera.target = read_vector(json, "target", file);
  camera.up = json.contains("up") ? read_vector(json, "up", file)
                                  : default_up(camera.target - camera.origin);
  LTE_CHECK(json.contains("vfov"), file, ": key \"vfov\" is missing");
  camera.vfov = read_number(json["vfov"], concat(file, ": \"vfov\""));
  check_camera(camera, file);
  if (json.contains("mirrored")) {
    LTE_CHECK(json["mirrored"].is_boolean(), file, ": \"mirrored\" must be true or false, got ",
              json["mirrored"].dump());
    camera.mirrored = json["mirrored"].get<bool>();
  }
  return camera;
}

Json parse(const std::string& text, const std::string& file) {
  try {
    return Json::parse(text);
  } catch (const Json::exception& error) {
    throw Error(concat(file, ": not valid JSON: ", error.what()));
  }
}

Json parse_file(const std::filesystem::path& path) {
  if (!lower_case(path.string()).ends_with(".exr"))
    return parse(read_file(path, kMaxBytes), path.string());
  const std::optional<std::string> text = image::read_exr_text(path, kCameraAttribute);
  LTE_CHECK(text.has_value(), path.string(), ": has no camera: no attribute ", kCameraAttribute);
  return parse(*text, path.string());
}

/// The camera or cameras in a file's JSON; those of other results of lte have them under a key.
const Json& cameras_in(const Json& json) {
  if (!json.is_object() || json.contains("origin")) return json;
  for (const char* key : {"camera", "camera_list"}) {
    if (json.contains(key) && (json[key].is_object() || json[key].is_array())) return json[key];
  }
  return json;
}

/// The double that is written with as few digits as the float needs: 1.6, not 1.600000023841858.
double shortest(float value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  double out = value;
  std::from_chars(text.data(), end, out);
  return out;
}

Json vector_json(const Vec3& v) { return {shortest(v.x), shortest(v.y), shortest(v.z)}; }

/// `0 "kitchen", 1 "hall"`, cut after a dozen.
std::string camera_names(const Scene& scene) {
  constexpr size_t kListed = 12;
  if (scene.cameras.empty()) return "the scene has no cameras";
  std::string text = "the scene's are ";
  for (size_t i = 0; i < scene.cameras.size() && i < kListed; ++i)
    text += concat(i > 0 ? ", " : "", i, " \"", scene.cameras[i].name, "\"");
  if (scene.cameras.size() > kListed)
    text += concat(" and ", scene.cameras.size() - kListed, " more");
  return text;
}

constexpr std::string_view kAutoSeed = "auto:";

/// The cameras of a file, and whether it holds them as a list.
CameraChoice read_cameras(const std::filesystem::path& path) {
  const std::string file = path.string(), name = path.stem().string();
  const Json json = parse_file(path);
  const Json& found = cameras_in(json);
  if (!found.is_array()) return {{read_camera(found, file, name)}, false};
  LTE_CHECK(!found.empty() && found.size() <= kMaxCameras, file, ": expected 1 to ", kMaxCameras,
            " cameras, got ", found.size());
  // For an array of numbers, say, the message shows what a camera looks like.
  if (!found[0].is_object()) return {{read_camera(found[0], file, name)}, false};
  CameraChoice choice{{}, true};
  for (size_t i = 0; i < found.size(); ++i) {
    choice.cameras.push_back(
        read_camera(found[i], concat(file, ": camera ", i), concat(name, "_", i)));
  }
  return choice;
}

/// The cameras that are called so, in the order of the scene.
std::vector<size_t> called(const Scene& scene, const std::string& name) {
  std::vector<size_t> found;
  for (size_t i = 0; i < scene.cameras.size(); ++i)
    if (scene.cameras[i].name == name) found.push_back(i);
  return found;
}

[[noreturn]] void refuse(const Scene& scene, const std::string& word) {
  std::vector<std::string> names = {"auto", "all"};
  for (const Camera& camera : scene.cameras) names.push_back(camera.name);
  const std::string near = nearest_name(word, names);
  throw Error(concat("camera \"", word, "\": ", camera_names(scene),
                     "; expected a name, an index, all, auto or a .json file",
                     near.empty() ? "" : "; did you mean \"" + near + "\"?"));
}

}  // namespace

Vec3 default_up(const Vec3& view) {
  const Vec3 up{0, 1, 0};
  if (sine(view, up) > kMinSine) return up;
  return {0, 0, view.y < 0 ? -1.0f : 1.0f};
}

void check_camera(const Camera& camera, const std::string& what) {
  const auto check_place = [&](const char* key, const Vec3& place) {
    LTE_CHECK(is_place(place), what, ": \"", key, "\" must have numbers of at most ",
              kMaxCoordinate, ", got ", place.x, ", ", place.y, ", ", place.z);
  };
  check_place("origin", camera.origin);
  check_place("target", camera.target);
  check_place("up", camera.up);
  const Vec3 view = camera.target - camera.origin;
  LTE_CHECK(length(view) > 0 && is_finite(view), what, ": \"target\" must differ from \"origin\"");
  LTE_CHECK(sine(view, camera.up) > kMinSine, what,
            ": \"up\" must not be zero or parallel to the view direction");
  LTE_CHECK(camera.vfov > 0 && camera.vfov < 180, what,
            ": \"vfov\" must be between 0 and 180 degrees, got ", camera.vfov);
}

std::vector<Camera> load_cameras(const std::filesystem::path& path) {
  return read_cameras(path).cameras;
}

Camera load_camera(const std::filesystem::path& path) {
  std::vector<Camera> cameras = load_cameras(path);
  LTE_CHECK(cameras.size() == 1, path.string(), ": expected one camera, got ", cameras.size());
  return cameras.front();
}

std::string camera_json(const Camera& camera) {
  Json json = {{"name", camera.name},
               {"origin", vector_json(camera.origin)},
               {"target", vector_json(camera.target)},
               {"up", vector_json(camera.up)},
               {"vfov", shortest(camera.vfov)}};
  if (camera.mirrored) json["mirrored"] = true;
  // Names in scene files need not be valid UTF-8.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::optional<CameraChoice> find_cameras(const Scene& scene, const std::string& word) {
  if (word == "auto" || word.starts_with(kAutoSeed)) {
    auto_camera_seed(word);
    return std::nullopt;
  }
  if (word == "all") {
    LTE_CHECK(!scene.cameras.empty(), "camera \"all\": the scene has no cameras; auto makes one");
    return CameraChoice{scene.cameras, true};
  }
  const std::vector<size_t> named = called(scene, word);
  if (named.size() == 1) return CameraChoice{{scene.cameras[named[0]]}, false};
  LTE_CHECK(named.empty(), "camera \"", word, "\": ", named.size(),
            " cameras are called so: give the index, such as ", named[0]);
  if (const auto index = to_number<size_t>(word)) {
    if (*index >= scene.cameras.size()) refuse(scene, word);
    return CameraChoice{{scene.cameras[*index]}, false};
  }
  const std::string lower = lower_case(word);
  std::error_code ignored;
  if (lower.ends_with(".json") || lower.ends_with(".exr") ||
      std::filesystem::is_regular_file(word, ignored)) {
    return read_cameras(word);
  }
  refuse(scene, word);
}

uint64_t auto_camera_seed(const std::string& word) {
  if (!word.starts_with(kAutoSeed)) return 0;
  const auto seed = to_number<size_t>(std::string_view(word).substr(kAutoSeed.size()));
  LTE_CHECK(seed, "camera \"", word, "\": expected auto, or auto: and a number such as auto:1");
  return *seed;
}

}  // namespace lte::scene
