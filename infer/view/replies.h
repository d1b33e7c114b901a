// What the server says to a page: JSON texts, and frames that carry a picture or a file.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "infer/check/light_check.h"
#include "infer/view/messages.h"
#include "infer/view/scene_description.h"

namespace lte::infer::view {

/// "loading" until the scene is there.
std::string welcome_reply(int client, const std::string& phase);

/// The scene as the file has it, and how it is set.
/// @param settings  of lights, materials and objects that the scene has
std::string scene_reply(const SceneDescription& scene, const std::vector<PageEdit>& settings,
                        const UndoSteps& undo);

/// Edits that a page has made, and what they cost.
std::string edits_reply(int client, const std::vector<PageEdit>& edits, const EditCost& cost,
                        const UndoSteps& undo);

std::string picked_reply(const Picked& picked);

/// What a page has added; -1 for none.
struct Added {
  int object = -1, light = -1;
};
std::string added_reply(const Added& added);

/// One line that the page shows.
std::string error_reply(const std::string& line);
/// The scene could not be loaded, or the server ends.
std::string failed_reply(const std::string& line);

/// Numbers of messages: of those that change the view, and of edits.
struct Handled {
  int64_t view = 0, edits = 0;
};

/// What stands before the JPEG of a picture.
struct PictureHeader {
  int64_t picture = 0;  ///< rises
  scene::Camera camera;
  Shown shown = Shown::Full;
  float ev = 0;
  ToneCurve curve = ToneCurve::Linear;
  PictureSize size;                 ///< of the view
  int width = 0, height = 0;        ///< of this picture, smaller in drafts
  int pass = 0;                     ///< 0 for a draft
  int passes = 0;                   ///< when it is done
  bool done = false;                ///< no better one comes
  Accuracy light = Accuracy::Full;  ///< how much its indirect light knows of the last edits
  std::string answered_by;          ///< a word of --integrator, or "paths"
  std::optional<LightCheck> check;  ///< of its indirect light
  double paths = 0;                 ///< a pixel, by now, where paths are traced
  double elapsed_ms = 0;            ///< of all passes of this picture
  double path_ms = 0;               ///< what a path a pixel takes at this size; 0: not known
  std::map<std::string, double> milliseconds;  ///< by stage
  /// By page: the last of its messages that the picture takes into account.
  std::map<int, Handled> handled;
};

/// A binary frame: four bytes with the length of the header (least first), the header as JSON, the
/// JPEG.
std::string picture_frame(const PictureHeader& header, const std::string& jpeg);

/// The same for a file to keep.
std::string file_frame(const std::string& name, const std::string& media_type,
                       const std::string& bytes);

}  // namespace lte::infer::view
