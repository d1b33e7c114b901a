#include "datagen/dataset/join.h"

#include <algorithm>
#include <set>
#include <string>
#include <system_error>

#include "lte/base/check.h"
#include "lte/base/version.h"

namespace lte::datagen {
namespace {

namespace fs = std::filesystem;

/// A scene and the file that holds it.
struct Source {
  data::DatasetEntry entry;
  fs::path file;
};

void check_alike(const data::DatasetInfo& first, const data::DatasetInfo& other,
                 const std::string& where, const std::string& of) {
  LTE_CHECK(other.scale == first.scale, where, ": its scale is ", other.scale, " m, but that of ",
            of, " is ", first.scale, " m");
  LTE_CHECK(other.pruned == first.pruned, where, ": its points were drawn ",
            other.pruned ? "only where light reaches them" : "on all surfaces",
            ", unlike those of ", of);
  LTE_CHECK(other.light_paths == first.light_paths && other.light_depth == first.light_depth, where,
            ": its light estimates have ", other.light_paths, " paths of depth ", other.light_depth,
            ", but those of ", of, " ", first.light_paths, " of depth ", first.light_depth);
}

/// "data/homes" and "data/homes/" -> "homes".
std::string folder_name(const fs::path& set) {
  const fs::path whole = fs::weakly_canonical(set);
  return whole.filename().string();
}

/// Gives the scene a name that is not in `names`, and adds it.
void choose_name(const fs::path& set, std::set<std::string>* names, Source* source) {
  std::string& name = source->entry.name;
  if (names->insert(name).second) return;
  name = concat(folder_name(set), "_", name);
  LTE_CHECK(names->insert(name).second, set.string(), ": a scene called ", name,
            " is there already; rename one of the directories");
}

/// A second name of the same file, or a copy of it on another file system.
void place(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::create_hard_link(from, to, error);
  if (!error) return;
  fs::copy_file(from, to, error);
  LTE_CHECK(!error, to.string(), ": cannot be written: ", error.message());
}

void make_folder(const fs::path& out) {
  LTE_CHECK(!fs::exists(out) || (fs::is_directory(out) && fs::is_empty(out)), out.string(),
            ": exists and is not empty; name a new directory");
  std::error_code error;
  fs::create_directories(out / "scenes", error);
  LTE_CHECK(!error, out.string(), ": cannot be made: ", error.message());
}

}  // namespace

data::DatasetInfo join(const std::vector<fs::path>& sets, const fs::path& out) {
  LTE_CHECK(sets.size() >= 2, "name at least two data sets to join");
  data::DatasetInfo joined;
  std::vector<Source> sources;
  std::set<std::string> names;
  for (size_t i = 0; i < sets.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      LTE_CHECK(fs::weakly_canonical(sets[i]) != fs::weakly_canonical(sets[j]), sets[i].string(),
                ": is named twice");
    }
    const data::DatasetInfo info = data::read_dataset_info(sets[i]);
    if (i == 0) {
      joined = info;
    } else {
      check_alike(joined, info, sets[i].string(), sets.front().string());
      joined.suns = joined.suns || info.suns;
    }
    for (const data::DatasetEntry& entry : info.scenes) {
      sources.push_back({entry, data::scene_path(sets[i], entry.name)});
      choose_name(sets[i], &names, &sources.back());
    }
  }
  make_folder(out);
  joined.tool_version = version();
  joined.scenes.clear();
  for (const Source& source : sources) {
    place(source.file, data::scene_path(out, source.entry.name));
    joined.scenes.push_back(source.entry);
  }
  joined.planned = static_cast<int64_t>(joined.scenes.size());
  data::write_dataset_info(out, joined);
  return joined;
}

}  // namespace lte::datagen
