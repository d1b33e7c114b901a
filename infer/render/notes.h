// What lte_render says about a picture beside its times: progress, and what was not shown as it is.
#pragma once

#include <filesystem>
#include <string>

#include "infer/renderer/renderer.h"
#include "lte/cli/progress.h"

namespace lte::infer {

/// Lets `settings` tell of the pixels that are done, until it is destroyed. Nothing under --quiet.
class PictureProgress {
 public:
  explicit PictureProgress(RenderSettings* settings);
  ~PictureProgress();
  PictureProgress(const PictureProgress&) = delete;
  PictureProgress& operator=(const PictureProgress&) = delete;

 private:
  RenderSettings* settings_;
  Progress progress_;
};

/// The word of --indirect for how a picture's light is made.
const char* method_word(const RenderSettings& settings, TableLight table);

/// Says in a line how indirect light is made; nothing for pictures without any.
/// @param model  the file of the network, where one is used
void say_method(const std::filesystem::path& model, const Renderer& renderer,
                const RenderSettings& settings, const TableSettings& table);

/// Says how much of what is seen is metal, and what stands for it. A warning where that is not what
/// paths would show.
void report_metal(const std::string& scene, const RenderSettings& settings, const Frame& frame);

/// Warns of a picture that is black although its camera sees surfaces and the scene has light.
void report_darkness(const std::string& scene, const std::string& camera, Output output,
                     const Frame& frame);

/// Warns where a picture's light was checked and found wrong.
/// @param by_network  the network has answered, at pixels or in the table
void report_check(const std::string& picture, bool by_network, const LightCheck& check);

}  // namespace lte::infer
