#include "lte/base/process_memory.h"

#include <fstream>
#include <limits>
#include <string>

#include <malloc.h>

namespace lte {
namespace {

double status_mb(const std::string& field) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    double kilobytes = 0;
    if (word == field && status >> kilobytes) return kilobytes / 1024.0;
  }
  return 0;
}

}  // namespace

double peak_rss_mb() { return status_mb("VmHWM:"); }

double current_rss_mb() { return status_mb("VmRSS:"); }

void reset_peak_rss() {
  ::malloc_trim(0);  // what was freed, but kept by the allocator, shall not count as resident
  std::ofstream("/proc/self/clear_refs") << "5\n";  // proc(5): 5 resets VmHWM
}

void keep_freed_memory() {
#if defined(__GLIBC__)
  ::mallopt(M_MMAP_THRESHOLD, 32 << 20);  // the most that glibc accepts
  ::mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
  ::mallopt(M_TOP_PAD, 64 << 20);
#endif
}

}  // namespace lte
