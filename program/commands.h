// All tools as one program: `lte render room.glb` is `lte_render room.glb`.
#pragma once

#include <string>

namespace lte {

/// Where the tools are that need LibTorch, of which a build may have none.
struct TorchTools {
  std::string program;    ///< a program lte that has them; empty: there is none
  std::string libraries;  ///< LD_LIBRARY_PATH of that program; empty: this process's
  std::string advice;     ///< what to do where there is none, for the line that says so
};

/// Runs the tool that the first argument names, or argv[0] where that is a tool's name, as of a
/// link lte_render to lte. What this build lacks and `torch.program` has takes this process's
/// place; what neither has is one line on standard error.
///
/// @return  its exit code; 2 where no command is named, or one that there is not
int run_command(int argc, char** argv, const TorchTools& torch = {});

}  // namespace lte
