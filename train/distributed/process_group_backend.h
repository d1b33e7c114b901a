// Which of c10d's backends carries the collectives.
#pragma once

#include <chrono>

#include <torch/csrc/distributed/c10d/ProcessGroup.hpp>

#include "train/distributed/rank.h"

namespace lte::train {

/// Gloo for the CPU, NCCL for a GPU.
/// @param store  that all processes share
/// @throws lte::Error if this build lacks the backend
c10::intrusive_ptr<c10d::ProcessGroup> make_backend(const c10::intrusive_ptr<c10d::Store>& store,
                                                    const Rank& rank, at::Device device,
                                                    std::chrono::milliseconds timeout);

}  // namespace lte::train
