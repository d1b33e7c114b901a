#include "lte/scene/pbrt/files.h"

#include <algorithm>

namespace lte::scene::pbrt {
namespace {

constexpr size_t kMaxDepth = 64;

}  // namespace

SceneFilePtr Files::find(const std::string& name, const Location& at) const {
  if (name.empty() || name.find('\0') != name.npos) fail(at, "expected the name of a file");
  const std::filesystem::path beside = std::filesystem::path(at.file->name).parent_path() / name,
                              top = scene_->scene().parent_path() / name;
  try {
    if (const SceneFilePtr file = scene_->open({beside, top}, name, concat(at))) return file;
  } catch (const LimitError&) {
    throw;
  } catch (const Error& error) {
    if (at.file->outside) fail(at, "the file that it names cannot be read");
    throw;
  }
  fail(at, "cannot find the file ", quote(name));
}

const TextFile* Files::open(const SceneFile& file, const Location& at) {
  const TextFile* const name =
      &names_.try_emplace(file.name(), TextFile{file.name(), file.outside()}).first->second;
  if (std::find(open_.begin(), open_.end(), file.identity()) != open_.end())
    fail(at, quote(file.name()), " includes itself");
  if (open_.size() >= kMaxDepth) fail(at, "files include one another deeper than ", kMaxDepth);
  if (++opened_ > limits().includes)
    throw OverLimit(concat(at, ": more than ", limits().includes, " files are included"),
                    "includes");
  open_.push_back(file.identity());
  return name;
}

void Files::count_text(size_t bytes, const Location& at) {
  bytes_ += static_cast<int64_t>(std::min(bytes, size_t{1} << 60));
  if (bytes_ > limits().text_bytes)
    throw OverLimit(concat(at, ": the scene's text is longer than the limit \"text\" of ",
                           size_text(limits().text_bytes)),
                    "text");
}

}  // namespace lte::scene::pbrt
