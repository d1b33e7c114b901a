#include "infer/view/conversation.h"

#include "lte/base/check.h"

namespace lte::infer::view {

Message Conversation::checked(std::string_view text) {
  Message message = parse_message(text);
  const auto* hello = std::get_if<Hello>(&message.request);
  if (!welcomed_) {
    over_ = true;  // unless all is well
    LTE_CHECK(hello != nullptr, "expected hello as the first message");
    LTE_CHECK(hello->protocol == kProtocol, "the page speaks version ", hello->protocol,
              ", the server version ", kProtocol, ": reload the page");
    over_ = false;
    welcomed_ = true;
  } else {
    LTE_CHECK(hello == nullptr, "hello a second time");
  }
  LTE_CHECK(message.number > last_, "message ", message.number, " after message ", last_,
            ": expected numbers that rise");
  last_ = message.number;
  return message;
}

Message Conversation::next(std::string_view text) {
  try {
    return checked(text);
  } catch (const Error&) {
    if (!welcomed_ || ++faults_ >= kMaxFaults) over_ = true;
    throw;
  }
}

}  // namespace lte::infer::view
