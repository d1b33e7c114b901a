#include "lte/scene/load_camera.h"

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "lte/base/check.h"
#include "lte/base/config.h"
#include "lte/base/file.h"
#include "lte/scene/number_check.h"

namespace lte::scene {
namespace {

using Json = nlohmann::json;

constexpr size_t kMaxBytes = 1 << 20;  // far more than a camera takes
const std::vector<std::string> kKeys = {"origin", "target", "up", "vfov"};

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
  const Vec3 value{read_number(json[key][0], where), read_number(json[key][1], where),
                   read_number(json[key][2], where)};
  LTE_CHECK(is_place(value), where, " must have numbers of at most ", kMaxCoordinate, ", got ",
            json[key].dump());
  return value;
}

Json parse(const std::filesystem::path& path) {
  try {
    return Json::parse(read_file(path, kMaxBytes));
  } catch (const Json::exception& error) {
    throw Error(concat(path.string(), ": not valid JSON: ", error.what()));
  }
}

}  // namespace

Camera load_camera(const std::filesystem::path& path) {
  const std::string file = path.string();
  const Json json = parse(path);
  LTE_CHECK(json.is_object(), file,
            R"(: expected {"origin":[..],"target":[..],"up":[..],"vfov":degrees})");
  for (const auto& [key, value] : json.items()) {
    if (std::find(kKeys.begin(), kKeys.end(), key) != kKeys.end()) continue;
    const std::string near = nearest_name(key, kKeys);
    throw Error(concat(file, ": unknown key \"", key, "\"",
                       near.empty() ? "" : ", did you mean \"" + near + "\"?"));
  }
  Camera camera;
  camera.name = path.stem().string();
  camera.origin = read_vector(json, "origin", file);
  camera.target = read_vector(json, "target", file);
  camera.up = read_vector(json, "up", file);
  LTE_CHECK(json.contains("vfov"), file, ": key \"vfov\" is missing");
  camera.vfov = read_number(json["vfov"], concat(file, ": \"vfov\""));
  LTE_CHECK(camera.vfov > 0 && camera.vfov < 180, file,
            ": \"vfov\" must be between 0 and 180 degrees, got ", camera.vfov);
  const Vec3 view = camera.target - camera.origin;
  LTE_CHECK(length(view) > 0 && is_finite(view), file, ": \"target\" must differ from \"origin\"");
  LTE_CHECK(length(camera.up) > 0 && length(cross(normalize(view), normalize(camera.up))) > 1e-5f,
            file, ": \"up\" must not be zero or parallel to the view direction");
  return camera;
}

}  // namespace lte::scene
