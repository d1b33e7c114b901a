#include "datagen/config.h"

#include <nlohmann/json.hpp>

#include "lte/base/check.h"

namespace lte::datagen {
namespace {

/// Calls `io` with every key and the field behind it: the one list that reading and writing share.
template <typename Io, typename C>
void visit(Io& io, C& config) {
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

class Reader {
 public:
  explicit Reader(const Config& root) : root_(root), at_(root) {}
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
  const RoomConfig& rooms = config.rooms;
  range_in("rooms.width_m", rooms.width_m, 2.5, 50.0);
  range_in("rooms.depth_m", rooms.depth_m, 2.5, 50.0);
  range_in("rooms.height_m", rooms.height_m, 2.3, 10.0);
  range_in<CountRange, int64_t>("rooms.furniture", rooms.furniture, 0, 200);
  range_in<CountRange, int64_t>("rooms.lights", rooms.lights, 1, 16);
  range_in("rooms.radiance", rooms.radiance, 1e-6, 1e6);
  in_range("rooms.two_room_share", rooms.two_room_share, 0.0, 1.0);
  LTE_CHECK(!rooms.texture_sizes.empty(), "rooms.texture_sizes: expected at least one size");
  for (const int64_t size : rooms.texture_sizes)
    in_range<int64_t>("rooms.texture_sizes", size, 8, 4096);
  const double longest = rooms.two_room_share > 0 ? 2 * rooms.width_m.high + kMaxPartitionThickness
                                                  : rooms.width_m.high;
  LTE_CHECK(std::max({longest, rooms.depth_m.high, rooms.height_m.high}) <= config.scale,
            "scale: ", config.scale, " m is less than the largest scene that `rooms` allows, ",
            std::max({longest, rooms.depth_m.high, rooms.height_m.high}), " m");
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
