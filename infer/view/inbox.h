// What pages have asked for and the loop has not done yet. The latest wins: it never grows with the
// number of messages.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <mutex>
#include <vector>

#include "infer/view/messages.h"

namespace lte::infer::view {

/// A request and the page it comes from.
struct Pending {
  int client = 0;
  Request request;
};

class Inbox {
 public:
  /// Requests, other than those that a later one replaces, that may wait at a time.
  static constexpr size_t kMaxPending = 1024;

  /// Takes a message. A camera replaces one that waits; so does a view, key by key. A page's edit
  /// replaces its last one of the same light, material or object, unless something that depends on
  /// the order, such as an undo or a pick, stands between them.
  /// @return  false, and nothing is kept, if too much waits already
  bool post(int client, int64_t number, const Request& request);

  /// Forgets what a page that has gone had asked for.
  void forget(int client);

  /// Wakes take() without a request: something else has changed.
  void wake();

  struct Batch {
    std::vector<Pending> requests;       ///< in the order in which they take effect
    std::map<int, int64_t> last_number;  ///< by page, of all its messages so far
  };

  /// Everything that waits. Blocks until there is something, or wake(), or for so long.
  Batch take(std::chrono::milliseconds most);
  static constexpr std::chrono::milliseconds kNoWait{0}, kAnyTime = std::chrono::hours(24);

  /// Whether anything waits: a rendering that runs may as well stop.
  bool waiting() const;

 private:
  bool replace(const Pending& pending);

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool woken_ = false;
  std::vector<Pending> pending_;
  std::map<int, int64_t> last_number_;
};

}  // namespace lte::infer::view
