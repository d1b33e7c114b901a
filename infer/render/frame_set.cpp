#include "infer/render/frame_set.h"

#include <set>
#include <utility>

#include <nlohmann/json.hpp>

#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/scene/load_camera.h"

namespace lte::infer {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "lte-frames";
constexpr int kFormatVersion = 1;
constexpr size_t kMaxBytes = size_t{64} << 20;

/// Flags that change no pixel, or whose effect is in the cameras.
const std::set<std::string> kNoMatter = {"camera", "cameras", "turntable", "edit"};

/// The pattern's file with nothing in the place of number and name, in a folder without any.
fs::path manifest_path(const std::string& pattern) {
  const fs::path path = pattern;
  fs::path folder = path.parent_path();
  const auto varies = [](const std::string& text) {
    return picture_name(text, 0, "a") != picture_name(text, 1, "b");
  };
  while (varies(folder.string())) folder = folder.parent_path();
  // "%02d_{name}" leaves "_", of which nothing speaks.
  std::string stem = path.stem().string();
  for (const std::string mark : {"{name}", "%d"}) {
    for (size_t at = stem.find(mark); at != std::string::npos; at = stem.find(mark))
      stem.erase(at, mark.size());
  }
  for (char digits = '1'; digits <= '9'; ++digits) {
    const std::string mark = std::string("%0") + digits + "d";
    if (const size_t at = stem.find(mark); at != std::string::npos) stem.erase(at, mark.size());
  }
  while (!stem.empty() && std::string("_-. ").find(stem.back()) != std::string::npos)
    stem.pop_back();
  if (!stem.empty()) stem += "_";
  // The extension is part of the name, as frames of both kinds may lie in one folder.
  const std::string kind = path.extension().string();
  return folder / (stem + "frames" + (kind.empty() ? "" : "_" + kind.substr(1)) + ".json");
}

std::string name_of(const View& view) { return fs::path(view.out).lexically_normal().string(); }

Json read_manifest(const fs::path& path) {
  Json json;
  try {
    json = Json::parse(read_file(path, kMaxBytes));
  } catch (const Json::exception&) {
    throw Error(concat(path.string(), ": not valid JSON; remove it and the frames beside it"));
  }
  LTE_CHECK(json.is_object() && json.contains("format") && json["format"] == kFormat, path.string(),
            ": says nothing of frames (no format \"", kFormat, "\")");
  LTE_CHECK(json.contains("format_version") && json["format_version"] == kFormatVersion,
            path.string(), ": its format version is not ", kFormatVersion,
            ", which this program knows");
  return json;
}

std::map<std::string, std::string> texts_in(const fs::path& path, const Json& json,
                                            const char* key) {
  std::map<std::string, std::string> out;
  LTE_CHECK(json.contains(key) && json[key].is_object(), path.string(), ": \"", key,
            "\" is missing");
  for (const auto& [name, value] : json[key].items()) {
    LTE_CHECK(value.is_string(), path.string(), ": \"", name, "\" is no text");
    out[name] = value.get<std::string>();
  }
  return out;
}

}  // namespace

MadeWith frame_settings(CLI::App& app, const scene::Scene& scene, const runtime::Network* network) {
  return made_with(app, scene, network, kNoMatter);
}

FrameSet::FrameSet(const std::string& pattern, MadeWith settings)
    : manifest_(manifest_path(pattern)), settings_(std::move(settings)) {}

std::vector<View> FrameSet::missing(const std::vector<View>& views, bool resume) {
  std::vector<View> finished, absent;
  for (const View& view : views) (fs::exists(view.out) ? finished : absent).push_back(view);
  LTE_CHECK(
      resume || finished.empty(), finished.front().out, ": exists",
      finished.size() > 1 ? concat(", and ", finished.size() - 1, " more of these frames do") : "",
      "; remove them, name others in --out, or go on with them by --resume");
  if (!finished.empty()) check_manifest(finished);
  for (const View& view : views) cameras_[name_of(view)] = scene::camera_json(view.camera);
  if (resume) log_info(finished.size(), " of ", views.size(), " pictures exist already");
  return absent;
}

void FrameSet::check_manifest(const std::vector<View>& finished) {
  const std::string file = manifest_.string();
  LTE_CHECK(fs::exists(manifest_), finished.front().out, ": exists, but not ", file,
            ", which would say how it was made; remove it or name other frames in --out");
  const Json json = read_manifest(manifest_);
  const MadeWith there = texts_in(manifest_, json, "settings");
  const char* hint = "; remove these frames or name others in --out";
  check_made_with(file, "the frames were", there, settings_, hint);
  cameras_ = texts_in(manifest_, json, "cameras");
  for (const View& view : finished) {
    const auto found = cameras_.find(name_of(view));
    LTE_CHECK(found != cameras_.end() && found->second == scene::camera_json(view.camera), view.out,
              ": was made by another camera, as ", file, " says", hint);
  }
  if (json.contains("exposure") && json["exposure"].is_number())
    exposure_ = json["exposure"].get<double>();
}

double FrameSet::shared_exposure(double own) {
  if (!exposure_) {
    exposure_ = own;
    write_manifest();
  }
  return *exposure_;
}

void FrameSet::write_manifest() const {
  Json json = {{"format", kFormat},
               {"format_version", kFormatVersion},
               {"settings", settings_},
               {"cameras", cameras_}};
  if (exposure_) json["exposure"] = *exposure_;
  write_file(manifest_, json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace lte::infer
