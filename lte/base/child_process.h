// A program that runs beside this process.
#pragma once

#include <string>
#include <vector>

#include <sys/types.h>

namespace lte {

class ChildProcess {
 public:
  /// Starts it, with nothing to read its standard output.
  /// @param words   the program, by its path or found on PATH, and its arguments
  /// @param input   a descriptor that it reads as standard input; -1: that of this process
  /// @param errors  one that it writes standard error to; likewise
  /// @throws lte::Error naming the program if it cannot start
  explicit ChildProcess(std::vector<std::string> words, int input = -1, int errors = -1);
  /// Ends it.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Waits for its end.
  /// @return its exit status; -1 if a signal ended it, or it has ended before
  int wait();

 private:
  pid_t pid_ = -1;
};

}  // namespace lte
