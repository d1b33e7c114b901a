// The pages that are connected, and what is on its way to them.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include <boost/asio/io_context.hpp>

#include "infer/view/messages.h"
#include "infer/view/pages.h"

namespace lte::infer::view {

class WebSocketSession;

/// What the server does with what pages say. Called by the thread of the sockets.
struct PageEvents {
  /// A page has said hello: it is sent the present state.
  std::function<void(int client)> arrived;
  std::function<void(int client, const Message& message)> said;
  std::function<void(int client)> left;
};

class Hub : public Pages {
 public:
  /// Pages at a time.
  static constexpr size_t kMaxPages = 64;

  Hub(boost::asio::io_context* io, PageEvents events);

  int count() const override { return welcomed_; }
  void tell(int client, const std::string& text) override;
  void tell_all(const std::string& text) override;
  void show(int64_t picture, const std::shared_ptr<const std::string>& frame) override;
  void give(int client, const std::shared_ptr<const std::string>& frame) override;

  // By the thread of the sockets alone:

  /// @return  the page's number, from 1; 0 if there are too many
  int join(const std::shared_ptr<WebSocketSession>& session);
  void welcomed(int client);
  void said(int client, const Message& message) { events_.said(client, message); }
  void leave(int client, bool was_greeted);
  /// Says the last words, if there are any, and closes.
  void close_all(const std::string& text);
  bool empty() const { return sessions_.empty(); }

 private:
  using SharedText = std::shared_ptr<const std::string>;
  std::shared_ptr<WebSocketSession> find(int client) const;

  boost::asio::io_context* io_;
  PageEvents events_;
  std::map<int, std::weak_ptr<WebSocketSession>> sessions_;
  int last_client_ = 0;
  int64_t picture_ = 0;
  SharedText frame_;  ///< the latest picture, for pages that come later
  std::atomic<int> welcomed_ = 0;
};

}  // namespace lte::infer::view
