// The memory of this process.
#pragma once

namespace lte {

/// Peak resident set, in MiB (VmHWM).
double peak_rss_mb();
/// Resident set now, in MiB.
double current_rss_mb();

/// What the machine has free for this process, in MiB: the system's estimate of what can be had
/// without swapping, and no more than a control group (a container's limit) leaves; infinity where
/// the system does not say.
double available_memory_mb();

/// Starts the peak anew from what is resident now. Nothing happens where the system does not allow
/// it.
void reset_peak_rss();

/// From now on freed memory stays with the process, for the next allocation. A training step
/// allocates and frees the same hundreds of megabytes over and over; handing pages of them back to
/// the system, and having them zeroed anew, takes a seventh of its time. Nothing happens where the
/// C library is not glibc.
void keep_freed_memory();

}  // namespace lte
