#include "datagen/dataset/manifest.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <sstream>
#include <vector>

#include <nlohmann/json.hpp>
#include <unistd.h>

#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/base/parallel.h"
#include "lte/base/process_memory.h"
#include "lte/base/version.h"

namespace lte::datagen {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::string file_name(const Shard& shard) {
  return concat("shard_", shard.index, "_of_", shard.count, ".jsonl");
}

std::vector<fs::path> manifests_in(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (entry.path().extension() == ".jsonl") found.push_back(entry.path());
  std::sort(found.begin(), found.end());
  return found;
}

std::string host_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

/// The time as 2026-11-21T13:38:22Z.
std::string utc_time() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text.data();
}

Json to_json(const SceneRecord& record) {
  Json json{{"type", "scene"},       {"name", record.name},
            {"index", record.index}, {"seed", record.seed},
            {"split", record.split}, {"status", record.error.empty() ? "baked" : "failed"},
            {"time", utc_time()},    {"seconds", record.seconds}};
  if (!record.source.empty()) json["source"] = record.source;
  if (!record.error.empty()) {
    json["error"] = record.error;
    return json;
  }
  json["generate_seconds"] = record.generate_s;
  json["bake_seconds"] = record.bake_s;
  json["rays"] = record.rays;
  json["rays_per_second"] =
      record.bake_s > 0 ? static_cast<double>(record.rays) / record.bake_s : 0.0;
  json["triangles"] = record.triangles;
  json["bytes"] = record.bytes;
  json["rss_mb"] = current_rss_mb();
  return json;
}

/// @return  false for a line that is not the record of a scene
bool parse_record(const std::string& line, SceneRecord* record) {
  const Json json = Json::parse(line, nullptr, false);
  if (!json.is_object() || json.value("type", "") != "scene") return false;
  try {
    record->index = json.at("index").get<int64_t>();
    record->name = json.at("name").get<std::string>();
    record->split = json.at("split").get<std::string>();
    record->seed = json.at("seed").get<uint64_t>();
    record->seconds = json.at("seconds").get<double>();
    record->source = json.value("source", "");
    record->error = json.value("error", "");
    if (!record->error.empty()) return true;
    record->generate_s = json.at("generate_seconds").get<double>();
    record->bake_s = json.at("bake_seconds").get<double>();
    record->rays = json.at("rays").get<int64_t>();
    record->triangles = json.at("triangles").get<int64_t>();
    record->bytes = json.at("bytes").get<int64_t>();
  } catch (const nlohmann::json::exception&) {
    return false;
  }
  return true;
}

}  // namespace

fs::path manifest_folder(const fs::path& out) { return out / "manifest"; }

void check_shard(const Shard& shard) {
  LTE_CHECK(shard.count >= 1 && shard.index >= 0 && shard.index < shard.count,
            "--shard: expected I/N with 0 <= I < N, got ", shard.index, "/", shard.count);
}

SceneRecords read_manifests(const fs::path& out) {
  SceneRecords all;
  for (const fs::path& path : manifests_in(manifest_folder(out))) {
    SceneRecords own;
    std::istringstream lines(read_file(path));
    SceneRecord record;
    for (std::string line; std::getline(lines, line); record = {})
      if (parse_record(line, &record)) own[record.index] = record;
    for (const auto& [index, found] : own) {
      const auto [at, inserted] = all.emplace(index, found);
      if (!inserted && found.error.empty()) at->second = found;
    }
  }
  return all;
}

Manifest::Manifest(const fs::path& out, const Shard& shard)
    : folder_(manifest_folder(out)),
      path_((make_directory(folder_), folder_ / file_name(shard))),
      shard_(shard),
      file_(path_) {
  LTE_CHECK(!file_.busy(), path_.string(), ": another process is at work on shard ", shard.index,
            "/", shard.count, "; wait for it, or stop it");
  refuse_other_cuts();
  const std::string there = read_file(path_);
  if (!there.empty() && there.back() != '\n') append("");  // a kill cut the last line short
}

/// Throws if a shard of another number of shards is in work: two such shards can share a scene,
/// which shards of one number never do.
void Manifest::refuse_other_cuts() const {
  const std::string own_cut = concat("_of_", shard_.count, ".jsonl");
  for (const fs::path& path : manifests_in(folder_)) {
    if (path.string().ends_with(own_cut)) continue;
    LTE_CHECK(
        !LockedFile(path).busy(), path.string(),
        ": another process is at work on this shard of another number of shards; wait for it, "
        "or stop it");
  }
}

void Manifest::append(const std::string& line) { file_.append(line + "\n"); }

void Manifest::begin(uint64_t seed, const std::string& config) {
  append(Json{{"type", "run"},
              {"tool", version()},
              {"time", utc_time()},
              {"host", host_name()},
              {"pid", ::getpid()},
              {"threads", num_threads()},
              {"shard", {shard_.index, shard_.count}},
              {"seed", seed},
              {"config", config}}
             .dump());
}

void Manifest::add(const SceneRecord& record) { append(to_json(record).dump()); }

void Manifest::end(int64_t baked, int64_t kept, int64_t failed, double seconds) {
  append(Json{{"type", "end"},
              {"time", utc_time()},
              {"baked", baked},
              {"kept", kept},
              {"failed", failed},
              {"seconds", seconds},
              {"peak_rss_mb", peak_rss_mb()}}
             .dump());
}

}  // namespace lte::datagen
