// From the command line of lte_view to a session and its first view.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "infer/session/session.h"
#include "infer/view/view_command.h"
#include "infer/view/view_loop.h"
#include "lte/cli/command_files.h"

namespace lte::infer::view {

struct LoadedSession {
  std::unique_ptr<Session> session;
  ViewState first;
};

/// Scene points that a live scene is shown by at most, unless more are asked for.
inline constexpr int64_t kMostLivePoints = 4096;

/// How many scene points a live scene is shown by: as many as `asked`, or, where that is 0, as many
/// as the model was trained on. By default these, but 4,096 at most: an edit traces light on all of
/// them anew.
int64_t live_scene_points(const std::optional<int64_t>& asked, int64_t trained);

/// Loads scene and network, and encodes.
/// @param files  that know what is written; asked when all has been read
/// @throws lte::Error for a scene, camera or model that cannot be used
LoadedSession load_session(const ViewRequest& request, const CommandFiles& files);

}  // namespace lte::infer::view
