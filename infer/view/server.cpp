#include "infer/view/server.h"

#include <utility>

#include <boost/asio/ip/v6_only.hpp>

#include "infer/view/http_connection.h"
#include "lte/base/check.h"

namespace lte::infer::view {
namespace {

using boost::asio::ip::tcp;

std::string in_address(const std::string& host) {
  return host.find(':') == host.npos ? host : '[' + host + ']';
}

}  // namespace

boost::asio::ip::address parse_host(const std::string& host) {
  boost::system::error_code error;
  const auto address =
      boost::asio::ip::make_address(host == "localhost" ? "127.0.0.1" : host, error);
  LTE_CHECK(!error, "--host: expected an address such as 127.0.0.1 or 0.0.0.0, got \"", host, "\"");
  return address;
}

Server::Server(boost::asio::io_context* io, const Listen& listen, const PageFiles* files, Hub* hub)
    : acceptor_(*io), host_(listen.host), files_(files), hub_(hub) {
  const tcp::endpoint endpoint(parse_host(listen.host), listen.port);
  boost::system::error_code error;
  acceptor_.open(endpoint.protocol(), error);
  if (!error) acceptor_.set_option(tcp::acceptor::reuse_address(true), error);
  if (!error) acceptor_.bind(endpoint, error);
  if (!error) acceptor_.listen(boost::asio::socket_base::max_listen_connections, error);
  LTE_CHECK(error != boost::asio::error::address_in_use, "--port ", listen.port,
            ": is in use; pass another one, or 0 for any that is free");
  LTE_CHECK(!error, "--host ", listen.host, " --port ", listen.port,
            ": cannot listen: ", error.message());
  access_ = {listen.token, endpoint.address().is_loopback(), acceptor_.local_endpoint().port()};
  accept();
}

std::string Server::address() const {
  return concat("http://", in_address(host_), ':', access_.port, '/',
                access_.token.empty() ? "" : "?token=", access_.token);
}

void Server::stop() {
  boost::system::error_code ignored;
  acceptor_.close(ignored);
}

void Server::accept() {
  acceptor_.async_accept([this](boost::system::error_code error, tcp::socket socket) {
    if (error == boost::asio::error::operation_aborted || !acceptor_.is_open()) return;
    if (!error && *open_ < kMaxConnections) {
      boost::system::error_code ignored;
      socket.set_option(tcp::no_delay(true), ignored);
      std::make_shared<HttpConnection>(std::move(socket), &access_, files_, hub_, open_)->read();
    }
    accept();
  });
}

}  // namespace lte::infer::view
