#include "train/distributed/process_group.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <condition_variable>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <future>
#include <map>
#include <mutex>
#include <thread>
#include <type_traits>
#include <unordered_map>

#include <ATen/ops/zeros.h>
#include <c10/util/Logging.h>
#include <torch/csrc/distributed/c10d/ProcessGroup.hpp>
#include <torch/csrc/distributed/c10d/TCPStore.hpp>
#include <torch/csrc/distributed/c10d/reducer.hpp>
#include <unistd.h>

#include "lte/base/check.h"
#include "lte/base/text.h"
#include "train/distributed/process_group_backend.h"

namespace lte::train {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr seconds kHeartbeat{1};
/// A living process misses no heartbeat for so long, unless its machine is badly overloaded.
constexpr milliseconds kSilence{3500};
/// For a store's answers, beyond the network's delay.
constexpr milliseconds kPatience{1500};
/// Whose fault the first process to find out says it is.
constexpr const char* kVerdict = "lte/verdict";

std::string key(const char* what, int rank) { return concat("lte/", what, "/", rank); }

std::string this_process() {
  std::array<char, 256> host{};
  gethostname(host.data(), host.size() - 1);
  return concat("host ", host.data(), ", process ", getpid());
}

c10::intrusive_ptr<c10d::TCPStore> open_store(const Rank& rank, bool serve, seconds timeout) {
  c10d::TCPStoreOptions options;
  options.port = rank.port;
  options.isServer = serve;
  options.numWorkers = static_cast<size_t>(rank.count);
  options.waitWorkers = false;
  options.timeout = timeout;
  return c10::make_intrusive<c10d::TCPStore>(rank.address, options);
}

/// What a process has written last; empty if nothing.
std::string read(c10d::Store& store, const std::string& name) {
  if (!store.check({name})) return "";
  const std::vector<uint8_t> bytes = store.get(name);
  return {bytes.begin(), bytes.end()};
}

void write(c10d::Store& store, const std::string& name, const std::string& text) {
  store.set(name, std::vector<uint8_t>(text.begin(), text.end()));
}

}  // namespace

/// Counts up in the store while it lives, and looks for a verdict there: a process that waits for
/// one which waits for the culprit hears of it only when rank 0 leaves, and then the store is gone.
class Heartbeat {
 public:
  Heartbeat(c10::intrusive_ptr<c10d::Store> store, int rank) {
    std::thread(beat, shared_, std::move(store), key("alive", rank)).detach();
  }
  ~Heartbeat() {
    const std::lock_guard lock(shared_->mutex);
    shared_->stop = true;
    shared_->wake.notify_all();
  }
  Heartbeat(const Heartbeat&) = delete;
  Heartbeat& operator=(const Heartbeat&) = delete;

  /// As of the last beat; empty if there was none.
  std::string verdict() const {
    const std::lock_guard lock(shared_->mutex);
    return shared_->verdict;
  }

 private:
  /// Outlives the heartbeat while its thread waits for a store that hangs.
  struct Shared {
    std::mutex mutex;
    std::condition_variable wake;
    std::string verdict;
    bool stop = false;
  };

  static void beat(const std::shared_ptr<Shared>& shared,
                   const c10::intrusive_ptr<c10d::Store>& store, const std::string& name) {
    try {
      for (int64_t count = 1;; ++count) {
        write(*store, name, std::to_string(count));
        std::string verdict = read(*store, kVerdict);
        std::unique_lock lock(shared->mutex);
        shared->verdict = std::move(verdict);
        if (shared->wake.wait_for(lock, kHeartbeat, [&] { return shared->stop; })) return;
      }
    } catch (const std::exception&) {
      return;  // rank 0 is gone; the next collective finds out
    }
  }

  std::shared_ptr<Shared> shared_ = std::make_shared<Shared>();
};

struct ProcessGroup::State {
  c10::intrusive_ptr<c10d::TCPStore> store;  ///< of the collectives
  c10::intrusive_ptr<c10d::TCPStore> board;  ///< where processes show themselves: never blocked
  c10::intrusive_ptr<c10d::ProcessGroup> group;
  std::unique_ptr<Heartbeat> heartbeat;
  std::atomic<int64_t> step = 0;

  std::string others_faults(const Rank& mine);
  std::string fault_of(int rank, const std::string& last_beat) const;
};

ProcessGroup::ProcessGroup(const Rank& rank, at::Device device, seconds timeout)
    : rank_(rank), device_(device), state_(std::make_shared<State>()) {
  // A failure is logged once, in a line, not by every layer of LibTorch with its backtrace.
  setenv("TORCH_CPP_LOG_LEVEL", "ERROR", /*overwrite=*/0);
  c10::initLogging();
  // What is sent to a process that has just died fails with an error that is logged, not with the
  // end of this one.
  std::signal(SIGPIPE, SIG_IGN);
  try {
    state_->store = open_store(rank, rank.leads(), timeout);
    state_->board = open_store(rank, false, timeout);
    write(*state_->board, key("who", rank.index), this_process());
    state_->heartbeat = std::make_unique<Heartbeat>(open_store(rank, false, timeout), rank.index);
    state_->group = make_backend(state_->store, rank, device, timeout);
    wait_for_all();
  } catch (const std::exception& error) {
    const std::string missing = state_->board ? others_faults() : "";
    throw Error(concat("rank ", rank.index, " of ", rank.count, ", meeting at ", rank.address, ":",
                       rank.port, ": ", missing.empty() ? first_line(error.what()) : missing));
  }
}

ProcessGroup::~ProcessGroup() = default;

std::vector<double> ProcessGroup::sum(const std::vector<double>& values) {
  // One entry more, so that there is something to send.
  at::Tensor tensor = at::zeros({static_cast<int64_t>(values.size()) + 1}, at::kDouble);
  std::copy(values.begin(), values.end(), tensor.data_ptr<double>());
  std::vector<at::Tensor> tensors{tensor.to(device_)};
  state_->group->allreduce(tensors)->wait();
  tensor = tensors[0].cpu();
  return {tensor.const_data_ptr<double>(), tensor.const_data_ptr<double>() + values.size()};
}

void ProcessGroup::broadcast(const std::vector<at::Tensor>& tensors) {
  const at::NoGradGuard no_grad;
  for (const at::Tensor& tensor : tensors) {
    at::Tensor whole = tensor.detach().contiguous();
    std::vector<at::Tensor> one{whole};
    state_->group->broadcast(one)->wait();
    if (!whole.is_alias_of(tensor)) tensor.detach().copy_(whole);
  }
}

void ProcessGroup::begin_step(int64_t step) {
  state_->step = step;
  write(*state_->board, key("step", rank_.index), std::to_string(step));
}

void ProcessGroup::explain(const std::exception& error) {
  const std::string faults = others_faults();
  if (!faults.empty()) {
    const int64_t step = state_->step;
    throw Error(concat("rank ", rank_.index, step > 0 ? concat(", step ", step) : "",
                       ": cannot go on: ", faults,
                       "; start again with --resume, with as many processes as you like"));
  }
  try {
    write(*state_->board, key("failure", rank_.index), first_line(error.what()));
  } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch): rank 0 is gone, nobody listens
  }
  throw;
}

std::string ProcessGroup::others_faults() {
  // A store whose server hangs never answers: the look at it may have to be left behind.
  std::promise<std::string> promise;
  std::future<std::string> faults = promise.get_future();
  std::thread([state = state_, rank = rank_, answer = std::move(promise)]() mutable {
    answer.set_value(state->others_faults(rank));
  }).detach();
  if (faults.wait_for(kSilence + 3 * kHeartbeat + kPatience) == std::future_status::ready)
    return faults.get();
  return concat("rank 0 (", rank_.address, ":", rank_.port, ") hangs");
}

std::string ProcessGroup::State::others_faults(const Rank& mine) {
  try {
    std::map<int, std::string> before;
    for (int rank = 0; rank < mine.count; ++rank) before[rank] = read(*board, key("alive", rank));
    std::this_thread::sleep_for(kSilence);
    std::string faults = read(*board, kVerdict);
    if (faults.empty()) {
      for (int rank = 0; rank < mine.count; ++rank) {
        const std::string fault = rank == mine.index ? "" : fault_of(rank, before[rank]);
        if (fault.empty()) continue;
        const std::string who = read(*board, key("who", rank));
        faults += concat(faults.empty() ? "" : "; ", "rank ", rank,
                         who.empty() ? "" : " (" + who + ")", " ", fault);
      }
      if (!faults.empty()) write(*board, kVerdict, faults);
    }
    // The board goes with rank 0: every process has looked at it by then.
    if (mine.leads()) std::this_thread::sleep_for(3 * kHeartbeat);
    return faults;
  } catch (const std::exception&) {
    const std::string verdict = heartbeat ? heartbeat->verdict() : "";
    if (!verdict.empty()) return verdict;
    return concat("rank 0 (", mine.address, ":", mine.port, ") is gone");
  }
}

/// @param last_beat  of some seconds ago
std::string ProcessGroup::State::fault_of(int rank, const std::string& last_beat) const {
  const std::string failure = read(*board, key("failure", rank));
  if (!failure.empty()) return "gave up: " + failure;
  const std::string now = read(*board, key("alive", rank));
  if (now.empty()) return "never came";
  if (now == last_beat) return "is gone or hangs";
  const std::string at = read(*board, key("step", rank));
  if (!at.empty() && std::stoll(at) < step)
    return concat("has not begun step ", step, ", it is at ", at);
  return "";
}

namespace {

/// LibTorch appends parameters to Reducer's constructor from release to release.
template <typename Reducer, typename... Args>
std::unique_ptr<Reducer> make_reducer(Args&&... args) {
  constexpr bool kSkipUnused = false, kPythonReducer = false;
  using Caps = std::vector<int64_t>;
  if constexpr (std::is_constructible_v<Reducer, Args..., bool, bool, Caps>) {
    return std::make_unique<Reducer>(std::forward<Args>(args)..., kSkipUnused, kPythonReducer,
                                     Caps{});
  } else {
    return std::make_unique<Reducer>(std::forward<Args>(args)..., kSkipUnused, kPythonReducer);
  }
}

}  // namespace

struct GradientReducer::State {
  std::unique_ptr<c10d::Reducer> reducer;
};

GradientReducer::GradientReducer(ProcessGroup& group, const std::vector<at::Tensor>& parameters)
    : state_(std::make_unique<State>()) {
  constexpr int64_t kFirst = c10d::kDefaultFirstBucketBytes, kCap = c10d::kDefaultBucketBytesCap;
  constexpr bool kFindUnused = false, kGradientsAreViews = false;
  const std::vector<bool> sparse(parameters.size(), false);
  auto buckets = std::get<0>(
      c10d::compute_bucket_assignment_by_size(parameters, {size_t{kFirst}, size_t{kCap}}, sparse));
  // The backward pass meets the last layers first.
  std::reverse(buckets.begin(), buckets.end());
  state_->reducer = make_reducer<c10d::Reducer>(parameters, buckets, group.state_->group, sparse,
                                                kCap, kFindUnused, kGradientsAreViews,
                                                std::unordered_map<size_t, std::string>{}, kFirst);
}

GradientReducer::~GradientReducer() = default;

void GradientReducer::reduce_next_backward() {
  state_->reducer->rebuild_buckets();  // once, in the order in which gradients turned out to come
  state_->reducer->prepare_for_forward();
  state_->reducer->prepare_for_backward({});
}

}  // namespace lte::train
