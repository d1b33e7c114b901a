#include "lte/nn/config.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <sstream>

#include "lte/base/check.h"

namespace lte::nn {
namespace {

std::string text(double value) {
  std::array<char, 32> digits;  // the shortest decimal that reads back the same
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  return {digits.data(), end};
}

std::string text(int64_t value) { return std::to_string(value); }

template <EnumClass Enum>
std::string text(Enum value) {
  return enum_name(value);
}

std::string text(const std::vector<int64_t>& values) {
  std::ostringstream out;
  out << '[';
  for (size_t i = 0; i < values.size(); ++i) out << (i > 0 ? ", " : "") << values[i];
  out << ']';
  return out.str();
}

void check_at_least(const char* key, int64_t value, int64_t least) {
  LTE_CHECK(value >= least, "model.", key, " must be at least ", least, ", got ", value);
}

void check_list(const char* key, const std::vector<int64_t>& values, size_t size, int64_t least) {
  LTE_CHECK(values.size() == size, "model.", key, " must have ", size, " entries, got ",
            values.size());
  for (const int64_t value : values) check_at_least(key, value, least);
}

/// All heads are as wide as the key says, so that a stage's angles serve all of its blocks; and a
/// head has at least one pair of channels for each axis.
void check_rotary(const ModelConfig& c) {
  LTE_CHECK(c.head_width % 2 == 0 && c.head_width >= 6,
            "model.preset lte: model.head_width must be even and at least 6, got ", c.head_width);
  for (const auto* widths : {&c.encoder_widths, &c.decoder_widths}) {
    for (const int64_t width : *widths) {
      LTE_CHECK(width * c.channels % c.head_width == 0, "model.preset lte: model.head_width ",
                c.head_width, " does not divide the stage width ", width * c.channels);
    }
  }
}

void check_radiance(const ModelConfig& c) {
  check_at_least("radiance_lobes", c.radiance_lobes, 0);
  LTE_CHECK(!c.predicts_radiance() || c.reads_light(), "model.radiance_lobes ", c.radiance_lobes,
            ": model.light_input must be traced or radiosity, got ", enum_name(c.light_input));
}

void check(const ModelConfig& c) {
  check_at_least("channels", c.channels, 1);
  check_at_least("nne_neighbours", c.nne_neighbours, 1);
  check_at_least("head_width", c.head_width, 1);
  check_at_least("patch_size", c.patch_size, 1);
  check_at_least("query_neighbours", c.query_neighbours, 1);
  check_at_least("query_layers", c.query_layers, 1);
  check_radiance(c);
  const size_t stages = c.encoder_depths.size();
  LTE_CHECK(stages >= 1 && stages <= 12, "model.encoder_depths must have 1 to 12 entries, got ",
            stages);
  check_list("encoder_depths", c.encoder_depths, stages, 0);
  check_list("encoder_widths", c.encoder_widths, stages, 1);
  check_list("decoder_depths", c.decoder_depths, stages - 1, 0);
  check_list("decoder_widths", c.decoder_widths, stages - 1, 1);
  for (const auto* widths : {&c.encoder_widths, &c.decoder_widths}) {
    for (const int64_t width : *widths) {
      const int64_t channels = width * c.channels;
      LTE_CHECK(channels % std::max<int64_t>(1, channels / c.head_width) == 0, "model.head_width ",
                c.head_width, " does not divide the stage width ", channels);
    }
  }
  if (c.rotates_attention()) check_rotary(c);
  LTE_CHECK(c.dropout >= 0 && c.dropout < 1, "model.dropout must be in [0, 1), got ", c.dropout);
  LTE_CHECK(c.scale > 0 && c.scale < 1e12, "model.scale must be positive metres, got ", c.scale);
  LTE_CHECK(c.output_mean > 0 && c.output_mean < 1e12, "model.output_mean must be positive, got ",
            c.output_mean);
}

/// Calls visit(key, field) for every field, in the order of the YAML. The only list of them.
///
/// @param config  ModelConfig, const or not
template <typename Configuration, typename Visit>
void for_each_field(Configuration& config, const Visit& visit) {
  visit("preset", config.preset);
  visit("channels", config.channels);
  visit("nne_neighbours", config.nne_neighbours);
  visit("encoder_depths", config.encoder_depths);
  visit("encoder_widths", config.encoder_widths);
  visit("decoder_depths", config.decoder_depths);
  visit("decoder_widths", config.decoder_widths);
  visit("head_width", config.head_width);
  visit("patch_size", config.patch_size);
  visit("dropout", config.dropout);
  visit("query_neighbours", config.query_neighbours);
  visit("query_layers", config.query_layers);
  visit("light_input", config.light_input);
  visit("radiance_lobes", config.radiance_lobes);
  visit("scale", config.scale);
  visit("output_mean", config.output_mean);
}

}  // namespace

ModelConfig ModelConfig::of(Preset preset) {
  ModelConfig c;
  c.preset = preset;
  if (preset == Preset::Paper) return c;
  c.channels = 48;
  // A patch of 4,096 sees all latents of 16,384 points: further stages bring no more context.
  c.patch_size = 4096;
  c.encoder_depths = {2, 2, 6};
  c.encoder_widths = {1, 1, 2};
  c.decoder_depths = {2, 2};
  c.decoder_widths = {1, 1};
  c.head_width = 16;
  c.dropout = 0;
  c.query_neighbours = 16;
  c.query_layers = 4;
  c.light_input = LightInput::Radiosity;
  return c;
}

ModelConfig ModelConfig::read(const Config& config) {
  Preset preset = Preset::Paper;
  config.read("preset", &preset);
  ModelConfig c = of(preset);
  for_each_field(c, [&](const char* key, auto& field) { config.read(key, &field); });
  check(c);
  return c;
}

std::string ModelConfig::to_yaml() const {
  std::string yaml;
  for_each_field(*this, [&](const char* key, const auto& field) {
    yaml += concat(key, ": ", text(field), "\n");
  });
  return yaml;
}

std::vector<ConfigDifference> differences(const ModelConfig& first, const ModelConfig& second) {
  std::vector<ConfigDifference> all;
  for_each_field(first, [&](const char* key, const auto& field) {
    all.push_back({key, text(field), ""});
  });
  size_t row = 0;
  for_each_field(second, [&](const char*, const auto& field) { all[row++].second = text(field); });
  std::erase_if(all, [](const ConfigDifference& d) { return d.first == d.second; });
  return all;
}

}  // namespace lte::nn
