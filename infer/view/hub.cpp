#include "infer/view/hub.h"

#include <utility>
#include <vector>

#include <boost/asio/post.hpp>

#include "infer/view/web_socket_session.h"

namespace lte::infer::view {

Hub::Hub(boost::asio::io_context* io, PageEvents events) : io_(io), events_(std::move(events)) {}

std::shared_ptr<WebSocketSession> Hub::find(int client) const {
  const auto found = sessions_.find(client);
  return found == sessions_.end() ? nullptr : found->second.lock();
}

void Hub::tell(int client, const std::string& text) {
  boost::asio::post(*io_, [this, client, shared = std::make_shared<const std::string>(text)] {
    if (const auto session = find(client)) session->send_text(shared);
  });
}

void Hub::tell_all(const std::string& text) {
  boost::asio::post(*io_, [this, shared = std::make_shared<const std::string>(text)] {
    for (const auto& [client, ignored] : sessions_) {
      if (const auto session = find(client)) session->send_text(shared);
    }
  });
}

void Hub::show(int64_t picture, const std::shared_ptr<const std::string>& frame) {
  boost::asio::post(*io_, [this, picture, frame] {
    picture_ = picture;
    frame_ = frame;
    for (const auto& [client, ignored] : sessions_) {
      if (const auto session = find(client)) session->send_picture(picture, frame);
    }
  });
}

void Hub::give(int client, const std::shared_ptr<const std::string>& frame) {
  boost::asio::post(*io_, [this, client, frame] {
    if (const auto session = find(client)) session->send_file(frame);
  });
}

int Hub::join(const std::shared_ptr<WebSocketSession>& session) {
  if (sessions_.size() >= kMaxPages) return 0;
  sessions_[++last_client_] = session;
  return last_client_;
}

void Hub::welcomed(int client) {
  ++welcomed_;
  events_.arrived(client);
  boost::asio::post(*io_, [this, client] {  // behind what it has just been told
    const auto session = find(client);
    if (session && frame_) session->send_picture(picture_, frame_);
  });
}

void Hub::leave(int client, bool was_greeted) {
  if (sessions_.erase(client) == 0) return;
  if (was_greeted) --welcomed_;
  events_.left(client);
}

void Hub::close_all(const std::string& text) {
  const auto shared = std::make_shared<const std::string>(text);
  std::vector<std::shared_ptr<WebSocketSession>> open;
  for (const auto& [client, session] : sessions_) {
    if (auto held = session.lock()) open.push_back(std::move(held));
  }
  for (const auto& session : open) {
    if (!shared->empty()) session->send_text(shared);
    session->close();
  }
}

}  // namespace lte::infer::view
