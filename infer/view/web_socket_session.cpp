#include "infer/view/web_socket_session.h"

#include <chrono>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/websocket/rfc6455.hpp>

#include "infer/view/replies.h"
#include "lte/base/check.h"

namespace lte::infer::view {
namespace {

namespace beast = boost::beast;
namespace websocket = beast::websocket;

}  // namespace

WebSocketSession::WebSocketSession(beast::tcp_stream&& stream, Hub* hub, std::shared_ptr<int> open)
    : socket_(std::move(stream)), hub_(hub), open_(std::move(open)) {
  ++*open_;
  socket_.read_message_max(kMaxMessageBytes);
  websocket::stream_base::timeout timeout{};
  timeout.handshake_timeout = std::chrono::seconds(10);
  timeout.idle_timeout = std::chrono::seconds(30);  // a ping goes out after half of it
  timeout.keep_alive_pings = true;
  socket_.set_option(timeout);
}

WebSocketSession::~WebSocketSession() { --*open_; }

void WebSocketSession::run(const Upgrade& request) {
  beast::get_lowest_layer(socket_).expires_never();  // the WebSocket has timeouts of its own
  socket_.async_accept(request, [self = shared_from_this()](beast::error_code error) {
    if (error) return;
    self->client_ = self->hub_->join(self);
    if (self->client_ == 0) {
      self->send_text(std::make_shared<const std::string>(
          failed_reply(concat("there are ", Hub::kMaxPages, " pages already"))));
      return self->close();
    }
    self->read();
  });
}

void WebSocketSession::read() {
  socket_.async_read(buffer_, [self = shared_from_this()](beast::error_code error, size_t) {
    self->on_read(error);
  });
}

void WebSocketSession::on_read(beast::error_code error) {
  if (error) return leave();  // closed, timed out, or a frame that is too large
  if (!socket_.got_text()) {
    refuse("expected a text frame");
    return close();
  }
  const std::string text = beast::buffers_to_string(buffer_.data());
  buffer_.consume(buffer_.size());
  try {
    const bool known = conversation_.welcomed();
    const Message message = conversation_.next(text);
    if (!known) {
      hub_->welcomed(client_);
    } else if (const auto* shows = std::get_if<Shows>(&message.request)) {
      while (!under_way_.empty() && under_way_.front() <= shows->picture) under_way_.pop_front();
      write();
    } else {
      hub_->said(client_, message);
    }
  } catch (const Error& fault) {
    refuse(fault.what());
    if (conversation_.over()) return close();
  }
  read();
}

void WebSocketSession::refuse(const std::string& line) {
  send_text(std::make_shared<const std::string>(error_reply(line)));
}

void WebSocketSession::send_text(const std::shared_ptr<const std::string>& text) {
  enqueue({text, true});
}

void WebSocketSession::send_file(const std::shared_ptr<const std::string>& frame) {
  enqueue({frame, false});
}

void WebSocketSession::send_picture(int64_t picture,
                                    const std::shared_ptr<const std::string>& frame) {
  if (!conversation_.welcomed()) return;
  picture_ = frame;
  picture_number_ = picture;
  write();
}

void WebSocketSession::enqueue(Outgoing outgoing) {
  if (closing_) return;
  waiting_.push_back(std::move(outgoing));
  if (waiting_.size() > kMaxWaiting) {
    beast::get_lowest_layer(socket_).cancel();
    return;
  }
  write();
}

void WebSocketSession::write() {
  if (writing_ || closed_) return;
  if (!waiting_.empty()) {
    writing_ = std::move(waiting_.front());
    waiting_.pop_front();
  } else if (closing_) {
    return begin_close();
  } else if (picture_ && under_way_.size() < kAhead) {
    writing_ = Outgoing{std::exchange(picture_, nullptr), false};
    under_way_.push_back(picture_number_);
  } else {
    return;
  }
  socket_.text(writing_->text);
  socket_.async_write(boost::asio::buffer(*writing_->bytes),
                      [self = shared_from_this()](beast::error_code error, size_t) {
                        self->writing_.reset();
                        if (error) return self->leave();
                        self->write();
                      });
}

void WebSocketSession::close() {
  closing_ = true;
  write();
}

void WebSocketSession::begin_close() {
  closed_ = true;
  socket_.async_close(websocket::close_code::normal,
                      [self = shared_from_this()](beast::error_code) { self->leave(); });
}

void WebSocketSession::leave() {
  closed_ = true;
  if (client_ > 0) hub_->leave(client_, conversation_.welcomed());
  client_ = 0;
}

}  // namespace lte::infer::view
