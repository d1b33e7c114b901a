// Every way in which a scene file names another file, as a small scene that does it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "lte/base/check.h"
#include "lte/image/png.h"
#include "tests/scene/gltf/gltf_builder.h"
#include "tests/support/temp_dir.h"

namespace lte::test {

/// A format, a place in it where a file's name stands, and what kind of file that is.
struct Door {
  std::string name;
  std::string scene;    ///< name of the scene's file
  std::string content;  ///< extension of what is named, as write_content() has it
  std::function<void(const std::filesystem::path& scene, const std::string& reference)> write;
};

inline void PrintTo(const Door& door, std::ostream* out) { *out << door.name; }

/// Writes one good file of each kind: NAME.png, NAME.bin (a gltf buffer), NAME.mtl, ...
inline void write_content(const std::filesystem::path& folder, const std::string& name) {
  std::filesystem::create_directories(folder);
  image::write_png(folder / (name + ".png"), image::Image(2, 2, 3));
  const std::vector<float> corners = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  write_text(folder / (name + ".bin"), {reinterpret_cast<const char*>(corners.data()), 36});
  write_text(folder / (name + ".mtl"), "newmtl a\nKd 1 0 0\n");
  write_text(folder / (name + ".pbrt"), "Translate 1 0 0\n");
  write_text(folder / (name + ".spd"), "400 1 700 1\n");
  write_text(folder / (name + ".ply"),
             "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
             "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
             "end_header\n0 0 0 1 0 0 0 1 0 3 0 1 2\n");
}

inline GltfBuilder gltf_with_image(const std::string& uri) {
  GltfBuilder builder;
  Json primitive = builder.triangle();
  primitive["attributes"]["TEXCOORD_0"] = builder.floats({0, 0, 1, 0, 0, 1}, "VEC2");
  primitive["material"] = 0;
  builder.mesh(primitive);
  builder.json["images"] = {{{"uri", uri}}};
  builder.json["textures"] = {{{"source", 0}}};
  builder.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  return builder;
}

/// A .glb may name buffers, too, if they come after its own.
inline std::string glb_of(GltfBuilder builder, const std::string& buffer = "") {
  std::string whole = builder.glb();
  if (buffer.empty()) return whole;
  builder.json["buffers"].push_back({{"byteLength", 36}, {"uri", buffer}});
  for (Json& view : builder.json["bufferViews"]) view = {{"buffer", 1}, {"byteLength", 36}};
  return builder.container();
}

inline std::vector<Door> doors() {
  const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n";
  const std::string triangle =
      "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 2]\n";
  const auto pbrt = [=](const std::string& before, const std::string& behind) {
    return [=](const std::filesystem::path& scene, const std::string& reference) {
      write_text(scene,
                 "WorldBegin\n" + before + " \"" + reference + "\"" + behind + "\n" + triangle);
    };
  };
  std::vector<Door> out;
  out.push_back({"gltf image", "scene.gltf", ".png", [](const auto& scene, const auto& reference) {
                   gltf_with_image(reference).save_embedded(scene);
                 }});
  out.push_back({"glb image", "scene.glb", ".png", [](const auto& scene, const auto& reference) {
                   write_text(scene, glb_of(gltf_with_image(reference)));
                 }});
  const auto plain = [] {
    GltfBuilder builder;
    builder.mesh(builder.triangle());
    return builder;
  };
  out.push_back(
      {"gltf buffer", "scene.gltf", ".bin", [=](const auto& scene, const auto& reference) {
         GltfBuilder builder = plain();
         builder.json["buffers"] = {{{"byteLength", 36}, {"uri", reference}}};
         write_text(scene, builder.json.dump());
       }});
  out.push_back({"glb buffer", "scene.glb", ".bin", [=](const auto& scene, const auto& reference) {
                   write_text(scene, glb_of(plain(), reference));
                 }});
  out.push_back({"obj mtllib", "scene.obj", ".mtl", [=](const auto& scene, const auto& reference) {
                   write_text(scene, "mtllib " + reference + "\n" + obj);
                 }});
  out.push_back({"obj map_Kd", "scene.obj", ".png", [=](const auto& scene, const auto& reference) {
                   write_text(scene.parent_path() / "own.mtl",
                              "newmtl a\nmap_Kd " + reference + "\n");
                   write_text(scene, "mtllib own.mtl\n" + obj);
                 }});
  out.push_back({"pbrt Include", "scene.pbrt", ".pbrt", pbrt("Include", "")});
  out.push_back({"pbrt Import", "scene.pbrt", ".pbrt", pbrt("Import", "")});
  out.push_back(
      {"pbrt plymesh", "scene.pbrt", ".ply", pbrt("Shape \"plymesh\" \"string filename\"", "")});
  out.push_back({"pbrt imagemap", "scene.pbrt", ".png",
                 pbrt("Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\"",
                      "\nMaterial \"diffuse\" \"texture reflectance\" \"t\"")});
  out.push_back({"pbrt spectrum", "scene.pbrt", ".spd",
                 pbrt("Material \"diffuse\" \"spectrum reflectance\"", "")});
  out.push_back({"pbrt infinite light", "scene.pbrt", ".png",
                 pbrt("LightSource \"infinite\" \"string filename\"", "")});
  out.push_back({"pbrt area light", "scene.pbrt", ".png",
                 pbrt("AreaLightSource \"diffuse\" \"string filename\"", "")});
  return out;
}

}  // namespace lte::test
