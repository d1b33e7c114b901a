// The one door through which importers read files.
//
// A scene is somebody else's program: it says what is to be opened. So whatever it names, however
// it is written and through whatever links, is opened here, and only where it lies in the folder of
// the scene's own file or below, or where LoadLimits::outside allows the rest. No importer touches
// the file system; scripts/check_layers.py sees to that.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lte/scene/import/limit_error.h"
#include "lte/scene/import/load_budget.h"

namespace lte::scene {

/// A regular file, mapped for reading.
class SceneFile {
 public:
  /// Maps the file behind an open descriptor, which stays the caller's.
  /// @throws lte::Error naming `path` if the system refuses.
  SceneFile(std::filesystem::path path, int descriptor, bool outside);
  ~SceneFile();
  SceneFile(const SceneFile&) = delete;
  SceneFile& operator=(const SceneFile&) = delete;

  /// As the scene's path and the reference make it, not canonical.
  const std::filesystem::path& path() const { return path_; }
  const std::string& name() const { return name_; }  ///< the path, for messages
  std::span<const std::byte> bytes() const { return {data_, size_}; }
  std::string_view text() const { return {reinterpret_cast<const char*>(data_), size_}; }
  /// Whether it lies outside the scene's folder. No message may hold anything of its content then.
  bool outside() const { return outside_; }
  /// Device and inode.
  std::pair<uint64_t, uint64_t> identity() const { return identity_; }

 private:
  std::filesystem::path path_;
  std::string name_;
  bool outside_ = false;
  std::pair<uint64_t, uint64_t> identity_;
  const std::byte* data_ = nullptr;
  size_t size_ = 0;
};

using SceneFilePtr = std::shared_ptr<const SceneFile>;

/// The files of one import, and its budget.
class SceneFiles {
 public:
  /// @param scene  the scene's own file, which the user names: its folder is that of the path, and
  /// where a link of that name leads does not matter
  SceneFiles(const std::filesystem::path& scene, const LoadLimits& limits);

  const std::filesystem::path& scene() const { return scene_; }
  LoadBudget& budget() { return budget_; }
  const LoadLimits& limits() const { return budget_.limits(); }

  /// The scene's own file.
  /// @throws lte::Error naming it: missing, a directory, not a regular file, not readable.
  SceneFilePtr open_scene();

  enum class Special { IsAnError, IsMissing };
  /// Opens what a scene names: the first of `candidates` that is a regular file and may be read.
  /// @param reference   as it is written in the scene, for messages
  /// @param where       file and element or line, for messages
  /// @param special     what a folder, a device or a pipe counts as
  /// @return null if none of them is there
  /// @throws OutsideFolder if none may be read, and one leads outside, be there a file or not.
  SceneFilePtr open(const std::vector<std::filesystem::path>& candidates,
                    const std::string& reference, const std::string& where,
                    Special special = Special::IsAnError);

 private:
  enum class Found { File, Missing, Special, Outside };
  Found look(const std::filesystem::path& path, SceneFilePtr* file);

  std::filesystem::path scene_;
  std::string folder_;  ///< canonical; empty if it is not there
  LoadBudget budget_;
  /// Files that are in use: a picture that a thousand materials name is mapped once.
  std::map<std::string, std::weak_ptr<const SceneFile>> open_;
};

/// The text of a reference as a message may show it: between quotes, short, printable.
std::string shown_reference(std::string_view reference);

/// What a message about a file outside the folder may say: its name and line, and what it is not.
std::string discreet_message(const SceneFile& file, const char* kind, std::string_view message);

/// Runs `read`. What it throws about the content of a file outside the folder loses all but place
/// and kind.
/// @param kind  what the file should have been: "PLY mesh"
template <typename Read>
auto read_discreetly(const SceneFile& file, const char* kind, const Read& read) {
  try {
    return read();
  } catch (const LimitError&) {
    throw;
  } catch (const Error& error) {
    if (!file.outside()) throw;
    throw Error(discreet_message(file, kind, error.what()));
  }
}

}  // namespace lte::scene
