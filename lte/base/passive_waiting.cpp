#include "lte/base/passive_waiting.h"

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <latch>
#include <thread>
#include <vector>

#include <dlfcn.h>
#include <pthread.h>
#include <sched.h>
#include <unistd.h>

namespace lte {
namespace {

/// Threads that are started meanwhile take no signals: the program's handlers run in its own.
class BlockedSignals {
 public:
  BlockedSignals() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before_);
  }
  ~BlockedSignals() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  BlockedSignals(const BlockedSignals&) = delete;
  BlockedSignals& operator=(const BlockedSignals&) = delete;

 private:
  sigset_t before_;
};

/// The functions of GCC's OpenMP library in the instance that this process's calls reach. Found by
/// name, as this library links none: with a copy of its own the team would be another's.
struct OpenMp {
  using Region = void (*)(void*);

  void (*parallel)(Region, void*, unsigned threads, unsigned flags) = nullptr;
  int (*processors)() = nullptr;
  int (*team_size)() = nullptr;
  void (*set_dynamic)(int) = nullptr;

  OpenMp() {
    find("GOMP_parallel", &parallel);
    find("omp_get_num_procs", &processors);
    find("omp_get_num_threads", &team_size);
    find("omp_set_dynamic", &set_dynamic);
  }

  /// LLVM's and Intel's library has GCC's entry points too, and its own way of waiting.
  bool is_gcc() const {
    return parallel != nullptr && processors != nullptr && team_size != nullptr &&
           set_dynamic != nullptr && ::dlsym(RTLD_DEFAULT, "__kmpc_fork_call") == nullptr;
  }

 private:
  template <typename Function>
  static void find(const char* name, Function* function) {
    *function = reinterpret_cast<Function>(::dlsym(RTLD_DEFAULT, name));
  }
};

/// What the sleeping team says of itself. It outlives every function here, as the team does.
struct Team {
  OpenMp openmp;
  std::atomic<int> size{0};
};

void sleep_until_the_process_ends(void* team) {
  auto& t = *static_cast<Team*>(team);
  t.size = t.openmp.team_size();
  t.size.notify_all();
  for (;;) ::pause();
}

/// As many as the library counted when it was loaded. The calling thread may be bound to fewer; the
/// main thread is asked too.
int count_processors(const OpenMp& openmp) {
  cpu_set_t set;
  CPU_ZERO(&set);
  const bool known = ::sched_getaffinity(::getpid(), sizeof set, &set) == 0;
  return std::max(openmp.processors(), known ? CPU_COUNT(&set) : 1);
}

bool open_team() {
  if (std::getenv("OMP_WAIT_POLICY") != nullptr || std::getenv("GOMP_SPINCOUNT") != nullptr)
    return false;
  static Team team;
  if (!team.openmp.is_gcc()) return false;
  const int threads = count_processors(team.openmp) + 1;
  // As many again are LibTorch's own team.
  if (!can_start_threads(2 * threads)) return false;
  const BlockedSignals blocked;
  std::thread([threads] {
    team.openmp.set_dynamic(0);  // of this thread: the team is to be as large as is asked for
    team.openmp.parallel(sleep_until_the_process_ends, &team, static_cast<unsigned>(threads),
                         /*flags=*/0);
  }).detach();
  team.size.wait(0);
  return team.size >= threads;  // OMP_THREAD_LIMIT may have made it smaller
}

}  // namespace

bool wait_passively() noexcept {
  static const bool sleeping = [] {
    try {
      return open_team();
    } catch (const std::exception&) {  // no thread, no memory: waiting stays as it was
      return false;
    }
  }();
  return sleeping;
}

bool can_start_threads(int count) noexcept try {
  const BlockedSignals blocked;
  std::latch finished(1);
  std::vector<std::thread> threads;
  threads.reserve(static_cast<size_t>(count));
  bool all = true;
  try {
    for (int i = 0; i < count; ++i) threads.emplace_back([&finished] { finished.wait(); });
  } catch (const std::exception&) {
    all = false;
  }
  finished.count_down();
  for (std::thread& thread : threads) thread.join();
  return all;
} catch (const std::exception&) {
  return false;
}

}  // namespace lte
