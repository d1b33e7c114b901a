#include "lte/scene/obj/file.h"

#include <charconv>
#include <map>
#include <utility>

#include "lte/base/check.h"
#include "lte/image/tonemap.h"
#include "lte/scene/import/triangulate.h"
#include "lte/scene/obj/text.h"

namespace lte::scene::obj {
namespace {

constexpr std::string_view kFreeForm[] = {"vp",   "deg",  "bmat", "step", "cstype", "curv", "curv2",
                                          "surf", "parm", "trim", "hole", "scrv",   "sp",   "end",
                                          "con",  "bzp",  "bsp",  "cdc",  "cdp",    "res"};
/// Smoothing and display, which say nothing about where surfaces are: normals are geometric.
constexpr std::string_view kSilent[] = {"s",          "mg",        "bevel",  "c_interp",
                                        "d_interp",   "lod",       "usemap", "maplib",
                                        "shadow_obj", "trace_obj", "ctech",  "stech"};

template <typename Words>
bool contains(const Words& words, std::string_view word) {
  return std::find(std::begin(words), std::end(words), word) != std::end(words);
}

class Parser {
 public:
  Parser(std::string_view text, const std::string& name, const LoadLimits& limits,
         IgnoredFeatures* ignored)
      : statements_(text, name), limits_(limits), ignored_(ignored) {}

  ObjFile run() {
    while (statements_.next()) read_statement(statements_.word());
    if (!file_.colors.empty()) file_.colors.resize(file_.positions.size(), {1, 1, 1});
    return std::move(file_);
  }

 private:
  void read_statement(std::string_view keyword) {
    if (keyword == "v") {
      read_position();
    } else if (keyword == "vt") {
      read_uv();
    } else if (keyword == "vn") {
      ++normals_;  // normals are geometric; only the count matters, for indices into them
    } else if (keyword == "f" || keyword == "fo") {
      read_face();
    } else if (keyword == "o") {
      object_ = statements_.rest();
      part_ = kNone;
    } else if (keyword == "g") {
      group_ = statements_.rest();
      part_ = kNone;
    } else if (keyword == "usemtl") {
      material_ = statements_.rest();
      part_ = kNone;
    } else if (keyword == "mtllib") {
      file_.libraries.emplace_back(statements_.rest());
    } else if (keyword == "l" || keyword == "p") {
      ignored_->add(keyword == "l" ? "lines" : "points", "statement");
    } else if (contains(kFreeForm, keyword)) {
      ignored_->add("free-form curves and surfaces", "statement");
    } else if (!contains(kSilent, keyword)) {
      ignored_->add("unknown statements", "line");
    }
  }

  /// x y z, x y z w, x y z r g b or x y z w r g b.
  void read_position() {
    std::array<float, 7> values{};
    size_t count = 0;
    while (count < values.size() && !statements_.at_end())
      values[count++] = statements_.number("v");
    if (count < 3) statements_.fail(concat("v has ", count, " numbers, expected 3 or more"));
    file_.positions.push_back({values[0], values[1], values[2]});
    if (count < 6) return;
    const size_t first = count - 3;
    file_.colors.resize(file_.positions.size() - 1, {1, 1, 1});
    file_.colors.push_back({image::srgb_to_linear(values[first]),
                            image::srgb_to_linear(values[first + 1]),
                            image::srgb_to_linear(values[first + 2])});
  }

  void read_uv() {
    const float u = statements_.number("vt");
    const float v = statements_.at_end() ? 0 : statements_.number("vt");
    file_.uvs.push_back({u, 1 - v});
  }

  /// One index of a corner: from 1 up, or from -1 down, counted back from the last element so far.
  uint32_t read_index(std::string_view text, size_t count, const char* what) const {
    int64_t index = 0;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), index);
    const bool number = stop == text.data() + text.size() &&
                        (error == std::errc() || error == std::errc::result_out_of_range);
    if (!number || text.empty())
      statements_.fail(concat("f: expected an index of a ", what, ", got \"", shown(text), "\""));
    const auto size = static_cast<int64_t>(count);
    if (error != std::errc() || index == 0 || index > size || index < -size)
      statements_.fail(concat("f: ", shown(text), " is no index of a ", what, "; there are ", count,
                              " before it"));
    return static_cast<uint32_t>(index > 0 ? index - 1 : size + index);
  }

  /// v, v/vt, v//vn or v/vt/vn.
  Corner read_corner(std::string_view text) const {
    const size_t first = std::min(text.find('/'), text.size());
    Corner corner{read_index(text.substr(0, first), file_.positions.size(), "vertex"), kNoUv};
    if (first == text.size()) return corner;
    const size_t second = std::min(text.find('/', first + 1), text.size());
    const std::string_view uv = text.substr(first + 1, second - first - 1);
    if (!uv.empty()) corner.uv = read_index(uv, file_.uvs.size(), "texture coordinate");
    if (second == text.size()) return corner;
    const std::string_view normal = text.substr(second + 1);
    if (!normal.empty()) read_index(normal, normals_, "normal");
    return corner;
  }

  void read_face() {
    polygon_.clear();
    while (!statements_.at_end()) polygon_.push_back(read_corner(statements_.word()));
    if (polygon_.size() < 3)
      statements_.fail(concat("f has ", polygon_.size(), " corners, expected 3 or more"));
    outline_.clear();
    ring_.clear();
    local_.clear();
    for (const Corner& corner : polygon_) {
      ring_.push_back(static_cast<uint32_t>(outline_.size()));
      outline_.push_back(file_.positions[corner.position]);
    }
    triangulate_polygon(outline_, ring_, &local_);
    triangles_ += static_cast<int64_t>(local_.size());
    if (triangles_ > limits_.triangles)
      throw OverLimit(concat(statements_.where(), ": more than ", limits_.triangles, " triangles"),
                      "triangles");
    Part& part = current_part();
    for (const auto& [a, b, c] : local_)
      part.triangles.push_back({polygon_[a], polygon_[b], polygon_[c]});
  }

  Part& current_part() {
    if (part_ == kNone) {
      const std::string& name = object_.empty() ? group_ : object_;
      const auto [found, is_new] =
          numbers_.try_emplace({name, material_}, static_cast<int>(file_.parts.size()));
      if (is_new) file_.parts.push_back({name, material_, {}});
      part_ = found->second;
    }
    return file_.parts[static_cast<size_t>(part_)];
  }

  static constexpr int kNone = -1;
  Statements statements_;
  const LoadLimits& limits_;
  IgnoredFeatures* ignored_;
  ObjFile file_;
  size_t normals_ = 0;
  int64_t triangles_ = 0;
  std::string object_, group_, material_;
  std::map<std::pair<std::string, std::string>, int> numbers_;
  int part_ = kNone;  ///< of the next face; kNone if not known yet
  std::vector<Corner> polygon_;
  std::vector<Vec3> outline_;
  std::vector<uint32_t> ring_;
  std::vector<std::array<uint32_t, 3>> local_;
};

}  // namespace

ObjFile read_obj(const SceneFile& file, const LoadLimits& limits, IgnoredFeatures* ignored) {
  LTE_CHECK(!file.text().empty(), file.name(), ": the file is empty");
  return Parser(file.text(), file.name(), limits, ignored).run();
}

}  // namespace lte::scene::obj
