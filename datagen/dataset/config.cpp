#include "datagen/dataset/config.h"

#include <nlohmann/json.hpp>

#include "lte/base/check.h"

namespace lte::datagen {
namespace {

constexpr const char* kBoxes = "boxes";
constexpr const char* kHomes = "homes";

template <typename Io, typename C>
void visit_rooms(Io& io, C& config) {
  io.section("rooms");
  io("width_m", config.rooms.width_m);
  io("depth_m", config.rooms.depth_m);
  io("height_m", config.rooms.height_m);
  io("furniture", config.rooms.furniture);
  io("lights", config.rooms.lights);
  io("radiance", config.rooms.radiance);
  io("two_room_share", config.rooms.two_room_share);
  io("texture_sizes", config.rooms.texture_sizes);
}

template <typename Io, typename H>
void visit_homes(Io& io, H& homes) {
  io.section("homes");
  io("rooms", homes.rooms);
  io("height_m", homes.height_m);
  io("detail", homes.detail);
  io("radiance", homes.radiance);
  io("daylight_share", homes.daylight_share);
  io("lit_share", homes.lit_share);
  io("clutter", homes.clutter);
  io("texture_sizes", homes.texture_sizes);
}

/// Calls `io` with every key and the field behind it: the one list that reading and writing share.
/// A writer leaves out the section of the generator that is not used.
template <typename Io, typename C>
void visit(Io& io, C& config) {
  if (io.covers(config.generator == kHomes)) io("generator", config.generator);
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
  io("prune", config.bake.prune);
  io("emissive_share", config.bake.emissive_share);
  io("path_tracing_64", config.bake.path_tracing_64);
  io.section("views");
  io("count", config.bake.views.count);
  io("width", config.bake.views.width);
  io("height", config.bake.views.height);
  io("rays", config.bake.views.rays);
  // Not named where there are none, so that older data sets keep their config.yaml.
  if (io.covers(config.bake.incident.points > 0)) {
    io.section("incident");
    io("points", config.bake.incident.points);
    io("bins", config.bake.incident.bins);
    io("samples", config.bake.incident.samples);
  }
  if (io.covers(config.generator == kBoxes)) visit_rooms(io, config);
  if (io.covers(config.generator == kHomes)) visit_homes(io, config.homes);
}

class Reader {
 public:
  explicit Reader(const Config& root) : root_(root), at_(root) {}
  static bool covers(bool) { return true; }
  void section(const std::string& name) {
    at_ = root_.at(name);
    prefix_ = name + ".";
  }
  template <typename T>
  void operator()(const std::string& key, T& value) {
    at_.read(key, &value);
  }
  void operator()(const std::string& key, Range& range) {
    std::vector<double> ends{range.low, range.high};
    at_.read(key, &ends);
    pair(key, ends.size());
    range = {ends[0], ends[1]};
  }
  void operator()(const std::string& key, CountRange& range) {
    std::vector<int64_t> ends{range.low, range.high};
    at_.read(key, &ends);
    pair(key, ends.size());
    range = {ends[0], ends[1]};
  }

 private:
  void pair(const std::string& key, size_t size) const {
    LTE_CHECK(size == 2, prefix_, key, ": expected [low, high], got ", size, " numbers");
  }
  Config root_, at_;
  std::string prefix_;
};

class Writer {
 public:
  static bool covers(bool used) { return used; }
  void section(const std::string& name) {
    text_ += concat(name, ":\n");
    indent_ = "  ";
  }
  template <typename T>
  void operator()(const std::string& key, const T& value) {
    line(key, nlohmann::json(value).dump());
  }
  void operator()(const std::string& key, const Range& r) { line(key, pair(r.low, r.high)); }
  void operator()(const std::string& key, const CountRange& r) { line(key, pair(r.low, r.high)); }
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

void check_rooms(const RoomConfig& rooms, double scale) {
  range_in("rooms.width_m", rooms.width_m, 2.5, 50.0);
  range_in("rooms.depth_m", rooms.depth_m, 2.5, 50.0);
  range_in("rooms.height_m", rooms.height_m, 2.3, 10.0);
  range_in<CountRange, int64_t>("rooms.furniture", rooms.furniture, 0, 200);
  range_in<CountRange, int64_t>("rooms.lights", rooms.lights, 1, 16);
  range_in("rooms.radiance", rooms.radiance, 1e-6, 1e6);
  in_range("rooms.two_room_share", rooms.two_room_share, 0.0, 1.0);
  check_texture_sizes("rooms.texture_sizes", rooms.texture_sizes);
  const double longest = rooms.two_room_share > 0 ? 2 * rooms.width_m.high + kMaxPartitionThickness
                                                  : rooms.width_m.high;
  LTE_CHECK(std::max({longest, rooms.depth_m.high, rooms.height_m.high}) <= scale, "scale: ", scale,
            " m is less than the largest scene that `rooms` allows, ",
            std::max({longest, rooms.depth_m.high, rooms.height_m.high}), " m");
}

void check_homes(const homes::HomeConfig& homes, double scale) {
  range_in<CountRange, int64_t>("homes.rooms", homes.rooms, 1, 6);
  range_in("homes.height_m", homes.height_m, 2.4, 4.0);
  range_in("homes.detail", homes.detail, 0.3, 4.0);
  range_in("homes.radiance", homes.radiance, 1e-6, 1e6);
  in_range("homes.daylight_share", homes.daylight_share, 0.0, 1.0);
  in_range("homes.lit_share", homes.lit_share, 0.0, 1.0);
  in_range("homes.clutter", homes.clutter, 0.0, 2.0);
  check_texture_sizes("homes.texture_sizes", homes.texture_sizes);
  LTE_CHECK(homes::kMaxHomeExtent <= scale, "scale: ", scale, " m is less than the largest home, ",
            homes::kMaxHomeExtent, " m");
}

}  // namespace

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
  LTE_CHECK(config.generator == kBoxes || config.generator == kHomes,
            "generator: expected boxes or homes, got \"", config.generator, "\"");
  if (config.generator == kBoxes) check_rooms(config.rooms, config.scale);
  if (config.generator == kHomes) check_homes(config.homes, config.scale);
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
