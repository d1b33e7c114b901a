#include "lte/base/process_memory.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <string>

#include <malloc.h>

namespace lte {
namespace {

/// A field of a file of procfs that counts in kB, in MiB; `otherwise` where it is not there.
double field_mb(const char* file, const std::string& field, double otherwise) {
  std::ifstream text(file);
  for (std::string word; text >> word;) {
    double kilobytes = 0;
    if (word == field && text >> kilobytes) return kilobytes / 1024.0;
  }
  return otherwise;
}

double status_mb(const std::string& field) { return field_mb("/proc/self/status", field, 0); }

/// The number of bytes in a file, in MiB; infinity where there is none, as "max" is.
double bytes_mb(const std::string& file) {
  std::ifstream text(file);
  double bytes = 0;
  return text >> bytes ? bytes / (1 << 20) : std::numeric_limits<double>::infinity();
}

/// A field of a control group's memory.stat, which counts in bytes, in MiB.
double group_field_mb(const std::string& file, const std::string& field) {
  return field_mb(file.c_str(), field, 0) / 1024;
}

/// What the control group of a container leaves, in either version of them. Files that it caches
/// give way.
double group_left_mb() {
  const std::string two = "/sys/fs/cgroup/", one = two + "memory/";
  const double left_one = bytes_mb(one + "memory.limit_in_bytes") -
                          bytes_mb(one + "memory.usage_in_bytes") +
                          group_field_mb(one + "memory.stat", "total_inactive_file") +
                          group_field_mb(one + "memory.stat", "total_active_file");
  const double left_two = bytes_mb(two + "memory.max") - bytes_mb(two + "memory.current") +
                          group_field_mb(two + "memory.stat", "inactive_file") +
                          group_field_mb(two + "memory.stat", "active_file");
  double left = std::numeric_limits<double>::infinity();
  for (const double group : {left_one, left_two}) {
    if (std::isfinite(group)) left = std::min(left, std::max(0.0, group));
  }
  return left;
}

}  // namespace

double peak_rss_mb() { return status_mb("VmHWM:"); }

double current_rss_mb() { return status_mb("VmRSS:"); }

double available_memory_mb() {
  return std::min(
      field_mb("/proc/meminfo", "MemAvailable:", std::numeric_limits<double>::infinity()),
      group_left_mb());
}

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
