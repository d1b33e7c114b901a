// lte_train as a child process.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <sys/types.h>

namespace lte::test {

class ToolProcess {
 public:
  /// Starts lte_train; what it prints goes to the files `prefix`.out and `prefix`.err.
  /// @param environment  variables beside those of this process
  /// @param file_limit  bytes beyond which no file grows: writing fails there, as on a disk that is
  /// full; 0: none
  ToolProcess(const std::vector<std::string>& args, const std::filesystem::path& prefix,
              const std::map<std::string, std::string>& environment = {}, size_t file_limit = 0);
  /// Kills it if it still runs.
  ~ToolProcess();
  ToolProcess(ToolProcess&& other) noexcept;
  ToolProcess& operator=(ToolProcess&&) = delete;
  ToolProcess(const ToolProcess&) = delete;
  ToolProcess& operator=(const ToolProcess&) = delete;

  pid_t id() const { return child_; }
  /// @return the exit status; minus the number of the signal that ended it
  int wait();
  std::string out() const;
  std::string err() const;

 private:
  pid_t child_ = -1;
  std::filesystem::path prefix_;
};

}  // namespace lte::test
