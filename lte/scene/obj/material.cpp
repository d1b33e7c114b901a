#include "lte/scene/obj/material.h"

#include <algorithm>
#include <array>
#include <set>
#include <string_view>
#include <utility>

#include "lte/base/check.h"
#include "lte/scene/obj/text.h"

namespace lte::scene::obj {
namespace {

constexpr size_t kMaxBytes = size_t{1} << 28;
constexpr float kRoughness = 0.5f;  ///< of a metal without Pr

/// What a statement says that our surfaces cannot show. Values of zero say nothing.
struct Lost {
  std::string_view keyword, what;
};
constexpr std::array<Lost, 13> kLost{{{"Ks", "Ks, specular color"},
                                      {"map_Ks", "map_Ks, specular map"},
                                      {"map_Ns", "map_Ns, gloss map"},
                                      {"map_d", "map_d, opacity map (surfaces are opaque)"},
                                      {"map_bump", "bump map"},
                                      {"map_Bump", "bump map"},
                                      {"bump", "bump map"},
                                      {"disp", "displacement map"},
                                      {"refl", "reflection map"},
                                      {"map_Pm", "map_Pm, metallic map"},
                                      {"map_Pr", "map_Pr, roughness map"},
                                      {"Ps", "Ps, sheen"},
                                      {"Pc", "Pc, clear coat"}}};

/// Options of a map and the words that follow each (at most, for -s, -o and -t).
struct MapOption {
  std::string_view name;
  int words;
};
constexpr std::array<MapOption, 7> kSkippedOptions{{{"-blendu", 1},
                                                    {"-blendv", 1},
                                                    {"-boost", 1},
                                                    {"-cc", 1},
                                                    {"-imfchan", 1},
                                                    {"-mm", 2},
                                                    {"-texres", 1}}};

bool is_number(std::string_view word) {
  return !word.empty() && word.find_first_not_of("0123456789+-.eE") == std::string_view::npos &&
         word.find_first_of("0123456789") != std::string_view::npos;
}

/// One line of a map: options, then a file name that may hold spaces.
struct MapLine {
  std::string file, where;
  Vec2 offset{0, 0}, scale{1, 1};
  float multiplier = 1;
  bool clamp = false;
};

class MtlReader {
 public:
  MtlReader(const SceneFile& file, SceneFiles* files, IgnoredFeatures* ignored,
            MaterialLibrary* library)
      : file_(file),
        files_(files),
        statements_(file.text(), file.name()),
        ignored_(ignored),
        library_(library) {}

  void run() {
    while (statements_.next()) {
      const std::string_view keyword = statements_.word();
      if (keyword == "newmtl") {
        finish();
        start(std::string(statements_.rest()));
      } else if (open_) {
        read_statement(keyword);
      }
    }
    finish();
  }

 private:
  void start(std::string name) {
    open_ = true;
    material_ = Material{};
    material_.name = std::move(name);
    has_kd_ = has_ke_ = has_pr_ = false;
    map_kd_ = map_ke_ = map_normal_ = MapLine{};
    lost_.clear();
  }

  void read_statement(std::string_view keyword) {
    if (keyword == "Kd") {
      material_.base_color = read_color("Kd");
      has_kd_ = true;
    } else if (keyword == "Ke") {
      material_.emission = read_color("Ke");
      has_ke_ = true;
    } else if (keyword == "map_Kd") {
      map_kd_ = read_map();
    } else if (keyword == "map_Ke") {
      map_ke_ = read_map();
    } else if (keyword == "norm" || keyword == "map_Kn") {
      map_normal_ = read_map();
    } else if (keyword == "Pm" || keyword == "Pr") {
      const float value = std::clamp(statements_.number(keyword == "Pm" ? "Pm" : "Pr"), 0.0f, 1.0f);
      (keyword == "Pm" ? material_.metallic : material_.roughness) = value;
      has_pr_ |= keyword == "Pr";
    } else if (keyword == "d" || keyword == "Tr") {
      read_opacity(keyword);
    } else if (keyword == "illum") {
      const std::string_view model = statements_.word();
      const std::string_view named = "3456789";
      if (model.size() == 1 && named.find(model[0]) != std::string_view::npos)
        lost_.insert(concat("illum ", model, ", mirrors or glass (only Pm makes metal)"));
    } else {
      const auto found = std::find_if(kLost.begin(), kLost.end(),
                                      [&](const Lost& lost) { return lost.keyword == keyword; });
      if (found != kLost.end() && !is_zero(statements_.rest())) lost_.emplace(found->what);
    }
  }

  static bool is_zero(std::string_view values) {
    return values.find_first_not_of("0.+- \t") == std::string_view::npos;
  }

  /// One number is gray. CIE XYZ and spectral files are ignored.
  Rgb read_color(const char* what) {
    Statements ahead = statements_;
    if (const std::string_view form = ahead.word(); form == "xyz" || form == "spectral") {
      lost_.insert(concat(what, " ", form));
      return Rgb{1, 1, 1} * (what[1] == 'd' ? kDefaultGray : 0.0f);
    }
    Rgb color;
    color.x = statements_.number(what);
    color.y = color.z = color.x;
    if (!statements_.at_end()) {
      color.y = statements_.number(what);
      color.z = statements_.number(what);
    }
    if (color.x < 0 || color.y < 0 || color.z < 0)
      statements_.fail(concat(what, " must not be negative"));
    return color;
  }

  void read_opacity(std::string_view keyword) {
    Statements ahead = statements_;
    if (ahead.word() == "-halo") statements_.word();
    const float value = statements_.number(keyword == "d" ? "d" : "Tr");
    if ((keyword == "d" && value < 1) || (keyword == "Tr" && value > 0))
      lost_.insert("d or Tr, transparency (surfaces are opaque)");
  }

  MapLine read_map() {
    MapLine map;
    for (Statements ahead = statements_;; ahead = statements_) {
      const std::string_view option = ahead.word();
      if (option == "-s" || option == "-o" || option == "-t") {
        statements_.word();
        const Vec2 pair = read_pair(option == "-s" ? Vec2{1, 1} : Vec2{0, 0});
        if (option == "-s") map.scale = pair;
        if (option == "-o") map.offset = pair;
      } else if (option == "-bm") {
        statements_.word();
        map.multiplier = statements_.number("-bm");
      } else if (option == "-clamp") {
        statements_.word();
        map.clamp = statements_.word() == "on";
      } else if (const auto skipped =
                     std::find_if(kSkippedOptions.begin(), kSkippedOptions.end(),
                                  [&](const MapOption& item) { return item.name == option; });
                 skipped != kSkippedOptions.end()) {
        for (int i = 0; i <= skipped->words; ++i) statements_.word();
      } else {
        map.file = statements_.rest();
        map.where = statements_.where();
        return map;
      }
    }
  }

  /// One to three numbers, of which two count.
  Vec2 read_pair(Vec2 pair) {
    for (int i = 0; i < 3; ++i) {
      Statements ahead = statements_;
      if (!is_number(ahead.word())) break;
      const float value = statements_.number("map option");
      if (i < 2) (&pair.x)[i] = value;
    }
    return pair;
  }

  TextureRef to_ref(const MapLine& map, bool color = true) {
    TextureRef ref;
    if (map.file.empty()) return ref;
    const SceneFilePtr file = find_beside(file_, map.file, map.where, files_);
    if (!file) {
      ignored_->add(file_.outside()
                        ? "texture of a material file outside the folder, which is not there"
                        : concat("texture \"", shown(map.file), "\", which is not there"),
                    "use");
      return ref;
    }
    auto& pictures = library_->pictures;
    const std::pair picture{file, color};
    ref.texture =
        static_cast<int>(std::find(pictures.begin(), pictures.end(), picture) - pictures.begin());
    if (static_cast<size_t>(ref.texture) == pictures.size()) pictures.push_back(picture);
    if (map.clamp) ref.wrap_u = ref.wrap_v = Wrap::ClampToEdge;
    // The file's V points up: o + s v becomes 1 - (o + s (1 - v)).
    ref.scale = map.scale;
    ref.offset = {map.offset.x, 1 - map.offset.y - map.scale.y};
    return ref;
  }

  void finish() {
    if (!std::exchange(open_, false)) return;
    const auto [place, is_new] =
        library_->by_name.try_emplace(material_.name, static_cast<int>(library_->materials.size()));
    if (!is_new) return ignored_->add("material given twice, the later one", "material");
    material_.base_color_texture = to_ref(map_kd_);
    const bool textured = material_.base_color_texture.texture != kNone;
    if (!has_kd_) material_.base_color = Rgb{1, 1, 1} * (textured ? 1 : kDefaultGray);
    if (textured && max_component(material_.base_color) == 0) {
      // Some exporters mean "all from the texture"; a product of 0 is never meant.
      ignored_->add("Kd of 0 beside a map_Kd", "material");
      material_.base_color = {1, 1, 1};
    }
    if (material_.metallic > 0 && !has_pr_) {
      material_.roughness = kRoughness;
      lost_.insert("Pm without Pr (roughness 0.5 taken)");
    }
    material_.normal_texture = to_ref(map_normal_, /*color=*/false);
    material_.normal_scale = map_normal_.multiplier;
    if (!has_ke_ && !map_ke_.file.empty()) material_.emission = {1, 1, 1};
    if (material_.emissive()) {
      material_.double_sided = true;  // the format says nothing of sides
      material_.emission_texture = to_ref(map_ke_);
      // Without its picture an emitter would shine all over.
      if (!map_ke_.file.empty() && material_.emission_texture.texture == kNone)
        material_.emission = {};
    }
    for (const std::string& what : lost_) ignored_->add(what, "material");
    library_->materials.push_back(std::move(material_));
  }

  const SceneFile& file_;
  SceneFiles* files_;
  Statements statements_;
  IgnoredFeatures* ignored_;
  MaterialLibrary* library_;
  bool open_ = false, has_kd_ = false, has_ke_ = false, has_pr_ = false;
  Material material_;
  MapLine map_kd_, map_ke_, map_normal_;
  std::set<std::string> lost_;
};

}  // namespace

SceneFilePtr find_beside(const SceneFile& from, const std::string& name, const std::string& where,
                         SceneFiles* files) {
  std::string plain = name;
  std::replace(plain.begin(), plain.end(), '\\', '/');
  const std::filesystem::path folder = from.path().parent_path(), wanted = plain;
  if (!wanted.has_filename()) return nullptr;
  const bool foreign = wanted.is_absolute() || plain.find(':') != std::string::npos;
  std::vector<std::filesystem::path> candidates;
  if (!foreign) candidates.push_back(folder / wanted);
  candidates.push_back(folder / wanted.filename());
  return files->open(candidates, name, where, SceneFiles::Special::IsMissing);
}

void read_mtl(const SceneFile& file, SceneFiles* files, IgnoredFeatures* ignored,
              MaterialLibrary* library) {
  LTE_CHECK(file.text().size() <= kMaxBytes, file.name(), ": is larger than the limit of ",
            kMaxBytes, " bytes");
  read_discreetly(file, "material file", [&] { MtlReader(file, files, ignored, library).run(); });
}

}  // namespace lte::scene::obj
