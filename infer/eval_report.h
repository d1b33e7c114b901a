// An evaluation as JSON, as a table for people, and as files of a report folder.
#pragma once

#include <filesystem>
#include <string>

#include "infer/evaluate.h"

namespace lte::infer {

/// {"split","scenes","metrics":{NAME:{"points":{..},"views":{..}}},"median":{..},"per_scene":[..]};
/// a figure that could not be measured is null. `checkpoint` and `data` are recorded as given.
std::string eval_json(const EvalResult& result, const std::string& checkpoint,
                      const std::string& data);

/// Mean and median of every metric by predictor, and the network's figures scene by scene.
std::string eval_table(const EvalResult& result);

/// One line a scene and predictor.
std::string eval_csv(const EvalResult& result);

/// Reference | network | difference of one view as <folder>/<scene>_view<k>.png. The first two
/// share an exposure that brings the reference's 99th percentile to white; the difference is |Δ
/// luminance| at that exposure, false colour from 0 to 0.25 of white.
void write_contact_sheet(const std::filesystem::path& folder, const ViewPicture& picture);

}  // namespace lte::infer
