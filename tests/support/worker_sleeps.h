// Whether threads of LibTorch's team sleep or spin between pieces of work, by the kernel's count.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include <ATen/ATen.h>
#include <ATen/Parallel.h>
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

/// How often a team of two went to sleep while it was given work `times` times, with pauses that
/// are shorter than its spinning would be by default.
inline int64_t worker_sleeps(int times) {
  const int before = at::get_num_threads();
  at::set_num_threads(2);
  at::Tensor work = at::zeros({1 << 20});
  work.add_(1);  // the team is there
  const int64_t first = sleeps_of_other_threads();
  for (int i = 0; i < times; ++i) {
    work.add_(1);
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  const int64_t sleeps = sleeps_of_other_threads() - first;
  at::set_num_threads(before);
  return sleeps;
}

}  // namespace lte::test
