// One HTTP connection: the page's files, and the way to its WebSocket.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/string_body.hpp>

#include "infer/view/hub.h"
#include "infer/view/page_files.h"
#include "infer/view/security.h"

namespace lte::infer::view {

/// Serves GET and HEAD of files that are in the table. Requests with a body are refused before it
/// is read, as are headers above 8 KiB; a connection that says nothing for 20 s is closed.
class HttpConnection : public std::enable_shared_from_this<HttpConnection> {
 public:
  HttpConnection(boost::asio::ip::tcp::socket&& socket, const Access* access,
                 const PageFiles* files, Hub* hub, std::shared_ptr<int> open);
  ~HttpConnection();

  void read();

 private:
  using Request = boost::beast::http::request<boost::beast::http::empty_body>;
  using Response = boost::beast::http::response<boost::beast::http::string_body>;
  void on_header(boost::beast::error_code error);
  void answer(const Request& request);
  void answer_file(const Request& request, const PageFile& file);
  void refuse(boost::beast::http::status status, const std::string& line);
  void send(Response response);

  boost::beast::tcp_stream stream_;
  boost::beast::flat_buffer buffer_;
  std::optional<boost::beast::http::request_parser<boost::beast::http::empty_body>> parser_;
  std::optional<Response> response_;
  const Access* access_;
  const PageFiles* files_;
  Hub* hub_;
  std::shared_ptr<int> open_;  ///< connections at this time
};

}  // namespace lte::infer::view
