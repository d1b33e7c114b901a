// The pictures of several cameras on disk: which of them are there already, and how they were made.
//
// Beside the pictures lies a manifest, named after their pattern: frames/%04d.png has
// frames/frames_png.json. It has what the pictures were made of and the camera of each, so that a
// run that goes on with the work of an earlier one makes no mixture.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "infer/render/views.h"
#include "infer/renderer/made_with.h"

namespace lte::infer {

/// What pictures of a given scene, network and camera are made of.
MadeWith frame_settings(CLI::App& app, const scene::Scene& scene, const runtime::Network* network);

class FrameSet {
 public:
  /// @param pattern  --out, with %d, %04d or {name} in it
  FrameSet(const std::string& pattern, MadeWith settings);

  const std::filesystem::path& manifest() const { return manifest_; }

  /// The views whose pictures are still to be made. Writes nothing.
  ///
  /// @param resume  take pictures that exist as they are
  /// @throws lte::Error naming the first picture that exists, unless `resume`; under it the
  ///         manifest, if it is missing, unreadable, or names another setting or camera.
  std::vector<View> missing(const std::vector<View>& views, bool resume);

  /// Before the first picture appears, and after missing().
  void write_manifest() const;

  /// The exposure that all pictures share: that of an earlier run, else `own`, which then goes into
  /// the manifest.
  double shared_exposure(double own);

 private:
  void check_manifest(const std::vector<View>& finished);

  std::filesystem::path manifest_;
  MadeWith settings_;
  std::map<std::string, std::string> cameras_;  ///< JSON by file name
  std::optional<double> exposure_;
};

}  // namespace lte::infer
