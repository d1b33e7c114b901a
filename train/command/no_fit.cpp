// Builds without scenes have nothing to fit an embedding to.
#include "lte/base/check.h"
#include "train/command/fit_command.h"

namespace lte::train {

struct FitOptions {};

FitCommand::FitCommand(CLI::App&, CommonOptions*) {}
FitCommand::~FitCommand() = default;

std::string FitCommand::run(const CommonOptions&) {
  throw Error("fit: this build has no scenes (LTE_SCENE=OFF)");
}

}  // namespace lte::train
