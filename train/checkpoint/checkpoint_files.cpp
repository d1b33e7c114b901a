#include "train/checkpoint/checkpoint_files.h"

#include <algorithm>
#include <limits>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/base/to_number.h"
#include "train/checkpoint/checkpoint.h"

namespace lte::train {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPrefix = "checkpoint_", kSuffix = ".safetensors";
/// The step of the newest file if it cannot be read: so it is looked at first, and then said to be
/// damaged.
constexpr int64_t kUnknownStep = std::numeric_limits<int64_t>::max();

/// STEP of a name checkpoint_STEP.safetensors.
std::optional<int64_t> step_in_name(std::string_view name) {
  if (!name.starts_with(kPrefix) || !name.ends_with(kSuffix) ||
      name.size() <= kPrefix.size() + kSuffix.size())
    return std::nullopt;
  name = name.substr(kPrefix.size(), name.size() - kPrefix.size() - kSuffix.size());
  const auto step = to_number<int64_t>(name);
  return step && *step >= 0 ? step : std::nullopt;
}

int64_t step_in_file(const fs::path& path) {
  try {
    return read_checkpoint_header(path).progress.step;
  } catch (const std::exception&) {
    return kUnknownStep;
  }
}

void rename_file(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::rename(from, to, error);
  LTE_CHECK(!error, from.string(), ": cannot rename to ", to.filename().string(), ": ",
            error.message());
}

}  // namespace

fs::path best_checkpoint_path(const fs::path& run) { return run / "checkpoint_best.safetensors"; }

fs::path CheckpointFiles::path_of(int64_t step) const {
  return run_ / concat(kPrefix, step, kSuffix);
}

std::vector<CheckpointFiles::Entry> CheckpointFiles::list() const {
  std::vector<Entry> entries;
  const fs::path newest = checkpoint_path(run_), best = best_checkpoint_path(run_);
  if (fs::exists(newest)) entries.push_back({newest, step_in_file(newest)});
  std::error_code ignored;  // a directory that is not there has none
  for (const auto& file : fs::directory_iterator(run_, ignored)) {
    const auto step = step_in_name(file.path().filename().string());
    if (step) entries.push_back({file.path(), *step});
  }
  // The best one comes last among equals: it may be the newest one under another name.
  if (fs::exists(best)) {
    const int64_t step = step_in_file(best);
    entries.push_back({best, step == kUnknownStep ? -1 : step});
  }
  std::stable_sort(entries.begin(), entries.end(),
                   [](const Entry& a, const Entry& b) { return a.step > b.step; });
  return entries;
}

fs::path CheckpointFiles::newest_whole(bool warn) {
  const std::vector<Entry> entries = list();
  LTE_CHECK(!entries.empty(), checkpoint_path(run_).string(),
            ": nothing to resume; leave out --resume to start a run");
  std::string faults;
  for (const Entry& entry : entries) {
    const std::optional<std::string> damage = checkpoint_damage(entry.path);
    if (!damage) {
      if (warn && !faults.empty())
        log_warning("damaged: ", faults, "; going on from ", entry.path.string(), " instead, step ",
                    entry.step);
      return entry.path;
    }
    faults += (faults.empty() ? "" : "; ") + *damage;
    damaged_.insert(entry.path);
  }
  throw Error(concat("no checkpoint is whole: ", faults,
                     "; start anew in another directory with --out, from the weights of ",
                     model_path(run_).string(), " with --init-weights if it is whole"));
}

std::optional<fs::path> CheckpointFiles::whole_of_step(int64_t step) const {
  for (const Entry& entry : list()) {
    if (entry.step == step && !checkpoint_damage(entry.path)) return entry.path;
  }
  return std::nullopt;
}

void CheckpointFiles::add(int64_t step, const std::function<void(const fs::path&)>& write) {
  const fs::path newest = checkpoint_path(run_), written = path_of(step);
  write(written);
  // From here on only names change: at every moment the newest whole file has one.
  if (keep_ > 1 && fs::exists(newest) && !damaged_.contains(newest)) {
    const int64_t before = step_in_file(newest);
    if (before < step) rename_file(newest, path_of(before));
  }
  rename_file(written, newest);
  damaged_.erase(newest);
  damaged_.erase(written);
  prune(step);
}

void CheckpointFiles::prune(int64_t newest_step) const {
  int64_t kept = 1;  // the newest
  for (const Entry& entry : list()) {
    if (!step_in_name(entry.path.filename().string())) continue;
    const bool good = entry.step < newest_step && !damaged_.contains(entry.path);
    if (good && ++kept <= keep_) continue;
    std::error_code ignored;  // what cannot be removed now is tried again next time
    fs::remove(entry.path, ignored);
  }
}

void CheckpointFiles::keep_newest_as_best() const {
  // If the process is killed in between, remove_leftovers() knows the name.
  const fs::path newest = checkpoint_path(run_), best = best_checkpoint_path(run_),
                 link = run_ / concat('.', best.filename().string(), ".tmp-link");
  std::error_code error;
  fs::remove(link, error);
  fs::create_hard_link(newest, link, error);
  if (error) fs::copy_file(newest, link, error);
  LTE_CHECK(!error, best.string(), ": cannot write: ", error.message());
  rename_file(link, best);
}

void remove_leftovers(const fs::path& run) {
  std::error_code ignored;
  for (const auto& file : fs::directory_iterator(run, ignored)) {
    if (temporary_of(file.path().filename().string()).empty()) continue;
    std::error_code unremoved;
    fs::remove(file.path(), unremoved);
  }
}

}  // namespace lte::train
