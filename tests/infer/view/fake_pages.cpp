#include "tests/infer/view/fake_pages.h"

#include "lte/base/srgb.h"
#include "lte/image/png.h"

namespace lte::test {
namespace {

constexpr std::chrono::seconds kPatience(60);

size_t header_size(const std::string& frame) {
  size_t size = 0;
  for (size_t byte = 4; byte-- > 0;) size = 256 * size + static_cast<unsigned char>(frame.at(byte));
  return size;
}

}  // namespace

nlohmann::json frame_header(const std::string& frame) {
  return nlohmann::json::parse(frame.substr(4, header_size(frame)));
}

std::string frame_bytes(const std::string& frame) { return frame.substr(4 + header_size(frame)); }

image::Image frame_picture(const std::string& frame) {
  return image::decode_png(frame_bytes(frame), "picture.jpg", int64_t{1} << 24);
}

double mean_light(const image::Image& displayed) {
  double sum = 0;
  for (const float value : displayed.pixels) sum += srgb_to_linear(value);
  return sum / static_cast<double>(displayed.pixels.size());
}

int FakePages::count() const {
  const std::lock_guard lock(mutex_);
  return count_;
}

void FakePages::tell(int, const std::string& text) {
  const std::lock_guard lock(mutex_);
  texts_.push_back(nlohmann::json::parse(text));
  changed_.notify_all();
}

void FakePages::show(int64_t, const std::shared_ptr<const std::string>& frame) {
  const std::lock_guard lock(mutex_);
  pictures_.push_back(*frame);
  changed_.notify_all();
}

void FakePages::give(int, const std::shared_ptr<const std::string>& frame) {
  const std::lock_guard lock(mutex_);
  files_.push_back(*frame);
  changed_.notify_all();
}

/// What `found` returns once that is not empty.
template <typename Found>
auto FakePages::wait(const Found& found) {
  std::unique_lock lock(mutex_);
  auto out = found();
  changed_.wait_for(lock, kPatience, [&] {
    out = found();
    return !out.empty();
  });
  return out;
}

std::string FakePages::wait_for_picture(const std::function<bool(const nlohmann::json&)>& wanted) {
  return wait([&] {
    for (const std::string& frame : pictures_) {
      if (wanted(frame_header(frame))) return frame;
    }
    return std::string();
  });
}

nlohmann::json FakePages::wait_for_text(const std::string& type) {
  return wait([&] {
    for (const nlohmann::json& text : texts_) {
      if (text.at("type") == type) return text;
    }
    return nlohmann::json();
  });
}

std::string FakePages::wait_for_file() {
  return wait([&] { return files_.empty() ? std::string() : files_.back(); });
}

int FakePages::pictures() const {
  const std::lock_guard lock(mutex_);
  return static_cast<int>(pictures_.size());
}

}  // namespace lte::test
