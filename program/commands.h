// All tools as one program: `lte render room.glb` is `lte_render room.glb`.
#pragma once

namespace lte {

/// Runs the tool that the first argument names, or argv[0] where that is a tool's name, as of a
/// link lte_render to lte. A tool that this build has not is one line on standard error.
///
/// @return  its exit code; 2 where no command is named, or one that there is not
int run_command(int argc, char** argv);

}  // namespace lte
