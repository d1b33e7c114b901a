#include "datagen/dataset/config.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

#include "lte/base/check.h"
#include "lte/base/log.h"

namespace lte::datagen {
namespace {

constexpr GeneratorKind kGenerators[] = {GeneratorKind::Boxes, GeneratorKind::Homes,
                                         GeneratorKind::Wild, GeneratorKind::Mixed,
                                         GeneratorKind::Files};

template <typename Io, typename B>
void visit_boxes(Io& io, B& boxes) {
  io.section("boxes", "rooms");
  io("width_m", boxes.width_m);
  io("depth_m", boxes.depth_m);
  io("height_m", boxes.height_m);
  io("furniture", boxes.furniture);
  io("lights", boxes.lights);
  io("radiance", boxes.radiance);
  io("two_room_share", boxes.two_room_share);
  io("open_share", boxes.open_share);
  // Written only where asked for: config.yaml of boxes without skies stays what it was.
  if (io.covers(boxes.sky_share > 0)) io("sky_share", boxes.sky_share);
  if (io.covers(boxes.shut_sky_share > 0)) io("shut_sky_share", boxes.shut_sky_share);
  if (io.covers(boxes.sky_picture_share > 0)) io("sky_picture_share", boxes.sky_picture_share);
  io("size_factor", boxes.size_factor);
  io("texture_sizes", boxes.texture_sizes);
}

template <typename Io, typename H>
void visit_homes(Io& io, H& homes) {
  io.section("homes");
  io("rooms", homes.rooms);
  io("height_m", homes.height_m);
  io("detail", homes.detail);
  io("radiance", homes.radiance);
  io("daylight_share", homes.daylight_share);
  // Written only where asked for: config.yaml of homes without suns stays what it was.
  if (io.covers(homes.sun_share > 0)) io("sun_share", homes.sun_share);
  if (io.covers(homes.sky_picture_share > 0)) io("sky_picture_share", homes.sky_picture_share);
  io("lit_share", homes.lit_share);
  io("clutter", homes.clutter);
  io("texture_sizes", homes.texture_sizes);
}

template <typename Io, typename W>
void visit_wild(Io& io, W& wild) {
  io.section("wild");
  io("cells", wild.cells);
  io("extent_m", wild.extent_m);
  io("lamps", wild.lamps);
  io("sky_share", wild.sky_share);
  io("detail", wild.detail);
  io("texture_sizes", wild.texture_sizes);
}

/// Calls `io` with every key and the field behind it: the one list that reading and writing share.
/// A writer leaves out the section of the generator that is not used.
template <typename Io, typename C>
void visit(Io& io, C& config) {
  io("generator", config.generator);
  io("scenes", config.scenes);
  io("seed", config.seed);
  io("scale", config.scale);
  io("val_share", config.val_share);
  io("test_share", config.test_share);
  io("evaluation_splits", config.evaluation_splits);
  io("scene_points", config.bake.scene_points);
  io("query_points", config.bake.query_points);
  io("rays", config.bake.rays);
  io("target_error", config.bake.target_error);
  io("min_rays", config.bake.min_rays);
  io("max_rays", config.bake.max_rays);
  io("max_depth", config.bake.max_depth);
  io("light_paths", config.bake.light_paths);
  io("prune", config.bake.prune);
  io("emissive_share", config.bake.emissive_share);
  io("path_tracing_64", config.bake.path_tracing_64);
  io.section("views");
  io("count", config.bake.views.count);
  io("width", config.bake.views.width);
  io("height", config.bake.views.height);
  io("rays", config.bake.views.rays);
  // Written only where points are asked for, so that config.yaml stays short.
  if (io.covers(config.bake.incident.points > 0)) {
    io.section("incident");
    io("points", config.bake.incident.points);
    io("bins", config.bake.incident.bins);
    io("samples", config.bake.incident.samples);
  }
  if (io.covers(config.metals.share > 0)) {
    io.section("metals");
    io("share", config.metals.share);
    io("roughness", config.metals.roughness);
  }
  if (io.covers(config.sides.two_sided_share > 0 || config.sides.flipped_share > 0)) {
    io.section("sides");
    io("two_sided_share", config.sides.two_sided_share);
    io("drop_m", config.sides.drop_m);
    io("flipped_share", config.sides.flipped_share);
  }
  if (io.covers(config.generator == GeneratorKind::Mixed)) {
    io.section("mixed");
    io("boxes", config.mixed.boxes);
    io("homes", config.mixed.homes);
    io("wild", config.mixed.wild);
  }
  if (io.covers(config.generator == GeneratorKind::Files)) {
    io.section("files");
    io("folder", config.files.folder);
  }
  if (io.covers(config.makes(GeneratorKind::Boxes))) visit_boxes(io, config.boxes);
  if (io.covers(config.makes(GeneratorKind::Homes))) visit_homes(io, config.homes);
  if (io.covers(config.makes(GeneratorKind::Wild))) visit_wild(io, config.wild);
}

class Reader {
 public:
  explicit Reader(const Config& root) : root_(root), sections_{{root, ""}} {}
  static bool covers(bool) { return true; }
  /// Reads the keys that follow from section `name`. What older files say under `former` counts
  /// too, and goes before what their parent says under `name`.
  void section(const std::string& name, const std::string& former = "") {
    sections_ = {{root_.at(name), name + "."}};
    if (former.empty() || !root_.has(former)) return;
    log_info("`", former, ":` is the former name of `", name, ":`; read as that");
    sections_.push_back({root_.at(former), former + "."});
  }
  template <typename T>
  void operator()(const std::string& key, T& value) {
    for (const Section& section : sections_) section.yaml.read(key, &value);
  }
  void operator()(const std::string& key, Range& range) { read_pair<double>(key, range); }
  void operator()(const std::string& key, CountRange& range) { read_pair<int64_t>(key, range); }
  void operator()(const std::string& key, GeneratorKind& kind) {
    std::string word = generator_name(kind);
    (*this)(key, word);
    for (const GeneratorKind each : kGenerators)
      if (word == generator_name(each)) kind = each;
    LTE_CHECK(word == generator_name(kind), key,
              ": expected boxes, homes, wild, mixed or files, got \"", word, "\"");
  }

 private:
  struct Section {
    Config yaml;
    std::string prefix;
  };

  template <typename T, typename R>
  void read_pair(const std::string& key, R& range) {
    for (const Section& section : sections_) {
      std::vector<T> ends{range.low, range.high};
      section.yaml.read(key, &ends);
      LTE_CHECK(ends.size() == 2, section.prefix, key, ": expected [low, high], got ", ends.size(),
                " numbers");
      range = {ends[0], ends[1]};
    }
  }

  Config root_;
  std::vector<Section> sections_;
};

class Writer {
 public:
  static bool covers(bool used) { return used; }
  void section(const std::string& name, const std::string& /*former*/ = "") {
    text_ += concat(name, ":\n");
    indent_ = "  ";
  }
  template <typename T>
  void operator()(const std::string& key, const T& value) {
    line(key, nlohmann::json(value).dump());
  }
  void operator()(const std::string& key, const Range& r) { line(key, pair(r.low, r.high)); }
  void operator()(const std::string& key, const CountRange& r) { line(key, pair(r.low, r.high)); }
  void operator()(const std::string& key, GeneratorKind kind) {
    line(key, nlohmann::json(generator_name(kind)).dump());
  }
  const std::string& text() const { return text_; }

 private:
  template <typename T>
  static std::string pair(T low, T high) {
    return concat("[", nlohmann::json(low).dump(), ", ", nlohmann::json(high).dump(), "]");
  }
  void line(const std::string& key, const std::string& value) {
    text_ += concat(indent_, key, ": ", value, "\n");
  }
  std::string text_, indent_;
};

template <typename T>
void in_range(const char* key, T value, T low, T high) {
  LTE_CHECK(value >= low && value <= high, key, ": expected a value in [", low, ", ", high,
            "], got ", value);
}

template <typename R, typename T>
void range_in(const char* key, const R& range, T low, T high) {
  LTE_CHECK(range.low >= low && range.low <= range.high && range.high <= high, key,
            ": expected low <= high, both in [", low, ", ", high, "], got [", range.low, ", ",
            range.high, "]");
}

void check_texture_sizes(const std::string& key, const std::vector<int64_t>& sizes) {
  LTE_CHECK(!sizes.empty(), key, ": expected at least one size");
  for (const int64_t size : sizes) in_range<int64_t>(key.c_str(), size, 8, 4096);
}

void check_boxes(const boxes::RoomConfig& boxes, double scale) {
  range_in("boxes.width_m", boxes.width_m, 2.5, 50.0);
  range_in("boxes.depth_m", boxes.depth_m, 2.5, 50.0);
  range_in("boxes.height_m", boxes.height_m, 2.3, 10.0);
  range_in<CountRange, int64_t>("boxes.furniture", boxes.furniture, 0, 200);
  range_in<CountRange, int64_t>("boxes.lights", boxes.lights, 1, 16);
  range_in("boxes.radiance", boxes.radiance, 1e-6, 1e6);
  in_range("boxes.two_room_share", boxes.two_room_share, 0.0, 1.0);
  in_range("boxes.open_share", boxes.open_share, 0.0, 1.0);
  in_range("boxes.sky_share", boxes.sky_share, 0.0, 1.0);
  in_range("boxes.shut_sky_share", boxes.shut_sky_share, 0.0, 1.0);
  in_range("boxes.sky_picture_share", boxes.sky_picture_share, 0.0, 1.0);
  range_in("boxes.size_factor", boxes.size_factor, 0.01, 100.0);
  check_texture_sizes("boxes.texture_sizes", boxes.texture_sizes);
  const double width = boxes.two_room_share > 0
                           ? 2 * boxes.width_m.high + boxes::kMaxPartitionThickness
                           : boxes.width_m.high;
  const double longest =
      std::max({width, boxes.depth_m.high, boxes.height_m.high}) * boxes.size_factor.high;
  LTE_CHECK(longest <= scale, "scale: ", scale,
            " m is less than the largest scene that `boxes` allows, ", longest, " m");
  const double sphere =
      std::hypot(width, boxes.depth_m.high, boxes.height_m.high) * boxes.size_factor.high;
  LTE_CHECK((boxes.sky_share == 0 && boxes.shut_sky_share == 0) || sphere <= scale,
            "scale: ", scale,
            " m is less than the sphere around the largest scene that `boxes` allows, ", sphere,
            " m, on which a sky (boxes.sky_share, boxes.shut_sky_share) stands");
}

void check_homes(const homes::HomeConfig& homes, double scale) {
  range_in<CountRange, int64_t>("homes.rooms", homes.rooms, 1, 6);
  range_in("homes.height_m", homes.height_m, 2.4, 4.0);
  range_in("homes.detail", homes.detail, 0.3, 4.0);
  range_in("homes.radiance", homes.radiance, 1e-6, 1e6);
  in_range("homes.daylight_share", homes.daylight_share, 0.0, 1.0);
  in_range("homes.sun_share", homes.sun_share, 0.0, 1.0);
  in_range("homes.sky_picture_share", homes.sky_picture_share, 0.0, 1.0);
  in_range("homes.lit_share", homes.lit_share, 0.0, 1.0);
  in_range("homes.clutter", homes.clutter, 0.0, 2.0);
  check_texture_sizes("homes.texture_sizes", homes.texture_sizes);
  LTE_CHECK(homes::kMaxHomeExtent <= scale, "scale: ", scale, " m is less than the largest home, ",
            homes::kMaxHomeExtent, " m");
  const bool large = homes.rooms.high > homes::kMaxRoomsOfSmallHomes;
  LTE_CHECK(homes.sun_share == 0 || !large || homes::kMaxHomeSphere <= scale, "scale: ", scale,
            " m is less than the sphere around the largest home, ", homes::kMaxHomeSphere,
            " m, on which a sun (homes.sun_share) stands");
}

void check_wild(const wild::WildConfig& wild, double scale) {
  range_in<CountRange, int64_t>("wild.cells", wild.cells, 1, 5);
  range_in("wild.extent_m", wild.extent_m, wild::kMinExtent, 1e3);
  range_in<CountRange, int64_t>("wild.lamps", wild.lamps, 1, 40);
  in_range("wild.sky_share", wild.sky_share, 0.0, 1.0);
  range_in("wild.detail", wild.detail, 0.3, 4.0);
  check_texture_sizes("wild.texture_sizes", wild.texture_sizes);
  LTE_CHECK(wild.extent_m.high <= scale, "scale: ", scale,
            " m is less than the largest scene that wild.extent_m allows, ", wild.extent_m.high,
            " m");
}

void check_mixed(const MixedConfig& mixed) {
  in_range("mixed.boxes", mixed.boxes, 0.0, 1e6);
  in_range("mixed.homes", mixed.homes, 0.0, 1e6);
  in_range("mixed.wild", mixed.wild, 0.0, 1e6);
  LTE_CHECK(mixed.boxes + mixed.homes + mixed.wild > 0, "mixed: all shares are 0");
}

void check_files(const DatagenConfig& config) {
  LTE_CHECK(!config.files.folder.empty(), "files.folder: is empty; name the folder of the scenes");
  for (const auto& [key, share] : {std::pair{"metals.share", config.metals.share},
                                   {"sides.two_sided_share", config.sides.two_sided_share},
                                   {"sides.flipped_share", config.sides.flipped_share}})
    LTE_CHECK(share == 0, key, ": scenes of files stay as they are; expected 0, got ", share);
}

}  // namespace

const char* generator_name(GeneratorKind kind) {
  switch (kind) {
    case GeneratorKind::Homes:
      return "homes";
    case GeneratorKind::Wild:
      return "wild";
    case GeneratorKind::Mixed:
      return "mixed";
    case GeneratorKind::Files:
      return "files";
    default:
      return "boxes";
  }
}

bool DatagenConfig::makes(GeneratorKind kind) const {
  if (generator != GeneratorKind::Mixed) return generator == kind;
  const double share = kind == GeneratorKind::Boxes   ? mixed.boxes
                       : kind == GeneratorKind::Homes ? mixed.homes
                       : kind == GeneratorKind::Wild  ? mixed.wild
                                                      : 1;
  return share > 0;
}

void check_datagen_config(const DatagenConfig& config) {
  in_range<int64_t>("scenes", config.scenes, 1, 10'000'000);
  in_range("scale", config.scale, 0.1, 1e6);
  in_range("val_share", config.val_share, 0.0, 1.0);
  in_range("test_share", config.test_share, 0.0, 1.0);
  LTE_CHECK(config.val_share + config.test_share <= 1, "val_share and test_share: together ",
            config.val_share + config.test_share, ", expected at most 1");
  for (const std::string& split : config.evaluation_splits) {
    LTE_CHECK(split == "train" || split == "val" || split == "test",
              "evaluation_splits: expected train, val or test, got \"", split, "\"");
  }
  check_bake_options(config.bake);
  in_range("metals.share", config.metals.share, 0.0, 1.0);
  range_in("metals.roughness", config.metals.roughness, 0.01, 1.0);
  in_range("sides.two_sided_share", config.sides.two_sided_share, 0.0, 1.0);
  range_in("sides.drop_m", config.sides.drop_m, 0.001, 0.7);
  in_range("sides.flipped_share", config.sides.flipped_share, 0.0, 1.0);
  check_mixed(config.mixed);
  if (config.generator == GeneratorKind::Files) check_files(config);
  if (config.makes(GeneratorKind::Boxes)) check_boxes(config.boxes, config.scale);
  if (config.makes(GeneratorKind::Homes)) check_homes(config.homes, config.scale);
  if (config.makes(GeneratorKind::Wild)) check_wild(config.wild, config.scale);
}

DatagenConfig read_datagen_config(const Config& yaml) {
  DatagenConfig config;
  Reader reader(yaml);
  visit(reader, config);
  yaml.finish();
  check_datagen_config(config);
  return config;
}

DatagenConfig load_datagen_config(const std::filesystem::path& path,
                                  const std::vector<std::string>& overrides) {
  const Config yaml = Config::load(path, overrides);
  try {
    return read_datagen_config(yaml);
  } catch (const Error& error) {
    const std::string message = error.what();  // ranges are checked without knowing the file
    throw Error(message.find(path.string()) == std::string::npos ? path.string() + ": " + message
                                                                 : message);
  }
}

std::string to_yaml(const DatagenConfig& config) {
  Writer writer;
  visit(writer, config);
  return writer.text();
}

}  // namespace lte::datagen
