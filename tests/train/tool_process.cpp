#include "tests/train/tool_process.h"

#include <csignal>
#include <cstdlib>
#include <utility>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "lte/base/file.h"

namespace lte::test {

ToolProcess::ToolProcess(const std::vector<std::string>& args, const std::filesystem::path& prefix,
                         const std::map<std::string, std::string>& environment, size_t file_limit)
    : prefix_(prefix) {
  const std::string tool = std::string(LTE_BINARY_DIR) + "/bin/lte_train";
  std::vector<char*> argv = {const_cast<char*>(tool.c_str())};
  for (const std::string& arg : args) argv.push_back(const_cast<char*>(arg.c_str()));
  argv.push_back(nullptr);
  const std::string out = prefix_.string() + ".out", err = prefix_.string() + ".err";
  child_ = fork();
  if (child_ != 0) return;
  for (const auto& [name, value] : environment) setenv(name.c_str(), value.c_str(), 1);
  dup2(open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDOUT_FILENO);
  dup2(open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDERR_FILENO);
  if (file_limit > 0) {
    const rlimit limit{file_limit, file_limit};
    setrlimit(RLIMIT_FSIZE, &limit);
    signal(SIGXFSZ, SIG_IGN);  // the write then fails instead; execv() keeps it
  }
  execv(tool.c_str(), argv.data());
  _exit(127);
}

ToolProcess::~ToolProcess() {
  if (child_ <= 0) return;
  kill(child_, SIGKILL);
  waitpid(child_, nullptr, 0);
}

ToolProcess::ToolProcess(ToolProcess&& other) noexcept
    : child_(std::exchange(other.child_, -1)), prefix_(std::move(other.prefix_)) {}

int ToolProcess::wait() {
  int status = 0;
  waitpid(std::exchange(child_, -1), &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

std::string ToolProcess::out() const { return read_file(prefix_.string() + ".out"); }
std::string ToolProcess::err() const { return read_file(prefix_.string() + ".err"); }

}  // namespace lte::test
