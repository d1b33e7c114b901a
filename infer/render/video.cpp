#include "infer/render/video.h"

#include <array>
#include <cerrno>
#include <cstdlib>
#include <system_error>
#include <vector>

#include <spawn.h>
#include <sys/wait.h>

#include "lte/base/check.h"
#include "lte/base/log.h"
#include "lte/base/text.h"

extern char** environ;

namespace lte::infer {
namespace {

constexpr std::array<const char*, 4> kContainers = {".mp4", ".webm", ".mkv", ".gif"};

/// The exit status of a program that the PATH has; −1 if it has none of that name.
int run_program(std::vector<std::string> words) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_t child = 0;
  const int error = posix_spawnp(&child, arguments[0], nullptr, nullptr, arguments.data(), environ);
  if (error == ENOENT) return -1;
  LTE_CHECK(error == 0, words[0], ": ", std::generic_category().message(error));
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

}  // namespace

bool is_video_path(const std::filesystem::path& path) {
  const std::string extension = lower_case(path.extension().string());
  for (const char* container : kContainers) {
    if (extension == container) return true;
  }
  return false;
}

bool make_video(const std::string& pattern, double fps, const std::filesystem::path& video) {
  const std::filesystem::path part =
      video.parent_path() / (video.stem().string() + ".part" + video.extension().string());
  // Names that begin with a dash are no flags, and frames of odd size are widened by a pixel.
  const auto safe = [](const std::string& name) {
    return name.starts_with('-') ? "./" + name : name;
  };
  const int status =
      run_program({"ffmpeg", "-nostdin", "-loglevel", "error", "-y", "-framerate",
                   formatted("%.6g", fps), "-start_number", "0", "-i", safe(pattern), "-vf",
                   "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p", safe(part.string())});
  std::error_code ignored;
  if (status == -1) {
    log_warning("there is no ffmpeg to make ", video.string(), " of the frames");
    return false;
  }
  if (status != 0) std::filesystem::remove(part, ignored);
  LTE_CHECK(status == 0, video.string(), ": ffmpeg ended with ", status);
  std::filesystem::rename(part, video);
  return true;
}

}  // namespace lte::infer
