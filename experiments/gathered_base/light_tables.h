// Light at the records of an irradiance cache, by several ways of finding it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lte/gi/cache_records.h"
#include "lte/gi/irradiance_cache.h"
#include "lte/render/integrator.h"
#include "lte/runtime/embedding.h"

namespace lte::experiments {

struct LightTable {
  std::string name;
  gi::RecordLight light;
  double seconds = 0;  ///< of processors; what tables share is not among them
};

struct TableOptions {
  int64_t records = 4096;
  int paths = 16;           ///< a record: of a sweep and of `raw`
  int direct_paths = 16;    ///< a record: of its direct light
  int reference_paths = 0;  ///< a record: of `truth`, which is left out with 0
  int sweeps = 3;           ///< from darkness; from other light two at most
  int max_depth = 5;        ///< surface hits of light's path after a gathered point
  uint64_t seed = 0;
};

/// The records of one scene. Direct light is traced once, for all tables but `truth`.
class LightTables {
 public:
  LightTables(const render::TracedScene& scene, const TableOptions& options);

  /// - solved: the radiosity solution that the network starts from, interpolated
  /// - network: what the network answers
  /// - swept-K: K gathers over the records' own light, from darkness: light of K reflections
  /// - solved-swept-K, network-swept-K: the same from that light
  /// - raw, truth: path-traced
  /// @param embedding  of a network that solves light
  std::vector<LightTable> make(const runtime::SceneEmbedding& embedding) const;
  gi::IrradianceCache cache_of(const LightTable& table) const;

  int64_t size() const { return places_.size(); }
  double direct_seconds() const { return direct_seconds_; }

 private:
  LightTable table(const std::string& name, std::vector<Rgb> indirect, double seconds) const;
  LightTable swept(const LightTable& from, const std::string& name, int number) const;
  LightTable traced(const std::string& name, int paths) const;

  render::TracedScene scene_;
  TableOptions options_;
  gi::CacheRecords places_;
  std::vector<Rgb> direct_;
  double direct_seconds_ = 0;
};

}  // namespace lte::experiments
