// Pictures of an evaluation: one sheet a scene, one row a view.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "infer/eval/evaluate.h"
#include "lte/image/image.h"

namespace lte::infer {

/// Columns from left to right, for captions.
inline constexpr const char* kSheetColumns =
    "reference | network | path tracing with 64 paths | error of the network | error of path "
    "tracing";

/// Makes one row of a sheet, with the columns above; the two of path tracing are left out if the
/// data has none. The pictures share an exposure that brings the reference's 99th percentile to
/// white. Errors are |Δ luminance| at that exposure, in false color from 0 (black) to 0.25 of white
/// (red). Small views are enlarged by whole pixels to 192 pixels or more.
image::Image view_row(const ViewPicture& picture);

/// Collects the views of each scene and keeps <folder>/<scene>.png up to date.
class ContactSheets {
 public:
  explicit ContactSheets(std::filesystem::path folder) : folder_(std::move(folder)) {}

  void add(const ViewPicture& picture);
  /// Names of the scenes that have a sheet, in order.
  const std::vector<std::string>& scenes() const { return scenes_; }
  std::filesystem::path path(const std::string& scene) const { return folder_ / (scene + ".png"); }

 private:
  std::filesystem::path folder_;
  std::vector<std::string> scenes_;
  std::vector<image::Image> rows_;  ///< of the last scene
};

}  // namespace lte::infer
