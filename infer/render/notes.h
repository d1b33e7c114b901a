// What lte_render says about a picture beside its times: progress, and what was not shown as it is.
#pragma once

#include <filesystem>
#include <string>

#include "infer/check/light_check.h"
#include "infer/renderer/renderer.h"
#include "lte/cli/progress.h"

namespace lte::infer {

/// Shows how far a picture is, until it is destroyed. Nothing under --quiet.
class PictureProgress {
 public:
  explicit PictureProgress(RenderSettings* settings);
  ~PictureProgress();
  PictureProgress(const PictureProgress&) = delete;
  PictureProgress& operator=(const PictureProgress&) = delete;

 private:
  RenderSettings* settings_;
  Progress progress_;
  int64_t shown_ = 0;
};

/// Says in a line how indirect light is computed; nothing for pictures without any.
/// @param model  the file of the network, where one is used
void say_method(const std::filesystem::path& model, const Renderer& renderer,
                const RenderSettings& settings, Method records, int64_t count);

/// Says how much of what is seen is metal, which is path-traced.
void report_metal(const std::string& scene, const RenderSettings& settings, const Frame& frame);

/// Warns of a picture that is black although its camera sees surfaces and the scene has light.
void report_darkness(const std::string& scene, const std::string& camera, Output output,
                     const Frame& frame);

/// Warns where a picture's light was checked and found wrong.
void report_check(const std::string& picture, Method records, const LightCheck& check);

}  // namespace lte::infer
