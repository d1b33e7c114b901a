// `lte_train average MODEL MODEL... --out FILE`: one model whose weights are the mean of those of
// others.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lte/cli/cli.h"

namespace lte::train {

struct AverageOptions {
  std::vector<std::filesystem::path> models;
  std::filesystem::path out;
  std::string log_file;
};

/// Adds the subcommand. @return it, to ask whether it was given
CLI::App* add_average_command(CLI::App& app, AverageOptions* options);

/// Writes the mean of the models' weights, atomically, with the configuration and the metadata of
/// the first one, but for the patch size: that is the largest of theirs. It answers well where they
/// lie in one valley of the loss, as models do of which one was trained on from another; it then
/// often does better than each (Wortsman et al. 2022, Model soups).
/// @return a line for the user
/// @throws lte::Error naming a file that is no model, of another shape than the first, or that
///         cannot be written, or an output that is one of the inputs.
std::string average_models(const AverageOptions& options);

}  // namespace lte::train
