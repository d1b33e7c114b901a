#include "lte/base/log.h"

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <mutex>

#include <unistd.h>

namespace lte {
namespace {

struct Closer {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

std::atomic<LogLevel> g_level{LogLevel::Info};
std::mutex g_mutex;
std::unique_ptr<std::FILE, Closer> g_file;

}  // namespace

void set_log_level(LogLevel level) { g_level = level; }

LogLevel log_level() { return g_level; }

void set_log_file(const std::string& path) {
  std::unique_ptr<std::FILE, Closer> file;
  if (!path.empty()) {
    file.reset(std::fopen(path.c_str(), "ae"));
    LTE_CHECK(file, path, ": cannot open the log file: ", std::strerror(errno));
  }
  const std::lock_guard lock(g_mutex);
  g_file = std::move(file);
}

void log_line(LogLevel level, const std::string& line) {
  static const bool terminal = isatty(STDERR_FILENO) == 1;
  std::string text = (level == LogLevel::Warning ? "warning: " : "") + line + '\n';
  const std::lock_guard lock(g_mutex);
  if (g_file) {
    std::fputs(text.c_str(), g_file.get());
    std::fflush(g_file.get());
  }
  if (level > g_level) return;
  // A progress bar may stand on the terminal's last line: wipe it, it will be drawn again below.
  if (terminal) text.insert(0, "\r\033[K");
  std::fputs(text.c_str(), stderr);
}

}  // namespace lte
