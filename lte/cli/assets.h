// Where the files that ship with lte lie: weights, scenes, the small test set.
#pragma once

#include <filesystem>
#include <string>

namespace lte {

/// Finds a shipped file: the first that exists of <executable>/../share/lte/assets/`relative`
/// (installed), <executable>/../../assets/`relative` (build/bin of the source tree), and the assets
/// of the source tree that was compiled. With LTE_ASSETS set, only $LTE_ASSETS/`relative` is looked
/// at.
/// @param instead  the flag that names such a file by hand, for the message
/// @throws lte::Error that lists where it looked.
std::filesystem::path asset_path(const std::string& relative, const std::string& instead);

/// The model of every tool without --checkpoint.
inline constexpr const char* kDefaultModel = "models/lte-base.safetensors";

/// Returns `checkpoint`, or kDefaultModel where it lies if that is empty.
std::filesystem::path checkpoint_or_shipped(const std::string& checkpoint);

}  // namespace lte
