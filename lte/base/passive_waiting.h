// OpenMP's threads that sleep while they wait, for all of this process.
#pragma once

namespace lte {

/// Makes the threads of GCC's OpenMP library, which LibTorch computes with, sleep soon after their
/// work is done. By default each spins 300,000 times first, some milliseconds: free on an idle
/// machine, but where another process has work, spinning threads keep processors from those that
/// they wait for, and small steps take twenty times as long (docs/benchmarks.md).
///
/// The library reads OMP_WAIT_POLICY when it is loaded, before any of our code runs. But it spins
/// only 100 times while it manages more threads than there are processors. So this opens a team of
/// one thread more than processors, in the instance of the library that LibTorch's calls reach, and
/// lets its members sleep until the process ends. They run nothing, take no signals, and cost some
/// kilobytes each.
///
/// Only the first call does anything. Nothing is done where OMP_WAIT_POLICY or GOMP_SPINCOUNT is
/// set, where the OpenMP library is none or another one, and where the system would not give twice
/// as many threads: that library ends the process when it can start no thread.
/// @return  whether such a team sleeps
bool wait_passively() noexcept;

/// Whether the system gives `count` threads more, tried by starting them.
bool can_start_threads(int count) noexcept;

}  // namespace lte
