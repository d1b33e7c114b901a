// HTTP and WebSocket on one port.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

#include "infer/view/hub.h"
#include "infer/view/page_files.h"
#include "infer/view/security.h"

namespace lte::infer::view {

struct Listen {
  std::string host = "127.0.0.1";  ///< an address, or localhost
  uint16_t port = 8420;            ///< 0 for any that is free
  std::string token;               ///< empty: none is asked for
};

/// The address of a host. @throws lte::Error naming --host
boost::asio::ip::address parse_host(const std::string& host);

class Server {
 public:
  /// Connections at a time, pages included; more are closed at once.
  static constexpr int kMaxConnections = 256;

  /// Begins to listen; connections are served while the io_context runs.
  /// @throws lte::Error naming --host or --port if it cannot listen there
  Server(boost::asio::io_context* io, const Listen& listen, const PageFiles* files, Hub* hub);

  /// What to type into a browser, token included.
  std::string address() const;
  uint16_t port() const { return access_.port; }
  /// No more connections are taken.
  void stop();

 private:
  void accept();

  boost::asio::ip::tcp::acceptor acceptor_;
  std::string host_;
  Access access_;
  const PageFiles* files_;
  Hub* hub_;
  std::shared_ptr<int> open_ = std::make_shared<int>(0);
};

}  // namespace lte::infer::view
