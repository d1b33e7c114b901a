#include "lte/pathtrace/reach/light_finder.h"

#include <algorithm>
#include <array>
#include <memory>

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/base/random.h"
#include "lte/pathtrace/transport/transport_impl.h"

namespace lte::pathtrace {
namespace {

constexpr int kVerticesPerDepth = 4;  // that are kept of a dark place's paths
constexpr int kNoRoulette = 1 << 20;
constexpr int64_t kBlocksOfTask = 4;

/// The places of one block of paths, as many paths each, one place after another.
struct PlacesOfBlock : LightSink {
  void add(int, std::span<const Contribution> contributions) override {
    for (const Contribution& c : contributions) {
      if (max_component(c.value) > 0 && std::ranges::count(*without, c.light_group) == 0)
        at(c.path).lit = true;
    }
  }
  Place& at(int32_t path) { return *places[static_cast<size_t>(path / paths)]; }

  int paths = 0;
  const std::vector<int>* without = nullptr;  ///< ReachOptions::without
  std::array<Place*, kBlock> places;
};

/// Observes where paths go on from, keeps some of these vertices, and ends the paths of places that
/// have found light.
struct VertexRecorder {
  bool wanted(int32_t path) const { return !block->at(path).lit; }
  void nearest(int depth, const PathBlock& rays) {
    const int most = depth == 1 ? 1 : kVerticesPerDepth;
    const Place* last = nullptr;  // lanes are in the order of their paths
    int kept = 0;
    for (int lane = 0; lane < rays.size; ++lane) {
      Place& place = block->at(rays.path[lane]);
      if (&place != last) kept = 0;
      last = &place;
      place.bounds.extend(rays.origin.at(lane));
      if (kept++ < most) place.vertices.push_back({rays.origin.at(lane), rays.normal.at(lane)});
    }
  }
  void shadow(const ShadowBlock& rays) {
    for (int lane = 0; lane < rays.size; ++lane)
      block->at(rays.path[lane]).bounds.extend(rays.origin.at(lane));
  }

  PlacesOfBlock* block = nullptr;
};

/// Traces blocks of paths; one for each task, as it is large.
class BlockTracer {
 public:
  BlockTracer(const Bvh& bvh, const Lights& lights, const ReachOptions& options, int paths)
      : seed_(hash_combine(options.seed, static_cast<uint64_t>(paths))),
        transport_(bvh, lights, options.max_depth, kNoRoulette, block_, VertexRecorder{&block_}),
        sampler_(Sampling::Sobol, paths) {
    block_.paths = paths;
    block_.without = &options.without;
  }

  void trace(std::span<const uint32_t> numbers, std::vector<Place>* places) {
    sampler_.clear();
    PathBlock& start = transport_.start();
    int lane = 0;
    for (size_t k = 0; k < numbers.size(); ++k) {
      Place& place = (*places)[numbers[k]];
      place.vertices.clear();
      block_.places[k] = &place;
      sampler_.start_stream(seed_, place.point);
      sampler_.start_set();
      for (int p = 0; p < block_.paths; ++p, ++lane) {
        sampler_.add_path();
        start.origin.put(lane, place.origin);
        start.normal.put(lane, place.side);
      }
    }
    transport_.trace_from_surfaces(sampler_);
    for (const uint32_t number : numbers) {
      Place& place = (*places)[number];
      if (place.lit) {
        place.vertices = {};
      } else {
        place.paths += block_.paths;
      }
    }
  }

 private:
  const uint64_t seed_;
  PlacesOfBlock block_;
  BasicTransport<VertexRecorder> transport_;
  PathSampler sampler_;
};

}  // namespace

void find_light(const Bvh& bvh, const Lights& lights, const ReachOptions& options, int paths,
                std::span<const uint32_t> numbers, const std::function<void()>& check,
                std::vector<Place>* places) {
  LTE_CHECK(paths >= 1 && paths <= kBlock, "paths of a place: expected 1 to ", kBlock, ", got ",
            paths);
  const int64_t of_block = kBlock / paths;
  parallel_for(static_cast<int64_t>(numbers.size()), kBlocksOfTask * of_block,
               [&](int64_t begin, int64_t end) {
                 if (check) check();
                 const auto tracer = std::make_unique<BlockTracer>(bvh, lights, options, paths);
                 for (int64_t first = begin; first < end; first += of_block) {
                   const int64_t count = std::min(of_block, end - first);
                   tracer->trace(
                       numbers.subspan(static_cast<size_t>(first), static_cast<size_t>(count)),
                       places);
                 }
               });
}

}  // namespace lte::pathtrace
