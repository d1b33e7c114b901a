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
  /// Encodes the scene, without light that reaches nothing that any frame sees: so a frame does not
  /// depend on which others are made, and a camera that moves has nothing encoded anew.
  /// @param all      the views of every frame, in order
  /// @param network  none for Indirect::Gather
  /// @param table    of Indirect::Gather; made anew for each frame that an edit has changed
  EditedFrames(EditScript script, const std::vector<View>& all, const scene::Scene& scene,
               std::optional<runtime::Network> network, SessionSettings settings,
               const TableSettings& table);

  /// Plays the script up to the frame of `view` and renders it.
  /// @param report   the edits as JSON: what was redone, milliseconds
  /// @param seconds  gets the stages of the picture
  Frame render(const View& view, const RenderSettings& settings, nlohmann::json* report,
               StageSeconds* seconds);

  /// Writes what the flags want beside the frames: the scene as the last frame has it, a video.
  void finish(const EditFlags& flags, const std::string& pattern);

 private:
  void say_left_out();
  Frame gather(const View& view, const RenderSettings& settings, StageSeconds* seconds);

  EditScript script_;
  Session session_;
  EditPlayer player_;
  TableSettings table_;
  std::map<std::string, int> frame_of_;  ///< by file name
  std::vector<std::string> left_out_;    ///< that a line has named last
  std::optional<Renderer> gatherer_;     ///< of the state `gathered_`, which its table is of
  StatePtr gathered_;
};

}  // namespace lte::infer
