#include "infer/bake/bake_parts.h"

#include <array>
#include <charconv>
#include <cstdio>
#include <set>
#include <system_error>

#include <nlohmann/json.hpp>

#include "lte/base/check.h"
#include "lte/base/safetensors.h"

namespace lte::infer {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMadeWith = "made_with";
constexpr const char* kHint = "; bake without --resume, or remove the file";
constexpr int kMaxShards = 10'000;

/// Shards of a part's file name; 0 of any other.
int shards_in(const std::string& file) {
  int number = 0, count = 0, layer = 0, end = 0;
  const bool is_part = std::sscanf(file.c_str(), "part_%d_of_%d_layer_%d.safetensors%n", &number,
                                   &count, &layer, &end) == 3 &&
                       end == static_cast<int>(file.size());
  return is_part ? count : 0;
}

template <typename Use>
void for_parts(const fs::path& folder, const Use& use) {
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const int count = shards_in(entry.path().filename().string());
    if (count > 0) use(entry.path(), count);
  }
}

/// The vectors of samples, by name.
template <typename Samples, typename Use>
void for_sums(Samples& samples, const std::string& name, const Use& use) {
  for (size_t h = 0; h < 2; ++h) {
    use(concat(name, ".indirect.", h), samples.indirect[h]);
    if (!samples.direct[h].empty()) use(concat(name, ".direct.", h), samples.direct[h]);
  }
}

}  // namespace

fs::path BakeParts::name(bake::Shard shard, size_t layer) const {
  return folder_ /
         concat("part_", shard.number + 1, "_of_", shard.count, "_layer_", layer, ".safetensors");
}

int BakeParts::shards() const {
  std::set<int> counts;
  for_parts(folder_, [&](const fs::path&, int count) { counts.insert(count); });
  LTE_CHECK(counts.size() <= 1, folder_.string(), ": has parts of ",
            counts.empty() ? 0 : *counts.begin(), " and of ", counts.empty() ? 0 : *counts.rbegin(),
            " shards; remove those that are too many");
  return counts.empty() ? 0 : *counts.begin();
}

std::optional<bake::LightState> BakeParts::read(bake::Shard shard, size_t layer, size_t texels,
                                                size_t charts, bool direct) const {
  const fs::path path = name(shard, layer);
  if (!fs::exists(path)) return std::nullopt;
  const SafetensorsFile file(path);
  file.verify();
  MadeWith there;
  try {
    there = nlohmann::json::parse(file.metadata(kMadeWith)).get<MadeWith>();
  } catch (const nlohmann::json::exception&) {
    throw Error(concat(path.string(), ": does not say how it was made", kHint));
  }
  check_made_with(path.string(), "it was", there, made_with_, kHint);
  return read_state(file, texels, charts, direct);
}

void BakeParts::write(bake::Shard shard, size_t layer, const bake::LightState& state) const {
  SafetensorsWriter writer;
  StateCounts counts;
  add_state(state, &counts, &writer);
  writer.set_metadata(
      kMadeWith,
      nlohmann::json(made_with_).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  writer.write(name(shard, layer));
}

void BakeParts::remove(int shards) const {
  std::vector<fs::path> found;
  for_parts(folder_, [&](const fs::path& path, int count) {
    if (count == shards) found.push_back(path);
  });
  std::error_code ignored;
  for (const fs::path& path : found) fs::remove(path, ignored);
}

void add_state(const bake::LightState& state, StateCounts* counts, SafetensorsWriter* writer) {
  const auto add = [&](const std::string& tensor, const std::vector<Rgb>& from) {
    writer->add(tensor, {static_cast<int64_t>(from.size()), 3},
                reinterpret_cast<const float*>(from.data()));
  };
  for_sums(state.samples, "samples", add);
  for_sums(state.paths, "paths", add);
  writer->add("dark", {static_cast<int64_t>(state.dark.size())}, state.dark.data());
  writer->add("rate", {static_cast<int64_t>(state.rate.size())}, state.rate.data());
  writer->add("back", {static_cast<int64_t>(state.back.size())}, state.back.data());
  *counts = {state.two_sided, state.samples.passes[0], state.samples.passes[1],
             state.paths.passes[0], state.paths.passes[1]};
  writer->add("counts", {5}, counts->data());
}

bake::LightState read_state(const SafetensorsFile& file, size_t texels, size_t charts,
                            bool direct) {
  const auto rows = static_cast<int64_t>(texels);
  bake::LightState out;
  out.samples = bake::TexelSamples(texels, direct);
  out.paths = bake::TexelSamples(texels, false);
  const auto take = [&](const std::string& tensor, std::vector<Rgb>& to) {
    const std::span<const float> from = file.values<float>(tensor, {rows, 3});
    for (size_t i = 0; i < texels; ++i) to[i] = {from[3 * i], from[3 * i + 1], from[3 * i + 2]};
  };
  for_sums(out.samples, "samples", take);
  for_sums(out.paths, "paths", take);
  const auto bytes = [&](const char* tensor, int64_t count) {
    const std::span<const uint8_t> from = file.values<uint8_t>(tensor, {count});
    return std::vector<uint8_t>(from.begin(), from.end());
  };
  out.dark = bytes("dark", rows);
  out.rate = bytes("rate", rows);
  out.back = bytes("back", static_cast<int64_t>(charts));
  const std::span<const int64_t> counts = file.values<int64_t>("counts", {5});
  out.two_sided = counts[0];
  for (size_t h = 0; h < 2; ++h) {
    out.samples.passes[h] = static_cast<int>(counts[1 + h]);
    out.paths.passes[h] = static_cast<int>(counts[3 + h]);
  }
  return out;
}

bake::Shard parse_shard(const std::string& text) {
  bake::Shard out;
  const char* const end = text.data() + text.size();
  const auto [slash, first] = std::from_chars(text.data(), end, out.number);
  bool good = first == std::errc{} && slash != end && *slash == '/';
  if (good) {
    const auto [rest, second] = std::from_chars(slash + 1, end, out.count);
    good = second == std::errc{} && rest == end;
  }
  LTE_CHECK(good && out.number >= 1 && out.number <= out.count && out.count <= kMaxShards,
            "--shard: expected I/N with I from 1 to N, as 2/4, got ", text);
  --out.number;
  return out;
}

}  // namespace lte::infer
