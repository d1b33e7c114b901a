#include "infer/view/http_connection.h"

#include <chrono>
#include <string_view>
#include <utility>

#include <boost/beast/http/read.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/beast/websocket/rfc6455.hpp>

#include "infer/view/web_socket_session.h"

namespace lte::infer::view {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;

constexpr uint32_t kMaxHeaderBytes = 8192;
constexpr std::chrono::seconds kPatience(20);
// The page loads nothing from elsewhere, runs no code of its own text, and stands in no frame.
constexpr const char* kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

std::string_view view_of(beast::string_view text) { return {text.data(), text.size()}; }

}  // namespace

HttpConnection::HttpConnection(boost::asio::ip::tcp::socket&& socket, const Access* access,
                               const PageFiles* files, Hub* hub, std::shared_ptr<int> open)
    : stream_(std::move(socket)),
      access_(access),
      files_(files),
      hub_(hub),
      open_(std::move(open)) {
  ++*open_;
}

HttpConnection::~HttpConnection() { --*open_; }

void HttpConnection::read() {
  parser_.emplace();
  parser_->header_limit(kMaxHeaderBytes);
  stream_.expires_after(kPatience);
  http::async_read_header(
      stream_, buffer_, *parser_,
      [self = shared_from_this()](beast::error_code error, size_t) { self->on_header(error); });
}

void HttpConnection::on_header(beast::error_code error) {
  if (error == http::error::header_limit)
    return refuse(http::status::request_header_fields_too_large, "the header is too large");
  if (error == http::error::end_of_stream || error == beast::error::timeout ||
      error == boost::asio::error::operation_aborted)
    return;
  if (error) return refuse(http::status::bad_request, "no HTTP request");
  const bool has_body = parser_->chunked() || parser_->content_length_remaining().value_or(0) > 0;
  if (has_body) return refuse(http::status::payload_too_large, "a request has no body here");
  answer(parser_->get());
}

void HttpConnection::answer(const Request& request) {
  const Caller caller{view_of(request.target()), view_of(request[http::field::host]),
                      view_of(request[http::field::origin])};
  const std::string_view path = path_of(caller.target);
  if (request.method() != http::verb::get && request.method() != http::verb::head)
    return refuse(http::status::method_not_allowed, "expected GET");
  const bool is_socket = path == "/socket";
  const PageFile* file = is_socket ? nullptr : files_->find(path);
  if (!is_socket && file == nullptr) return refuse(http::status::not_found, "no such page");
  // What the page is made of is no secret, and its parts are asked for without the token.
  if (is_socket || path == "/" || path == "/index.html") {
    if (const char* reason = refusal(*access_, caller, is_socket))
      return refuse(http::status::forbidden, reason);
  }
  if (!is_socket) return answer_file(request, *file);
  if (!beast::websocket::is_upgrade(request))
    return refuse(http::status::upgrade_required, "expected a WebSocket");
  std::make_shared<WebSocketSession>(std::move(stream_), hub_, open_)->run(request);
}

void HttpConnection::answer_file(const Request& request, const PageFile& file) {
  Response response{http::status::ok, request.version()};
  response.set(http::field::content_type, file.media_type);
  response.keep_alive(request.keep_alive());
  response.content_length(file.bytes.size());
  if (request.method() == http::verb::get) response.body() = file.bytes;
  send(std::move(response));
}

void HttpConnection::refuse(http::status status, const std::string& line) {
  Response response{status, 11};
  response.set(http::field::content_type, "text/plain; charset=utf-8");
  response.body() = "lte_view: " + line + '\n';
  response.keep_alive(false);
  response.prepare_payload();
  send(std::move(response));
}

void HttpConnection::send(Response response) {
  response.set(http::field::server, "lte_view");
  response.set(http::field::cache_control, "no-store");
  response.set("X-Content-Type-Options", "nosniff");
  response.set("Referrer-Policy", "no-referrer");
  response.set("Content-Security-Policy", kPolicy);
  response_.emplace(std::move(response));
  stream_.expires_after(kPatience);
  http::async_write(
      stream_, *response_, [self = shared_from_this()](beast::error_code error, size_t) {
        if (error) return;
        if (self->response_->keep_alive()) return self->read();
        beast::error_code ignored;
        self->stream_.socket().shutdown(boost::asio::ip::tcp::socket::shutdown_send, ignored);
      });
}

}  // namespace lte::infer::view
