#include "infer/render/video.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstdlib>
#include <optional>
#include <sstream>
#include <utility>
#include <vector>

#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

#include "lte/base/check.h"

namespace lte::infer {
namespace {

namespace fs = std::filesystem;

std::string format_of(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension.empty() ? extension : extension.substr(1);
}

std::optional<fs::path> find_ffmpeg() {
  const char* const folders = std::getenv("PATH");
  std::istringstream list(folders != nullptr ? folders : "");
  for (std::string folder; std::getline(list, folder, ':');) {
    const fs::path program = fs::path(folder) / "ffmpeg";
    std::error_code ignored;
    if (fs::is_regular_file(program, ignored) && access(program.c_str(), X_OK) == 0) return program;
  }
  return std::nullopt;
}

/// Players take 8-bit YUV at half the resolution of color; a gif has 256 colors of its own.
std::vector<std::string> encoding_of(const std::string& format) {
  if (format == "gif") return {"-vf", "split[a][b];[a]palettegen[p];[b][p]paletteuse"};
  std::vector<std::string> out{"-vf",
                               "scale=out_color_matrix=bt709:out_range=tv",
                               "-pix_fmt",
                               "yuv420p",
                               "-colorspace",
                               "bt709",
                               "-color_primaries",
                               "bt709",
                               "-color_trc",
                               "iec61966-2-1"};
  const std::vector<std::string> codec =
      format == "mp4"
          ? std::vector<std::string>{"-c:v", "libx264", "-crf", "17", "-movflags", "+faststart"}
          : std::vector<std::string>{"-c:v", "libvpx-vp9", "-crf", "20", "-b:v", "0"};
  out.insert(out.end(), codec.begin(), codec.end());
  return out;
}

}  // namespace

bool is_video_path(const fs::path& path) {
  const std::string format = format_of(path);
  return format == "mp4" || format == "webm" || format == "gif";
}

void check_video(const fs::path& path, int width, int height) {
  LTE_CHECK(find_ffmpeg(), path.string(),
            ": a video needs the program ffmpeg, which is not on PATH; install it, or write "
            "pictures, as in --out turn_%03d.png");
  LTE_CHECK(format_of(path) != "mp4" || (width % 2 == 0 && height % 2 == 0), path.string(),
            ": an .mp4 has even sides, --size says ", width, "x", height);
}

Video::Video(const fs::path& path, int width, int height, int pictures_a_second)
    : path_(path), width_(width), height_(height), file_(path) {
  check_video(path, width, height);
  const std::string program = find_ffmpeg()->string(), format = format_of(path);
  std::vector<std::string> words{program,
                                 "-hide_banner",
                                 "-loglevel",
                                 "error",
                                 "-f",
                                 "rawvideo",
                                 "-pixel_format",
                                 "rgb24",
                                 "-video_size",
                                 concat(width, "x", height),
                                 "-framerate",
                                 concat(pictures_a_second),
                                 "-i",
                                 "pipe:0"};
  const std::vector<std::string> encoding = encoding_of(format);
  words.insert(words.end(), encoding.begin(), encoding.end());
  words.insert(words.end(), {"-f", format, "-y", "file:" + file_.temporary_path().string()});
  std::array<int, 2> ends{-1, -1};
  words_ = memfd_create("ffmpeg", MFD_CLOEXEC);
  // A socket, as a write to a pipe that nobody reads would end this process.
  if (words_ < 0 || socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
    fail_on_file(path_, "cannot open a channel to ffmpeg", errno);
  input_ = ends[0];
  ffmpeg_.emplace(std::move(words), ends[1], words_);
  close(ends[1]);
}

Video::~Video() {
  if (input_ >= 0) close(input_);
  if (words_ >= 0) close(words_);
}

void Video::add(const image::DisplayPicture& picture) {
  LTE_CHECK(picture.width == width_ && picture.height == height_, path_.string(), ": a picture of ",
            picture.width, "x", picture.height, " in a video of ", width_, "x", height_);
  const std::vector<uint8_t>& bytes = picture.bytes;
  for (size_t sent = 0; sent < bytes.size();) {
    const ssize_t now = send(input_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
    if (now < 0 && errno == EINTR) continue;
    if (now < 0) fail();
    sent += static_cast<size_t>(now);
  }
}

void Video::finish() {
  if (wait() != 0) fail();
  file_.commit();
}

/// Ends its input and returns its exit status.
int Video::wait() {
  if (input_ >= 0) close(input_);
  input_ = -1;
  return ffmpeg_->wait();
}

void Video::fail() {
  wait();
  std::array<char, 256> said{};
  const ssize_t size = pread(words_, said.data(), said.size() - 1, 0);
  const std::string words = size > 0 ? said.data() : "it said nothing";
  throw Error(concat(path_.string(), ": ffmpeg failed: ", words.substr(0, words.find('\n'))));
}

}  // namespace lte::infer
