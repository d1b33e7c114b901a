#include "infer/render/views.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <optional>

#include "infer/render/video.h"
#include "lte/base/check.h"
#include "lte/base/log.h"
#include "lte/pathtrace/placement/auto_camera.h"
#include "lte/pathtrace/placement/turntable.h"

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
  const bool is_pattern =
      is_video_path(pattern) || find_number(pattern) || pattern.find("{name}") != std::string::npos;
  LTE_CHECK(is_pattern || views->size() == 1, pattern, ": ", views->size(),
            " pictures need a pattern: %d or %04d for their number, or {name}, as in "
            "picture_%04d.png; or a video's name, as turn.mp4");
  std::map<std::string, std::string> taken;
  for (size_t i = 0; i < views->size(); ++i) {
    View& view = (*views)[i];
    view.out = picture_name(pattern, i, view.camera.name);
    const auto [at, is_new] = taken.emplace(view.out, view.camera.name);
    LTE_CHECK(is_new, view.out, ": two pictures would have this name, of the cameras \"",
              at->second, "\" and \"", view.camera.name, "\"; put %d into --out");
  }
}

const char* turn_text(pathtrace::Turn turn) {
  switch (turn) {
    case pathtrace::Turn::Around:
      return "around the scene";
    case pathtrace::Turn::LookRound:
      return "in place, as the camera is inside a room";
    default:
      return "to and fro before the open side";
  }
}

/// Whether a picture of this camera may show anything of a box: false if all corners of the box lie
/// behind the camera, or beyond the same edge of the picture.
bool may_see(const scene::Camera& camera, const Bounds& box, float aspect) {
  const Vec3 view = normalize(camera.target - camera.origin);
  const Vec3 right = normalize(cross(view, camera.up)), above = cross(right, view);
  const float half = std::tan(camera.vfov * kPi / 360);
  const std::array<Vec3, 5> inwards{view, view * (half * aspect) + right,
                                    view * (half * aspect) - right, view * half + above,
                                    view * half - above};
  return std::all_of(inwards.begin(), inwards.end(), [&](const Vec3& inward) {
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 p{corner & 1 ? box.high.x : box.low.x, corner & 2 ? box.high.y : box.low.y,
                   corner & 4 ? box.high.z : box.low.z};
      if (dot(p - camera.origin, inward) > 0) return true;
    }
    return false;
  });
}

}  // namespace

std::string picture_name(const std::string& pattern, size_t number, const std::string& name) {
  if (is_video_path(pattern)) return concat(pattern, "#", number);
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
                               const std::string& out, float aspect) {
  const scene::Scene& scene = bvh.scene();
  std::optional<scene::CameraChoice> choice;
  if (!camera.empty()) {
    choice = scene::find_cameras(scene, camera);
  } else if (!scene.cameras.empty()) {
    choice = scene::CameraChoice{{scene.cameras.front()}, false};
  }
  if (!choice) {
    choice = scene::CameraChoice{
        {pathtrace::auto_camera(bvh, scene::auto_camera_seed(camera), aspect)}, false};
    log_info("camera: ", scene::camera_json(choice->cameras.front()));
  }
  std::vector<View> views;
  for (const scene::Camera& found : choice->cameras) views.push_back({found, out});
  if (choice->several && !out.empty()) name_pictures(out, &views);
  return views;
}

std::vector<View> turntable_views(const pathtrace::Bvh& bvh, const std::string& camera, int count,
                                  const std::string& out, float aspect) {
  const std::vector<View> first = choose_views(bvh, camera.empty() ? "auto" : camera, "", aspect);
  LTE_CHECK(first.size() == 1, "--turntable begins with one camera, but --camera ", camera,
            " names ", first.size());
  const pathtrace::Turntable table = pathtrace::turntable(bvh, first.front().camera, count);
  log_info("turntable: ", count, " cameras ", turn_text(table.turn));
  std::vector<View> views;
  for (const scene::Camera& each : table.cameras) views.push_back({each, out});
  if (!out.empty()) name_pictures(out, &views);
  return views;
}

std::vector<scene::Camera> cameras_of(const std::vector<View>& views) {
  std::vector<scene::Camera> cameras;
  cameras.reserve(views.size());
  for (const View& view : views) cameras.push_back(view.camera);
  return cameras;
}

void check_in_view(const scene::Scene& scene, const Bounds& bounds, const std::vector<View>& views,
                   float aspect) {
  if (scene.environment || bounds.empty()) return;
  for (size_t i = 0; i < views.size(); ++i) {
    const scene::Camera& camera = views[i].camera;
    LTE_CHECK(may_see(camera, bounds, aspect), "camera ", i, " (\"", camera.name,
              "\"): nothing of the scene is in its view; it lies at ", bounds.low.x, " ",
              bounds.low.y, " ", bounds.low.z, " to ", bounds.high.x, " ", bounds.high.y, " ",
              bounds.high.z);
  }
}

}  // namespace lte::infer
