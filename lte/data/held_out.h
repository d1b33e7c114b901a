// Scenes of assets/scenes/outside: a test set, on which no model is trained or tuned.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lte/data/dataset.h"

namespace lte::data {

struct HeldOutScene {
  std::string name;      ///< of its file, without folder and extension
  std::string geometry;  ///< scene::Fingerprint::geometry of the file as it is shipped
};

/// The list of assets/scenes/outside/fingerprints.json as it was when this was built.
const std::vector<HeldOutScene>& held_out_scenes();

/// Holds scenes of a data set against the list: by their names in dataset.json, and by the name and
/// the geometry that `lte_datagen bake` records in a sample. Reads the header of each sample file;
/// one that is missing or damaged passes, as its reader has more to say.
/// @throws lte::Error naming the data set, its scene and the held-out one.
void refuse_held_out(const std::filesystem::path& directory,
                     const std::vector<DatasetEntry>& entries);

}  // namespace lte::data
