// The processes of a distributed run: collectives through c10d (Gloo on CPUs, NCCL on GPUs), and
// who is missing when one of them fails.
//
// Every process runs the same collectives in the same order. Beside them each process shows once a
// second that it lives, and before each step that it has come so far, in rank 0's key-value store:
// when a collective fails or takes longer than the timeout, the others can say whose fault it was.
#pragma once

#include <chrono>
#include <cstdint>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include <ATen/core/Tensor.h>

#include "train/distributed/rank.h"

namespace lte::train {

class ProcessGroup {
 public:
  /// Meets the other processes.
  /// @param timeout  of meeting and of each collective
  /// @throws lte::Error if they do not come together in time, or this build lacks the backend
  ProcessGroup(const Rank& rank, at::Device device, std::chrono::seconds timeout);
  ~ProcessGroup();
  ProcessGroup(const ProcessGroup&) = delete;
  ProcessGroup& operator=(const ProcessGroup&) = delete;

  const Rank& rank() const { return rank_; }
  /// @return the sums of `values` over the processes
  std::vector<double> sum(const std::vector<double>& values);
  /// Returns when all processes have come here.
  void wait_for_all() { sum({}); }
  /// Makes `tensors` those of rank 0.
  void broadcast(const std::vector<at::Tensor>& tensors);

  /// Shows that this process begins `step`.
  void begin_step(int64_t step);
  /// Finds out whose fault a failure was. It is called while `error` is being caught, and takes
  /// seconds. Where another process is at fault, it throws lte::Error with what that one says or
  /// does not say any more: "rank 2 (host gpu7, process 4711) is gone or hangs". Where all others
  /// are well, the fault is this process's own: it tells them, and throws `error` again.
  [[noreturn]] void explain(const std::exception& error);

 private:
  friend class GradientReducer;
  struct State;
  std::string others_faults();

  Rank rank_;
  at::Device device_;
  std::shared_ptr<State> state_;  ///< shared with a look at the board that may never return
};

/// Averages gradients over the processes while the backward pass still runs: c10d's Reducer, which
/// sums parameters in buckets as their gradients become ready.
class GradientReducer {
 public:
  /// @param parameters  the same on every process, in the same order
  GradientReducer(ProcessGroup& group, const std::vector<at::Tensor>& parameters);
  ~GradientReducer();
  GradientReducer(const GradientReducer&) = delete;
  GradientReducer& operator=(const GradientReducer&) = delete;

  /// The next backward pass leaves the mean over processes of what each has accumulated in the
  /// parameters' gradients. Without this call a backward pass only accumulates.
  void reduce_next_backward();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lte::train
