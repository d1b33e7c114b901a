#include "train/loop/run_lock.h"

#include <system_error>

#include "lte/base/check.h"
#include "train/checkpoint/checkpoint_files.h"

namespace lte::train {

namespace fs = std::filesystem;

RunLock::RunLock(const fs::path& run) : run_(run), made_run_(make(run)), file_(run / ".lock") {
  LTE_CHECK(!file_.busy(), run.string(),
            ": another lte_train runs in this directory; end it, or choose another with --out");
  remove_leftovers(run);
}

RunLock::~RunLock() {
  if (kept_ || !file_.made()) return;
  file_.remove();
  std::error_code ignored;
  if (made_run_) fs::remove(run_, ignored);  // fails, as it should, if anything is in it
}

/// @return whether it was missing
bool RunLock::make(const fs::path& run) {
  std::error_code error;
  const bool made = fs::create_directories(run, error);
  LTE_CHECK(!error, run.string(), ": cannot create the run directory: ", error.message());
  return made;
}

}  // namespace lte::train
