#include <cstdint>
#include <utility>

#include "lte/base/check.h"
#include "lte/scene/gltf_extensions.h"
#include "lte/scene/gltf_import.h"

namespace lte::scene::gltf {

std::vector<std::string> Notes::lines() const {
  std::vector<std::string> out;
  for (const auto& [key, count] : counts_) {
    out.push_back(concat(key.first, " (", count, " ", key.second, count == 1 ? "" : "s", ")"));
  }
  return out;
}

void note_extensions(const tinygltf::ExtensionMap& extensions, const std::string& unit,
                     Notes* notes) {
  for (const auto& [name, value] : extensions) {
    if (!is_supported_extension(name)) notes->add("extension " + name, unit);
  }
}

tinygltf::Model parse_model(File* file) {
  for (const char* key : {"buffers", "animations", "skins"}) file->json.erase(key);
  Json images = file->json.contains("images") ? std::move(file->json["images"]) : Json::array();
  file->json.erase("images");
  const std::string text = file->json.dump();
  file->json = Json{{"images", std::move(images)}};
  LTE_CHECK(text.size() <= UINT32_MAX, file->name, ": its JSON of ", text.size(),
            " bytes is too large");
  tinygltf::TinyGLTF parser;
  tinygltf::Model model;
  std::string error, warning;
  const bool parsed = parser.LoadASCIIFromString(&model, &error, &warning, text.data(),
                                                 static_cast<unsigned int>(text.size()), "");
  for (char& c : error) c = c == '\n' ? ' ' : c;
  LTE_CHECK(parsed, file->name, ": ", error.empty() ? "not a glTF document" : error);
  return model;
}

}  // namespace lte::scene::gltf
