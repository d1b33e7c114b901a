// Several data sets as one, so that a network learns from all of them at once.
#pragma once

#include <filesystem>
#include <vector>

#include "lte/data/dataset.h"

namespace lte::datagen {

/// Makes the data set `out` of all scenes of `sets`, each in its split. Files are linked where the
/// file system lets them, else copied. A scene whose name another one has is called
/// FOLDER_NAME, after the directory it comes from.
///
/// dataset.json is written last. The result has no configuration, so nothing can be generated into
/// it.
/// @throws lte::Error naming the data set if fewer than two are given, two are the same, one is
///         unfinished or differs from the first in scale, light estimates or pruning, names clash
///         all the same, or `out` is not new or empty.
data::DatasetInfo join(const std::vector<std::filesystem::path>& sets,
                       const std::filesystem::path& out);

}  // namespace lte::datagen
