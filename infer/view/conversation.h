// The order in which a page may speak: hello first, then numbers that rise.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "infer/view/messages.h"

namespace lte::infer::view {

/// One page's side of the protocol, without a socket.
class Conversation {
 public:
  /// Faults, one after another or not, after which a page is sent away.
  static constexpr int kMaxFaults = 20;

  /// Reads the next message.
  /// @throws lte::Error in one line if it is refused. The page may go on, unless over().
  Message next(std::string_view text);

  bool welcomed() const { return welcomed_; }
  /// Whether the page must be disconnected: it has not said hello first, speaks another version or
  /// makes fault after fault.
  bool over() const { return over_; }

 private:
  Message checked(std::string_view text);

  bool welcomed_ = false, over_ = false;
  int64_t last_ = 0;
  int faults_ = 0;
};

}  // namespace lte::infer::view
