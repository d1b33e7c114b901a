#include <array>
#include <cstdint>
#include <string>

#include <nlohmann/json.hpp>

#include "lte/bake/formats/assets.h"
#include "lte/bake/formats/engine_scene.h"
#include "lte/bake/formats/formats.h"
#include "lte/base/check.h"
#include "lte/image/finite_half.h"

namespace lte::bake {
namespace {

constexpr const char* kThreeReadme = R"(Light map of {{source}} for three.js (r155 or newer).

See it: run `python3 -m http.server` in this folder and open http://localhost:8000.
Browsers load no modules from file: addresses.

In a page of your own: load scene.glb by GLTFLoader, make a DataTexture (RGBAFormat, HalfFloatType)
of the first width * height * 4 halves of lightmap.bin, set texture.channel = 1, linear filters and
needsUpdate, and set material.lightMap to it; lightMapIntensity stays 1, as values are irradiance.
Several layers follow each other; their sum is all light, and a lamp dimmed is a factor before it.
Renderer: outputColorSpace sRGB as it is, tone mapping as you like. lightmap.json has the record.
)";

/// The module's text.
std::string read_module(const std::filesystem::path& file) {
  LTE_CHECK(!file.empty(),
            "--format three needs --three FILE, three.js as an ES module with GLTFLoader and "
            "OrbitControls");
  std::string text = read_file(file);
  for (const char* name : {"GLTFLoader", "OrbitControls", "DataTexture"}) {
    LTE_CHECK(text.find(name) != std::string::npos && text.find("export") != std::string::npos,
              "--three ", file.string(), ": expected an ES module that exports three.js, ",
              "GLTFLoader and OrbitControls; it has no ", name);
  }
  return text;
}

/// [layers, height, width, 4] halves; alpha is 1.
std::string half_texels(const Lightmap& map) {
  std::string out;
  out.reserve(map.layers.size() * map.pixels() * 8);
  for (const Layer& layer : map.layers) {
    for (size_t i = 0; i < map.pixels(); ++i) {
      std::array<Half, 4> texel;
      for (size_t c = 0; c < 3; ++c) texel[c] = image::to_finite_half(layer.irradiance[3 * i + c]);
      texel[3] = to_half(1);
      out.append(reinterpret_cast<const char*>(texel.data()), sizeof(texel));
    }
  }
  return out;
}

}  // namespace

void write_three(const Lightmap& map, const FormatOptions& options, FileSet* files) {
  files->write("three.js", read_module(options.three));
  nlohmann::json about{{"width", map.width}, {"height", map.height}};
  for (const Layer& layer : map.layers) about["layers"].push_back(layer.name);
  // Inside a script, "</" would end it.
  std::string text;
  for (const char c : about.dump()) c == '<' ? text += "\\u003c" : text += c;
  std::string title;
  for (const char c : map.scene.name) title += c == '<' || c == '&' ? '_' : c;
  files->write("index.html", filled(k_three_html, {{"title", title}, {"map", text}}));
  files->write("lightmap.bin", half_texels(map));
  files->write("README.txt", filled(kThreeReadme, {{"source", map.provenance.source}}));
  write_scene_and_record(map, "lightmap.bin", "", files);
}

}  // namespace lte::bake
