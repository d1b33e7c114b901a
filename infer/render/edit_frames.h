// The pictures of --edit: a session that plays the script, a picture a frame.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "infer/render/edit_flags.h"
#include "infer/render/edit_player.h"
#include "infer/render/edit_script.h"
#include "infer/render/views.h"
#include "infer/renderer/renderer.h"
#include "infer/session/session.h"

namespace lte::infer {

/// The views of a script's frames: one camera for all, or one each. Rehearses the script, too.
///
/// @param views    of the command line
/// @param pattern  --out, with %d or %04d in it
/// @throws lte::Error as rehearse(), and if there are several cameras, but not one a frame, or
///         names of files would coincide
std::vector<View> edit_views(const EditScript& script, const scene::Scene& scene,
                             std::vector<View> views, const std::string& pattern);

/// Renders the frames of a script, in order.
class EditedFrames {
 public:
  /// Makes the light of the scene, without light that reaches nothing that any frame sees: so a
  /// frame does not depend on which others are made, and a camera that moves has nothing made anew.
  /// @param all      the views of every frame, in order
  /// @param network  of Method::Network, none otherwise
  EditedFrames(EditScript script, const std::vector<View>& all, const scene::Scene& scene,
               std::optional<runtime::Network> network, SessionSettings settings);

  /// Plays the script up to the frame of `view` and renders it.
  /// @param report   the edits as JSON: what was redone, milliseconds
  /// @param seconds  gets the stages of the picture
  Frame render(const View& view, const RenderSettings& settings, nlohmann::json* report,
               StageSeconds* seconds);

  /// The scene as the last frame had it.
  StatePtr state() const { return session_.state(); }

 private:
  void report_culled_lights();

  EditScript script_;
  Session session_;
  EditPlayer player_;
  std::map<std::string, int> frame_of_;     ///< by file name
  std::vector<std::string> culled_lights_;  ///< that a line has named last
};

}  // namespace lte::infer
