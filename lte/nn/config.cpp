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

void check(const ModelConfig& c) {
  check_at_least("channels", c.channels, 1);
  check_at_least("nne_neighbours", c.nne_neighbours, 1);
  check_at_least("head_width", c.head_width, 1);
  check_at_least("patch_size", c.patch_size, 1);
  check_at_least("query_neighbours", c.query_neighbours, 1);
  check_at_least("query_layers", c.query_layers, 1);
  check_at_least("gamma_hidden", c.gamma_hidden, 1);
  check_at_least("ffn_ratio", c.ffn_ratio, 1);
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
  LTE_CHECK(c.grid_per_spacing > 0, "model.grid_per_spacing must be positive, got ",
            c.grid_per_spacing);
  LTE_CHECK(c.dropout >= 0 && c.dropout < 1, "model.dropout must be in [0, 1), got ", c.dropout);
  LTE_CHECK(c.scale > 0 && c.scale < 1e12, "model.scale must be positive metres, got ", c.scale);
  LTE_CHECK(c.output_mean > 0 && c.output_mean < 1e12, "model.output_mean must be positive, got ",
            c.output_mean);
}

}  // namespace

ModelConfig ModelConfig::read(const Config& config) {
  ModelConfig c;
  config.read("channels", &c.channels);
  config.read("nne_neighbours", &c.nne_neighbours);
  config.read("encoder_depths", &c.encoder_depths);
  config.read("encoder_widths", &c.encoder_widths);
  config.read("decoder_depths", &c.decoder_depths);
  config.read("decoder_widths", &c.decoder_widths);
  config.read("head_width", &c.head_width);
  config.read("patch_size", &c.patch_size);
  config.read("stem", &c.stem);
  config.read("grid_per_spacing", &c.grid_per_spacing);
  config.read("dropout", &c.dropout);
  config.read("query_neighbours", &c.query_neighbours);
  config.read("query_layers", &c.query_layers);
  config.read("gamma_hidden", &c.gamma_hidden);
  config.read("query_attention", &c.query_attention);
  config.read("ffn_ratio", &c.ffn_ratio);
  config.read("light_input", &c.light_input);
  config.read("target", &c.target);
  config.read("scale", &c.scale);
  config.read("output_mean", &c.output_mean);
  check(c);
  return c;
}

std::string ModelConfig::to_yaml() const {
  std::ostringstream out;
  out << "channels: " << channels << "\nnne_neighbours: " << nne_neighbours
      << "\nencoder_depths: " << text(encoder_depths)
      << "\nencoder_widths: " << text(encoder_widths)
      << "\ndecoder_depths: " << text(decoder_depths)
      << "\ndecoder_widths: " << text(decoder_widths) << "\nhead_width: " << head_width
      << "\npatch_size: " << patch_size << "\nstem: " << enum_name(stem)
      << "\ngrid_per_spacing: " << text(grid_per_spacing) << "\ndropout: " << text(dropout)
      << "\nquery_neighbours: " << query_neighbours << "\nquery_layers: " << query_layers
      << "\ngamma_hidden: " << gamma_hidden << "\nquery_attention: " << enum_name(query_attention)
      << "\nffn_ratio: " << ffn_ratio << "\nlight_input: " << enum_name(light_input)
      << "\ntarget: " << enum_name(target) << "\nscale: " << text(scale)
      << "\noutput_mean: " << text(output_mean) << '\n';
  return out.str();
}

}  // namespace lte::nn
