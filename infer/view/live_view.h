// A session and the pages that look at it: hands what pages say to the thread that renders or to
// the one that edits.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include <boost/asio/io_context.hpp>

#include "infer/session/session.h"
#include "infer/view/editor.h"
#include "infer/view/hub.h"
#include "infer/view/view_loop.h"

namespace lte::infer::view {

/// Used by the thread of the sockets, but for what its threads do.
class LiveView {
 public:
  /// Pages may come at once, and wait until begin().
  explicit LiveView(boost::asio::io_context* io);
  /// Waits for the edit and the rendering that are under way.
  ~LiveView();
  LiveView(const LiveView&) = delete;
  LiveView& operator=(const LiveView&) = delete;

  Hub* hub() { return &hub_; }

  /// The scene is there.
  void begin(std::unique_ptr<Session> session, const ViewState& first);

  struct Counts {
    ViewLoop::Counts view;
    int64_t edits = 0;
  };
  Counts counts() const;

 private:
  void arrived(int client);
  void said(int client, const Message& message);
  void left(int client);

  Hub hub_;
  std::unique_ptr<Session> session_;
  std::unique_ptr<ViewLoop> loop_;
  std::unique_ptr<Editor> editor_;
};

}  // namespace lte::infer::view
