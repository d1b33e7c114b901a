// Where the files that ship with lte lie: weights, scenes, the small test set.
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace lte {

/// Finds a shipped file: the first that exists of that in the folder of set_own_assets(),
/// <executable>/../share/lte/assets/`relative` (installed), <executable>/../../assets/`relative`
/// (build/bin of the source tree), and the assets of the source tree that was compiled. With
/// LTE_ASSETS set, only $LTE_ASSETS/`relative` is looked at.
/// @param instead  the flag that names such a file by hand, for the message
/// @throws lte::Error that lists where it looked.
std::filesystem::path asset_path(const std::string& relative, const std::string& instead);

/// The model of every tool without --checkpoint.
inline constexpr const char* kDefaultModel = "models/lte.safetensors";

/// The file of a model: kDefaultModel where `checkpoint` is empty; the shipped NAME.safetensors
/// for a NAME that is "lte" or begins with "lte-" and has neither dot nor slash; else `checkpoint`.
/// @throws lte::Error for a name of which there is no file, which says where one is to be had.
std::filesystem::path checkpoint_or_shipped(const std::string& checkpoint);

/// Models that shipped files are found of, by name, each once.
std::map<std::string, std::filesystem::path> shipped_models();

/// The assets that a program brings along which is not installed as others are. Before threads.
void set_own_assets(const std::filesystem::path& folder);
const std::filesystem::path& own_assets();

}  // namespace lte
