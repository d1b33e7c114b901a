#include "lte/scene/pbrt/files.h"

#include <algorithm>

namespace lte::scene::pbrt {
namespace {

constexpr size_t kMaxDepth = 64;

}  // namespace

std::filesystem::path Files::find(const std::string& name, const Location& at) const {
  namespace fs = std::filesystem;
  // A name with a zero byte would end early in the system's eyes.
  if (name.empty() || name.find('\0') != name.npos) fail(at, "expected the name of a file");
  std::error_code error;
  const fs::path beside = fs::path(*at.file).parent_path() / name, top = folder_ / name;
  const fs::path path = fs::exists(beside, error) ? beside : top;
  if (!fs::exists(path, error)) fail(at, "cannot find the file ", quote(name));
  if (!fs::is_regular_file(path, error)) fail(at, quote(name), " is not a regular file");
  return path;
}

const std::string* Files::open(const std::filesystem::path& path, const Location& at) {
  std::error_code error;
  const std::filesystem::path identity = std::filesystem::weakly_canonical(path, error);
  const std::string* const name = &*names_.insert(path.string()).first;
  if (std::find(open_.begin(), open_.end(), identity) != open_.end())
    fail(at, quote(path.string()), " includes itself");
  if (open_.size() >= kMaxDepth) fail(at, "files include one another deeper than ", kMaxDepth);
  if (++opened_ > limits_.includes) fail(at, "more than ", limits_.includes, " files are included");
  open_.push_back(identity);
  return name;
}

void Files::count_text(size_t bytes, const Location& at) {
  bytes_ += static_cast<int64_t>(std::min(bytes, size_t{1} << 60));
  if (bytes_ > limits_.text_bytes)
    fail(at, "the scene's text is longer than the limit of ", limits_.text_bytes, " bytes");
}

}  // namespace lte::scene::pbrt
