#include "infer/eval_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/image/png.h"
#include "lte/image/tonemap.h"

namespace lte::infer {
namespace {

using image::Image;

constexpr int kGap = 4;                    // pixels between the pictures of a sheet
constexpr float kDifferenceRange = 0.25f;  // of white

nlohmann::json number(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
}

nlohmann::json to_json(const Scores& scores) {
  nlohmann::json out = nlohmann::json::object();
  for (const auto& [name, score] : scores) {
    nlohmann::json& entry = out[name];
    for (size_t k = 0; k < kPointMetrics.size(); ++k)
      entry["points"][kPointMetrics[k]] = number(score.points[k]);
    for (size_t k = 0; k < kViewMetrics.size(); ++k)
      entry["views"][kViewMetrics[k]] = number(score.views[k]);
  }
  return out;
}

template <typename... Args>
std::string format(const char* pattern, Args... args) {
  char line[512];
  std::snprintf(line, sizeof line, pattern, args...);
  return line;
}

std::string cell(double value) {
  return std::isfinite(value) ? format("%10.4g", value) : format("%10s", "-");
}

std::string row(const std::string& name, const Score& score) {
  std::string line = format("%-28.28s", name.c_str());
  for (const double value : score.points) line += cell(value);
  line += "  |";
  for (const double value : score.views) line += cell(value);
  return line + '\n';
}

std::string head(const std::string& title) {
  std::string line = format("%-28.28s", title.c_str());
  for (const char* name : kPointMetrics) line += format("%10s", name);
  line += "  |";
  for (const char* name : kViewMetrics) line += format("%10s", name);
  return line + '\n';
}

std::string block(const std::string& title, const Scores& scores) {
  std::string out = head(title);
  for (const auto& [name, score] : scores) out += row("  " + name, score);
  return out;
}

/// |a − b| in luminance, times `factor`, as a one-channel picture.
Image difference(const Image& a, const Image& b, float factor) {
  Image out(a.width, a.height, 1);
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x)
      *out.at(x, y) = factor * std::abs(luminance(a.rgb(x, y)) - luminance(b.rgb(x, y)));
  }
  return out;
}

void paste(const Image& picture, int left, Image* sheet) {
  for (int y = 0; y < picture.height; ++y) {
    const float* from = picture.at(0, y);
    std::copy(from, from + 3 * picture.width, sheet->at(left, y));
  }
}

}  // namespace

std::string eval_json(const EvalResult& result, const std::string& checkpoint,
                      const std::string& data) {
  nlohmann::json scenes = nlohmann::json::array();
  double encode = 0, decode = 0;
  for (const SceneResult& scene : result.scenes) {
    scenes.push_back({{"name", scene.name},
                      {"emission_scalar", scene.radiance},
                      {"reference_noise_mse", number(scene.reference_noise)},
                      {"points", scene.points},
                      {"views", scene.views},
                      {"encode_seconds", scene.encode_seconds},
                      {"decode_seconds", scene.decode_seconds},
                      {"metrics", to_json(scene.scores)}});
    encode += scene.encode_seconds, decode += scene.decode_seconds;
  }
  const nlohmann::json json = {{"split", result.split},
                               {"scenes", result.scenes.size()},
                               {"checkpoint", checkpoint},
                               {"data", data},
                               {"metrics", to_json(result.mean)},
                               {"median", to_json(result.median)},
                               {"per_scene", scenes},
                               {"seconds", {{"encode", encode}, {"decode", decode}}},
                               {"peak_rss_mb", peak_rss_mb()}};
  return json.dump(2) + '\n';
}

std::string eval_table(const EvalResult& result) {
  std::string out = format(
      "%zu scenes of split %s; indirect irradiance over the emission scalar; points | views\n\n",
      result.scenes.size(), result.split.c_str());
  for (const SceneResult& scene : result.scenes) out += block(scene.name, scene.scores);
  return out + '\n' + block("mean over scenes", result.mean) + '\n' +
         block("median over scenes", result.median);
}

std::string eval_csv(const EvalResult& result) {
  std::string out = "scene,predictor";
  for (const char* name : kPointMetrics) out += format(",points_%s", name);
  for (const char* name : kViewMetrics) out += format(",views_%s", name);
  out += '\n';
  const auto field = [](double value) {
    return std::isfinite(value) ? format(",%.9g", value) : std::string(",");
  };
  for (const SceneResult& scene : result.scenes) {
    for (const auto& [name, score] : scene.scores) {
      out += scene.name + ',' + name;
      for (const double value : score.points) out += field(value);
      for (const double value : score.views) out += field(value);
      out += '\n';
    }
  }
  return out;
}

void write_contact_sheet(const std::filesystem::path& folder, const ViewPicture& picture) {
  const data::View& view = picture.view;
  const auto exposure = static_cast<float>(white_exposure(picture.reference));
  const Image reference = fill_mask(picture.reference, view.mask, view.width, view.height);
  const Image neural = fill_mask(picture.neural, view.mask, view.width, view.height);
  Image sheet(3 * view.width + 2 * kGap, view.height, 3);
  std::fill(sheet.pixels.begin(), sheet.pixels.end(), 1.0f);
  paste(image::tonemap(reference, exposure), 0, &sheet);
  paste(image::tonemap(neural, exposure), view.width + kGap, &sheet);
  paste(image::heat_map(difference(neural, reference, exposure), kDifferenceRange),
        2 * (view.width + kGap), &sheet);
  image::write_png(folder / concat(picture.scene, "_view", picture.index, ".png"), sheet);
}

}  // namespace lte::infer
