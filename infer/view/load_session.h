// From the command line of lte_view to a session and its first view.
#pragma once

#include <memory>

#include "infer/session/session.h"
#include "infer/view/view_command.h"
#include "infer/view/view_loop.h"
#include "lte/cli/command_files.h"

namespace lte::infer::view {

struct LoadedSession {
  std::unique_ptr<Session> session;
  ViewState first;
};

/// Loads scene and network, and encodes.
/// @param files  that know what is written; asked when all has been read
/// @throws lte::Error for a scene, camera or model that cannot be used
LoadedSession load_session(const ViewRequest& request, const CommandFiles& files);

}  // namespace lte::infer::view
