#include <cstdint>
#include <utility>

#include "lte/base/check.h"
#include "lte/scene/gltf/context.h"
#include "lte/scene/gltf/extensions.h"

namespace lte::scene::gltf {

void ignore_unknown_extensions(const tinygltf::ExtensionMap& extensions, const std::string& unit,
                               IgnoredFeatures* ignored) {
  for (const auto& [name, value] : extensions) {
    if (is_supported_extension(name)) continue;
    const std::string_view lost = dropped_with(name);
    ignored->add(lost.empty() ? "extension " + name : concat(name, ": dropped ", lost), unit);
  }
}

namespace {

/// The accessor of one primitive's `indices`.
struct Indices {
  size_t mesh, primitive;
  int accessor;
};

/// Takes out the indices whose accessor has no buffer view, which is so for compressed primitives
/// and may be for sparse ones: tinygltf 2.7 refuses them.
std::vector<Indices> take_viewless_indices(Json* json) {
  std::vector<Indices> out;
  for (size_t m = 0; json->contains("meshes") && m < (*json)["meshes"].size(); ++m) {
    Json& mesh = (*json)["meshes"][m];
    for (size_t k = 0; mesh.contains("primitives") && k < mesh["primitives"].size(); ++k) {
      Json& primitive = mesh["primitives"][k];
      if (!primitive.contains("indices")) continue;
      const auto accessor = primitive["indices"].get<size_t>();
      if ((*json)["accessors"][accessor].contains("bufferView")) continue;
      out.push_back({m, k, static_cast<int>(accessor)});
      primitive.erase("indices");
    }
  }
  return out;
}

}  // namespace

tinygltf::Model parse_model(File* file) {
  for (const char* key : {"buffers", "animations"}) file->json.erase(key);
  Json images = file->json.contains("images") ? std::move(file->json["images"]) : Json::array();
  file->json.erase("images");
  const std::vector<Indices> viewless = take_viewless_indices(&file->json);
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
  for (const Indices& indices : viewless)
    model.meshes[indices.mesh].primitives[indices.primitive].indices = indices.accessor;
  return model;
}

}  // namespace lte::scene::gltf
