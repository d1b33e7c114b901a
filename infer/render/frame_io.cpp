#include "infer/render/frame_io.h"

#include <algorithm>
#include <cctype>
#include <string>
#include <vector>

#include "lte/base/check.h"
#include "lte/image/exr.h"
#include "lte/image/png.h"
#include "lte/image/tonemap.h"
#include "lte/scene/load_camera.h"

namespace lte::infer {
namespace {

using image::Image;

std::string extension_of(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

void write_layers(const std::filesystem::path& path, const Frame& frame,
                  const scene::Camera* camera) {
  std::vector<image::Layer> layers{{"", &frame.color}};
  const std::pair<const char*, const Image*> named[] = {
      {"albedo", &frame.albedo},     {"normal", &frame.normal}, {"depth", &frame.depth},
      {"emission", &frame.emission}, {"direct", &frame.direct}, {"indirect", &frame.indirect}};
  for (const auto& [name, picture] : named) {
    if (picture->width > 0) layers.push_back({name, picture});
  }
  image::ExrTexts texts;
  if (camera != nullptr) texts[scene::kCameraAttribute] = scene::camera_json(*camera);
  image::write_exr(path, layers, texts);
}

/// Normals as colors; a pixel without a hit stays black.
Image display_normal(const Frame& frame) {
  Image out = frame.normal;
  for (size_t i = 0; i < frame.depth.pixels.size(); ++i) {
    if (frame.depth.pixels[i] <= 0) continue;
    for (size_t c = 3 * i; c < 3 * i + 3; ++c)
      out.pixels[c] = std::clamp(0.5f * out.pixels[c] + 0.5f, 0.0f, 1.0f);
  }
  return out;
}

Image display_depth(const Image& depth) {
  Image out = depth;
  const float farthest = *std::max_element(depth.pixels.begin(), depth.pixels.end());
  for (float& value : out.pixels) value = farthest > 0 ? value / farthest : 0;
  return out;
}

}  // namespace

float frame_exposure(const Frame& frame, Output output) {
  if (render::is_geometry(output)) return 1;
  std::vector<uint8_t> surfaces;
  surfaces.reserve(frame.depth.pixels.size());
  for (const float depth : frame.depth.pixels) surfaces.push_back(depth > 0 ? 1 : 0);
  return image::auto_exposure(frame.color, 0.95f, 0.8f, surfaces);
}

void write_frame(const std::filesystem::path& path, const Frame& frame, Output output,
                 float exposure, const scene::Camera* camera, image::ToneCurve curve) {
  const std::string extension = extension_of(path);
  if (extension == ".exr") return write_layers(path, frame, camera);
  LTE_CHECK(extension == ".png", path.string(), ": expected a name that ends in .exr or .png");
  if (output == Output::Normal) return image::write_png(path, display_normal(frame));
  if (output == Output::Depth) return image::write_png(path, display_depth(frame.depth));
  image::write_png(path, display_frame(frame, output, exposure, curve));
}

image::DisplayPicture display_frame(const Frame& frame, Output output, float exposure,
                                    image::ToneCurve curve) {
  if (output != Output::Normal && output != Output::Depth) {
    const bool light = !render::is_geometry(output);
    return image::display(frame.color, light ? exposure : 1.0f,
                          light ? curve : image::ToneCurve::Linear);
  }
  const Image shown = output == Output::Normal ? display_normal(frame) : display_depth(frame.depth);
  const std::vector<uint8_t> bytes = image::to_bytes(shown);
  image::DisplayPicture out{shown.width, shown.height, {}};
  const auto repeats = static_cast<size_t>(3 / shown.channels);
  for (const uint8_t byte : bytes) out.bytes.insert(out.bytes.end(), repeats, byte);
  return out;
}

bool keeps_layers(const std::filesystem::path& path) { return extension_of(path) == ".exr"; }

bool is_picture_path(const std::filesystem::path& path) {
  return extension_of(path) == ".exr" || extension_of(path) == ".png";
}

}  // namespace lte::infer
