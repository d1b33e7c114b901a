// Whether threads of a team sleep or spin between pieces of work, by the kernel's count.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <thread>

#include <unistd.h>

namespace lte::test {

/// How often threads other than the calling one have given up their processor of their own accord,
/// which a thread that spins does not.
inline int64_t sleeps_of_other_threads() {
  int64_t sum = 0;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    if (task.path().filename() == std::to_string(::gettid())) continue;
    std::ifstream status(task.path() / "status");
    const std::string key = "voluntary_ctxt_switches:";
    for (std::string line; std::getline(status, line);)
      if (line.starts_with(key)) sum += std::stoll(line.substr(key.size()));
  }
  return sum;
}

/// How often the other threads went to sleep while `work`, which a team does, was done `times`
/// times, with pauses that are shorter than the team's spinning would be by default.
inline int64_t worker_sleeps(int times, const std::function<void()>& work) {
  work();  // the team is there
  const int64_t first = sleeps_of_other_threads();
  for (int i = 0; i < times; ++i) {
    work();
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  return sleeps_of_other_threads() - first;
}

}  // namespace lte::test
