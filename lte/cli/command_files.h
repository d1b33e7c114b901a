// The files that a command reads and writes. An output never replaces an input of the same command,
// nor another output.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lte/base/file.h"

namespace lte {

struct CommonOptions;

/// Made before the command reads anything.
class CommandFiles {
 public:
  /// @param flag  how messages call it: "--points", or SCENE of an argument without a flag
  /// @param path  empty: the flag was not given
  void reads(const std::string& flag, const std::filesystem::path& path);
  void writes(const std::string& flag, const std::filesystem::path& path);

  /// The same for a folder, of which `parts` (files, and folders with all that is in them) belong
  /// to what the flag names. Other files in it are other people's.
  void reads_parts(const std::string& flag, const std::filesystem::path& folder,
                   const std::vector<std::string>& parts);
  void writes_parts(const std::string& flag, const std::filesystem::path& folder,
                    const std::vector<std::string>& parts);

  /// --json and --log-file.
  void writes_common(const CommonOptions& options);

  /// Two names are one file if they lead to the same inode or, where there is no file yet, to the
  /// same place, symbolic links followed. Devices and pipes are nobody's: writing replaces nothing.
  /// @throws lte::Error naming both flags.
  void check() const;

  /// As check(), for every file that this process has read since this object was made, though no
  /// flag names it: textures of a scene, included files, parents of a configuration. Looks at
  /// outputs that are files.
  void check_what_was_read() const;

 private:
  struct Claim {
    std::string flag;
    std::filesystem::path path;   ///< as given
    std::filesystem::path place;  ///< absolute, without links
    bool whole_folder;            ///< a part of a folder, which may be a folder itself
  };
  static void claim(const std::string& flag, const std::filesystem::path& path, bool part,
                    std::vector<Claim>* claims);
  static bool overlap(const Claim& a, const Claim& b);

  std::vector<Claim> inputs_, outputs_;
  ReadWatch watch_;
};

}  // namespace lte
