// The server over real sockets, spoken to byte by byte.
#include "infer/view/server.h"

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/websocket.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "infer/view/live_view.h"
#include "lte/base/check.h"
#include "tests/infer/fixture.h"
#include "tests/infer/view/fake_pages.h"

namespace lte::infer::view {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
using asio::ip::tcp;
using nlohmann::json;
using testing::HasSubstr;
using testing::StartsWith;

constexpr const char* kHello = R"({"type":"hello","protocol":1,"n":1})";

/// A server in a thread; with a scene if `ready`.
class Served {
 public:
  explicit Served(bool ready = false, const std::string& token = "")
      : files_(std::string(LTE_SOURCE_DIR) + "/infer/view/page"),
        view_(std::make_unique<LiveView>(&io_)),
        server_(&io_, {"127.0.0.1", 0, token}, &files_, view_->hub()) {
    if (ready) {
      ViewState first;
      first.camera = test::downward_camera();
      first.size = {24, 18};
      view_->begin(std::make_unique<Session>(test::lit_floor(), std::nullopt), first);
    }
    thread_ = std::thread([this] { io_.run(); });
  }
  ~Served() {
    io_.stop();
    thread_.join();
    view_.reset();
  }

  uint16_t port() const { return server_.port(); }
  std::string host() const { return concat("127.0.0.1:", port()); }
  LiveView* view() { return view_.get(); }
  asio::io_context* io() { return &io_; }

  tcp::socket connect() {
    tcp::socket socket(client_);
    socket.connect({asio::ip::address_v4::loopback(), port()});
    return socket;
  }

  /// What comes back for these bytes until the server closes.
  std::string say(const std::string& request) {
    tcp::socket socket = connect();
    boost::system::error_code ignored;
    asio::write(socket, asio::buffer(request), ignored);
    std::string answer;
    asio::read(socket, asio::dynamic_buffer(answer), ignored);
    return answer;
  }
  std::string get(const std::string& target, const std::string& more = "") {
    return say("GET " + target + " HTTP/1.1\r\nHost: " + host() + "\r\nConnection: close\r\n" +
               more + "\r\n");
  }

 private:
  asio::io_context io_{1}, client_;
  PageFiles files_;
  std::unique_ptr<LiveView> view_;
  Server server_;
  std::thread thread_;
};

/// A page without a browser.
class Socket {
 public:
  explicit Socket(Served* served, const std::string& target = "/socket",
                  const std::string& origin = "")
      : socket_(served->connect()) {
    beast::get_lowest_layer(socket_).set_option(tcp::no_delay(true));
    socket_.set_option(
        beast::websocket::stream_base::decorator([origin](beast::websocket::request_type& request) {
          if (!origin.empty()) request.set(beast::http::field::origin, origin);
        }));
    socket_.handshake(served->host(), target, error_);
  }

  bool open() const { return !error_; }
  void send(const std::string& text, bool is_text = true) {
    socket_.text(is_text);
    socket_.write(asio::buffer(text), error_);
  }
  /// The next frame; empty once the socket is closed.
  std::string read() {
    beast::flat_buffer buffer;
    socket_.read(buffer, error_);
    if (error_) return "";
    const std::string frame = beast::buffers_to_string(buffer.data());
    if (!is_text()) {
      ++pictures_;
      picture_ = test::frame_header(frame).value("picture", 0);
    }
    return frame;
  }
  bool is_text() const { return socket_.got_text(); }
  int pictures() const { return pictures_; }  ///< that have come
  int picture() const { return picture_; }    ///< the number of the last
  /// The next text of this type; null once the socket is closed.
  json read_text(const std::string& type) {
    for (;;) {
      const std::string frame = read();
      if (frame.empty()) return {};
      if (!is_text()) continue;
      const json text = json::parse(frame);
      if (text.at("type") == type) return text;
    }
  }
  json read_picture() {
    for (;;) {
      const std::string frame = read();
      if (frame.empty()) return {};
      if (!is_text()) return test::frame_header(frame);
    }
  }

 private:
  beast::websocket::stream<tcp::socket> socket_;
  boost::system::error_code error_;
  int pictures_ = 0, picture_ = 0;
};

TEST(Server, ServesItsOwnFilesAlone) {
  Served served;
  EXPECT_THAT(served.get("/"), AllOf(StartsWith("HTTP/1.1 200"), HasSubstr("<!DOCTYPE html>"),
                                     HasSubstr("Content-Security-Policy: default-src 'none'")));
  EXPECT_THAT(served.get("/main.js"), HasSubstr("text/javascript"));
  for (const char* target :
       {"/../CMakeLists.txt", "/../../../etc/passwd", "/%2e%2e/CMakeLists.txt",
        "/..%2f..%2fetc/passwd", "//etc/passwd", "/page/main.js", "/nothing"}) {
    EXPECT_THAT(served.get(target), StartsWith("HTTP/1.1 404")) << target;
  }
}

TEST(Server, RefusesWhatIsNoPlainRequest) {
  Served served;
  const std::string host = "Host: " + served.host() + "\r\n";
  EXPECT_THAT(served.say("POST / HTTP/1.1\r\n" + host + "Content-Length: 5\r\n\r\nhello"),
              StartsWith("HTTP/1.1 413"));
  EXPECT_THAT(served.say("DELETE / HTTP/1.1\r\n" + host + "\r\n"), StartsWith("HTTP/1.1 405"));
  EXPECT_THAT(served.say("\x16\x03\x01 no http at all\r\n\r\n"), StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(
      served.say("GET / HTTP/1.1\r\n" + host + "X: " + std::string(20000, 'x') + "\r\n\r\n"),
      StartsWith("HTTP/1.1 431"));
  EXPECT_THAT(served.get("/socket"), StartsWith("HTTP/1.1 426"));
  EXPECT_THAT(served.say("GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n"),
              AllOf(StartsWith("HTTP/1.1 403"), HasSubstr("this machine")));
  EXPECT_THAT(served.get("/"), StartsWith("HTTP/1.1 200"));  // and it goes on
}

TEST(Server, SocketsOfOtherOriginsAreRefused) {
  Served served;
  EXPECT_TRUE(Socket(&served, "/socket", "http://" + served.host()).open());
  EXPECT_TRUE(Socket(&served).open());
  EXPECT_FALSE(Socket(&served, "/socket", "http://evil.example").open());
  EXPECT_FALSE(Socket(&served, "/elsewhere").open());
}

TEST(Server, TheTokenOpensPageAndSocket) {
  Served served(/*ready=*/false, "a-good-token");
  EXPECT_THAT(served.get("/"), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(served.get("/?token=a-good-token"), StartsWith("HTTP/1.1 200"));
  EXPECT_FALSE(Socket(&served).open());
  EXPECT_FALSE(Socket(&served, "/socket?token=a-bad-token").open());
  EXPECT_TRUE(Socket(&served, "/socket?token=a-good-token").open());
}

TEST(Server, APortInUseIsNamed) {
  Served served;
  asio::io_context io;
  LiveView other(&io);
  const PageFiles files(std::string(LTE_SOURCE_DIR) + "/infer/view/page");
  try {
    Server(&io, {"127.0.0.1", served.port(), ""}, &files, other.hub());
    FAIL() << "expected an error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("--port"), HasSubstr("in use")));
  }
  EXPECT_THROW(parse_host("example.com"), Error);
}

TEST(Server, APageSaysHelloFirst) {
  Served served;
  Socket silent(&served);
  silent.send(R"({"type":"undo","n":1})");
  EXPECT_THAT(silent.read_text("error").at("message").get<std::string>(), HasSubstr("hello"));
  EXPECT_EQ(silent.read(), "");
  Socket polite(&served);
  polite.send(kHello);
  EXPECT_EQ(polite.read_text("welcome").at("phase"), "loading");
  polite.send(R"({"type":"undo","n":2})");
  EXPECT_THAT(polite.read_text("error").at("message").get<std::string>(), HasSubstr("loaded"));
}

TEST(Server, FramesTooLargeAndBinaryOnesEndAPage) {
  Served served;
  Socket large(&served);
  large.send(kHello);
  large.read_text("welcome");
  large.send(std::string(kMaxMessageBytes + 1, 'x'));
  EXPECT_EQ(large.read_text("nothing"), nullptr);
  Socket binary(&served);
  binary.send(std::string("\0\1\2", 3), /*is_text=*/false);
  EXPECT_THAT(binary.read_text("error").at("message").get<std::string>(), HasSubstr("text frame"));
  EXPECT_EQ(binary.read(), "");
}

TEST(Server, APageIsToldOfFaultsAndGoesOn) {
  Served served(/*ready=*/true);
  Socket page(&served);
  page.send(kHello);
  EXPECT_EQ(page.read_text("scene").at("lights").size(), 1u);
  page.send(R"({"type":"paint","n":2})");
  EXPECT_THAT(page.read_text("error").at("message").get<std::string>(), HasSubstr("\"paint\""));
  page.send(R"({"type":"light","n":3,"gesture":0,"light":5,"gain":1,"color":[1,1,1]})");
  EXPECT_THAT(page.read_text("error").at("message").get<std::string>(), HasSubstr("light 5"));
  page.send(R"({"type":"light","n":4,"gesture":0,"light":0,"gain":0.5,"color":[1,1,1]})");
  const json edits = page.read_text("edits");
  EXPECT_EQ(edits.at("edits").at(0).at("gain"), 0.5);
  EXPECT_TRUE(edits.at("undo"));
  page.send(R"({"type":"undo","n":5})");
  EXPECT_EQ(page.read_text("scene").at("lights").at(0).at("gain"), 1.0);
}

TEST(Server, APageThatLooksOnSeesAnothersEdits) {
  Served served(/*ready=*/true);
  Socket one(&served), other(&served);
  one.send(kHello);
  other.send(kHello);
  one.read_text("scene");
  other.read_text("scene");
  one.send(R"({"type":"material","n":2,"gesture":0,"material":0,"albedo":[0.5,0.25,0]})");
  EXPECT_EQ(other.read_text("edits").at("edits").at(0).at("albedo"), json({0.5, 0.25, 0.0}));
}

/// Twenty pages that edit at the same time: all end up with the same picture of the same scene, and
/// a move costs what it costs one page.
TEST(Server, TwentyPagesSeeOneSceneForOneRendering) {
  constexpr int kPages = 20;
  Served served(/*ready=*/true);
  std::vector<std::unique_ptr<Socket>> pages;
  std::vector<int> numbers(kPages, 1);
  std::vector<json> last_edit(kPages);
  for (int i = 0; i < kPages; ++i) {
    pages.push_back(std::make_unique<Socket>(&served));
    pages.back()->send(kHello);
    ASSERT_EQ(pages.back()->read_text("scene").at("lights").size(), 1u);
  }
  const auto say = [&](int page, const std::string& message) {
    const auto at = static_cast<size_t>(page);
    pages[at]->send(concat("{", message, R"(,"n":)", ++numbers[at], "}"));
    return numbers[at];
  };
  // Reads on, as a page does, until a finished picture shows all that is wanted.
  const auto settled = [&](int page, const std::function<bool(const json&)>& wanted) {
    const auto at = static_cast<size_t>(page);
    for (;;) {
      const std::string frame = pages[at]->read();
      if (frame.empty()) return frame;
      if (pages[at]->is_text()) {
        const json text = json::parse(frame);
        if (text.at("type") == "edits") last_edit[at] = text.at("edits").back();
        continue;
      }
      const json header = test::frame_header(frame);
      say(page, concat(R"("type":"shows","picture":)", header.at("picture").get<int>()));
      if (header.at("done") == true && wanted(header.at("handled")))
        return test::frame_bytes(frame);
    }
  };
  std::vector<int> edits;
  for (int i = 0; i < kPages; ++i) {
    say(i, concat(R"("type":"camera","origin":[0,)", 1.2 + 0.01 * i,
                  R"(,0],"target":[0,0,0],"up":[1,0,0],"vfov":40)"));
    edits.push_back(say(i, concat(R"("type":"light","gesture":0,"light":0,"color":[1,1,1],"gain":)",
                                  0.25 + 0.125 * i)));
  }
  const auto has_all = [&](const json& handled) {
    for (size_t i = 0; i < edits.size(); ++i) {
      const std::string client = std::to_string(i + 1);
      if (!handled.contains(client) || handled.at(client).at(1).get<int>() < edits[i]) return false;
    }
    return true;
  };
  const std::string first = settled(0, has_all);
  ASSERT_FALSE(first.empty());
  for (int i = 1; i < kPages; ++i) {
    EXPECT_EQ(settled(i, has_all), first) << i;
    EXPECT_EQ(last_edit[static_cast<size_t>(i)], last_edit[0]) << "in the same order";
  }
  Socket late(&served);
  late.send(kHello);
  EXPECT_EQ(late.read_text("scene").at("lights").at(0).at("gain"), last_edit[0].at("gain"));
  const int64_t before = served.view()->counts().view.passes;
  const int moved =
      say(0, R"("type":"camera","origin":[0,1.1,0],"target":[0,0,0],"up":[1,0,0],"vfov":40)");
  settled(0, [&](const json& handled) { return handled.at("1").at(0).get<int>() >= moved; });
  EXPECT_LE(served.view()->counts().view.passes - before, 2 + Progressive::kMeanPasses);
}

TEST(Server, NoMoreThanTwoPicturesAreAheadOfAPage) {
  Served served(/*ready=*/true);
  Socket page(&served);
  page.send(kHello);
  page.read_picture();
  int n = 1;
  for (int i = 0; i < 20; ++i) {  // each exposure is another picture
    page.send(concat(R"({"type":"view","ev":)", 0.1 * i, R"(,"n":)", ++n, "}"));
    page.send(concat(R"({"type":"pick","x":0.5,"y":0.5,"n":)", ++n, "}"));
    ASSERT_EQ(page.read_text("picked").at("object"), 0);
  }
  EXPECT_LE(page.pictures(), 2);
  // The latest waits until the page has said what it shows; those between are never sent.
  page.send(concat(R"({"type":"shows","picture":)", page.picture(), R"(,"n":)", ++n, "}"));
  while (std::abs(page.read_picture().at("ev").get<double>() - 1.9) > 1e-6) {
    page.send(concat(R"({"type":"shows","picture":)", page.picture(), R"(,"n":)", ++n, "}"));
    ASSERT_LE(page.pictures(), 10);
  }
}

TEST(Server, PagesHearWhyTheSceneCouldNotBeLoaded) {
  Served served;
  Socket page(&served);
  page.send(kHello);
  page.read_text("welcome");
  asio::post(*served.io(), [&] {
    served.view()->hub()->close_all(R"({"type":"failed","message":"room.glb: is no glTF"})");
  });
  EXPECT_EQ(page.read_text("failed").at("message"), "room.glb: is no glTF");
  EXPECT_EQ(page.read(), "");
}

}  // namespace
}  // namespace lte::infer::view
