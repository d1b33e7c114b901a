// TorchScript export: a module built from C++ that other programs load without lte's headers, and
// if it is portable without lte at all. Or a model file of half the size.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace lte::torchscript {

struct ExportSize {
  int64_t scene_points = 0, queries = 0;
};

struct ExportOptions {
  std::filesystem::path model;
  std::filesystem::path out;
  bool portable = false;  ///< built-in operators alone
  /// Sizes at which the file, read again, is compared with the native model.
  std::vector<ExportSize> verify = {};
  /// Gets what begins, e.g. "comparing at 257 scene points and 100 queries".
  std::function<void(const std::string& step)> progress = {};
};

/// Deviations from the native model at one size.
struct ExportCheck {
  int64_t scene_points = 0, queries = 0;
  double relative_error = 0;  ///< of irradiance, the largest over the largest value
  /// Of radiance, the mean over the mean, where the model predicts it: rays that pass a disc's edge
  /// so narrowly that rounding decides may differ much, and are few.
  double radiance_error = 0;
};

/// Writes the module, atomically. Extra files: config.yaml (the model's configuration),
/// normalization.json (scale in metres, target, units, names of the columns in their order) and
/// version.txt. docs/torchscript.md describes the module.
/// @return one entry a size of options.verify
/// @throws lte::Error if the model cannot be read, the file cannot be written, or the module
///         deviates by more than 1e-4, in radiance 1e-3; the file is then not there.
std::vector<ExportCheck> export_torchscript(const ExportOptions& options);

/// Writes `model` as a model file with its weights rounded to bfloat16.
/// @throws lte::Error if the model cannot be read, or the file cannot be written.
void export_rounded(const std::filesystem::path& model, const std::filesystem::path& out);

}  // namespace lte::torchscript
