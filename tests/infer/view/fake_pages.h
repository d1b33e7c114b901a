// Pages without sockets, for tests of what renders and edits.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "infer/view/pages.h"
#include "lte/image/image.h"

namespace lte::test {

/// What stands before the bytes of a binary frame, read by a parser of its own.
nlohmann::json frame_header(const std::string& frame);
std::string frame_bytes(const std::string& frame);
/// The picture of a frame, in [0, 1] as displayed.
image::Image frame_picture(const std::string& frame);

/// Mean of the linear light that a displayed picture stands for.
double mean_light(const image::Image& displayed);

class FakePages : public infer::view::Pages {
 public:
  explicit FakePages(int count = 1) : count_(count) {}

  int count() const override;
  void tell(int client, const std::string& text) override;
  void tell_all(const std::string& text) override { tell(0, text); }
  void show(int64_t picture, const std::shared_ptr<const std::string>& frame) override;
  void give(int client, const std::shared_ptr<const std::string>& frame) override;

  /// Blocks until a picture with this in its header has come, and returns its frame; empty after a
  /// minute.
  std::string wait_for_picture(const std::function<bool(const nlohmann::json&)>& wanted);
  /// The same for a text or, with its header, a file.
  nlohmann::json wait_for_text(const std::string& type);
  std::string wait_for_file();

  int pictures() const;

 private:
  template <typename Found>
  auto wait(const Found& found);

  int count_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::string> pictures_, files_;
  std::vector<nlohmann::json> texts_;
};

}  // namespace lte::test
