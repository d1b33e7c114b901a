// The pages that look on, as the threads that render and edit see them.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

namespace lte::infer::view {

/// All functions may be called by any thread, return at once, and do nothing for a page that has
/// gone.
class Pages {
 public:
  virtual ~Pages() = default;

  /// Pages that have said hello.
  virtual int count() const = 0;
  virtual void tell(int client, const std::string& text) = 0;
  virtual void tell_all(const std::string& text) = 0;
  /// Shows a picture frame to all. A page that is behind gets the latest one alone.
  virtual void show(int64_t picture, const std::shared_ptr<const std::string>& frame) = 0;
  /// Sends a file frame.
  virtual void give(int client, const std::shared_ptr<const std::string>& frame) = 0;
};

}  // namespace lte::infer::view
