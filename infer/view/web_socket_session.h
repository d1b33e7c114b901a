// One page's WebSocket.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/websocket/stream.hpp>

#include "infer/view/conversation.h"
#include "infer/view/hub.h"

namespace lte::infer::view {

/// Used by one thread, that of the io_context.
///
/// Texts and files wait in a queue of bounded length. Of pictures the latest waits alone, and no
/// more than kAhead are under way that the page has not said it shows: what is old is never sent.
class WebSocketSession : public std::enable_shared_from_this<WebSocketSession> {
 public:
  using Upgrade = boost::beast::http::request<boost::beast::http::empty_body>;
  static constexpr int64_t kAhead = 2;
  /// Texts and files that may wait; a page that reads none of them is disconnected.
  static constexpr size_t kMaxWaiting = 4096;

  /// @param open  counts connections; this is one while it lives
  WebSocketSession(boost::beast::tcp_stream&& stream, Hub* hub, std::shared_ptr<int> open);
  ~WebSocketSession();

  /// Answers the upgrade and begins to read.
  void run(const Upgrade& request);

  void send_text(const std::shared_ptr<const std::string>& text);
  void send_file(const std::shared_ptr<const std::string>& frame);
  void send_picture(int64_t picture, const std::shared_ptr<const std::string>& frame);
  /// Closes when what waits has been sent.
  void close();

 private:
  struct Outgoing {
    std::shared_ptr<const std::string> bytes;
    bool text = true;
  };
  void read();
  void on_read(boost::beast::error_code error);
  void refuse(const std::string& line);
  void enqueue(Outgoing outgoing);
  void write();
  void begin_close();
  void leave();

  boost::beast::websocket::stream<boost::beast::tcp_stream> socket_;
  Hub* hub_;
  std::shared_ptr<int> open_;
  boost::beast::flat_buffer buffer_;
  Conversation conversation_;
  int client_ = 0;
  std::deque<Outgoing> waiting_;
  std::optional<Outgoing> writing_;
  std::shared_ptr<const std::string> picture_;  ///< the latest, not sent yet
  int64_t picture_number_ = 0;
  std::deque<int64_t> under_way_;  ///< pictures that were sent and not acknowledged
  bool closing_ = false, closed_ = false;
};

}  // namespace lte::infer::view
