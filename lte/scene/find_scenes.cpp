#include "lte/scene/find_scenes.h"

#include <algorithm>
#include <array>
#include <map>
#include <regex>
#include <set>

#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/text.h"

namespace lte::scene {
namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, 5> kSuffixes = {".glb", ".gltf", ".pbrt", ".obj", ".ply"};
constexpr const char* kExpected = "expected .glb, .gltf, .pbrt, .obj or .ply";

std::string suffix_of(const fs::path& path) { return lower_case(path.extension().string()); }

bool is_scene_name(const fs::path& path) {
  return std::find(kSuffixes.begin(), kSuffixes.end(), suffix_of(path)) != kSuffixes.end();
}

fs::path camera_beside(const fs::path& scene) {
  fs::path camera = scene.parent_path() / (scene.stem().string() + ".camera.json");
  return fs::is_regular_file(camera) ? camera : fs::path();
}

/// Takes the parts of other scenes out of a folder's files. @return how many
int take_parts(std::vector<fs::path>* files) {
  std::set<std::string> named;
  std::set<fs::path> included;
  const std::regex ply("\"([^\"\\n]+\\.ply)\"", std::regex::icase);
  for (const fs::path& file : *files) {
    if (suffix_of(file) != ".pbrt") continue;
    const std::string text = read_file(file);
    if (text.find("WorldBegin") == std::string::npos) included.insert(file);
    for (std::sregex_iterator at(text.begin(), text.end(), ply), end; at != end; ++at)
      named.insert(fs::path((*at)[1].str()).filename().string());
  }
  return static_cast<int>(std::erase_if(*files, [&](const fs::path& file) {
    return included.contains(file) ||
           (suffix_of(file) == ".ply" && named.contains(file.filename().string()));
  }));
}

void add_folder(const fs::path& folder, FoundScenes* out) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file() && is_scene_name(entry.path())) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  out->parts += take_parts(&files);
  LTE_CHECK(!files.empty(), folder.string(), ": no scene in this folder: ", kExpected);
  for (const fs::path& file : files)
    out->scenes.push_back(
        {file, file.lexically_relative(folder).generic_string(), camera_beside(file)});
}

}  // namespace

FoundScenes find_scenes(const std::vector<std::string>& places) {
  FoundScenes out;
  for (const std::string& place : places) {
    const fs::path path(place);
    LTE_CHECK(fs::exists(path), place, ": no such file or folder");
    if (fs::is_directory(path)) {
      add_folder(path, &out);
      continue;
    }
    LTE_CHECK(is_scene_name(path), place, ": is no scene: ", kExpected);
    out.scenes.push_back({path, path.filename().string(), camera_beside(path)});
  }
  std::map<std::string, int> count;
  for (const FoundScene& scene : out.scenes) ++count[scene.name];
  std::set<std::string> taken;
  for (FoundScene& scene : out.scenes) {
    if (count[scene.name] > 1) scene.name = scene.path.generic_string();
    LTE_CHECK(taken.insert(scene.name).second, scene.name, ": is given twice");
  }
  return out;
}

}  // namespace lte::scene
