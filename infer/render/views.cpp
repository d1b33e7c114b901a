#include "infer/render/views.h"

#include <cctype>
#include <map>
#include <optional>

#include "lte/base/check.h"
#include "lte/base/log.h"
#include "lte/pathtrace/auto_camera.h"

namespace lte::infer {
namespace {

struct NumberField {
  size_t at = 0, length = 0;
  size_t digits = 0;
};

/// The first %d or %0Nd.
std::optional<NumberField> find_number(const std::string& text) {
  for (size_t at = text.find('%'); at != std::string::npos; at = text.find('%', at + 1)) {
    NumberField field{at, 2};
    if (text.compare(at + 1, 1, "d") == 0) return field;
    if (text.compare(at + 1, 1, "0") != 0 || at + 3 >= text.size()) continue;
    if (text[at + 2] < '1' || text[at + 2] > '9' || text[at + 3] != 'd') continue;
    return NumberField{at, 4, static_cast<size_t>(text[at + 2] - '0')};
  }
  return std::nullopt;
}

std::string file_name(const std::string& name) {
  std::string out;
  for (const char c : name) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_' ||
                       (c == '.' && !out.empty());
    out += plain ? c : '_';
  }
  return out.empty() ? "_" : out;
}

void name_pictures(const std::string& pattern, std::vector<View>* views) {
  const bool is_pattern = find_number(pattern) || pattern.find("{name}") != std::string::npos;
  LTE_CHECK(is_pattern || views->size() == 1, pattern, ": ", views->size(),
            " pictures need a pattern: %d or %04d for their number, or {name}, as in "
            "picture_%04d.png");
  std::map<std::string, std::string> taken;
  for (size_t i = 0; i < views->size(); ++i) {
    View& view = (*views)[i];
    view.out = picture_name(pattern, i, view.camera.name);
    const auto [at, is_new] = taken.emplace(view.out, view.camera.name);
    LTE_CHECK(is_new, view.out, ": two pictures would have this name, of the cameras \"",
              at->second, "\" and \"", view.camera.name, "\"; put %d into --out");
  }
}

}  // namespace

std::string picture_name(const std::string& pattern, size_t number, const std::string& name) {
  std::string out = pattern;
  if (const std::optional<NumberField> field = find_number(out)) {
    std::string digits = std::to_string(number);
    if (digits.size() < field->digits) digits.insert(0, field->digits - digits.size(), '0');
    out.replace(field->at, field->length, digits);
  }
  const std::string key = "{name}", word = file_name(name);
  for (size_t at = out.find(key); at != std::string::npos; at = out.find(key, at + word.size()))
    out.replace(at, key.size(), word);
  return out;
}

std::vector<View> choose_views(const pathtrace::Bvh& bvh, const std::string& camera,
                               const std::string& out, uint64_t seed, float aspect) {
  const scene::Scene& scene = bvh.scene();
  std::optional<scene::CameraChoice> choice;
  if (!camera.empty()) {
    choice = scene::find_cameras(scene, camera);
  } else if (!scene.cameras.empty()) {
    choice = scene::CameraChoice{{scene.cameras.front()}, false};
  }
  if (!choice) {
    choice = scene::CameraChoice{{pathtrace::auto_camera(bvh, seed, aspect)}, false};
    log_info("camera: ", scene::camera_json(choice->cameras.front()));
  }
  std::vector<View> views;
  for (const scene::Camera& found : choice->cameras) views.push_back({found, out});
  if (choice->several && !out.empty()) name_pictures(out, &views);
  return views;
}

}  // namespace lte::infer
