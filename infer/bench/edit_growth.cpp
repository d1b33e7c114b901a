#include "infer/bench/edit_growth.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "lte/base/check.h"
#include "lte/base/log.h"
#include "lte/base/process_memory.h"
#include "lte/base/random.h"
#include "lte/base/timer.h"

namespace lte::infer {
namespace {

/// Things that random edits have added and not yet taken away, at a time.
constexpr size_t kMostAdded = 4;
/// While a hand drags, light follows after some edits, and all of it, with a picture, now and then.
constexpr int kEditsALight = 4, kEditsAPicture = 40;
/// Places between the first edit and the last where resident memory is written down.
constexpr int kRows = 4;

class RandomEdits {
 public:
  explicit RandomEdits(Session* session) : session_(*session), rng_(3, 0) {
    const SessionState& state = *session_.state();
    for (const LuminaireInfo& light : state.luminaires()) lights_.push_back(light.id);
    for (const InstanceInfo& info : state.instances()) {
      if (info.light == scene::kNone) objects_.push_back(info);
    }
    // The walls are the largest instance, and stay.
    std::sort(objects_.begin(), objects_.end(), [](const InstanceInfo& a, const InstanceInfo& b) {
      return length(a.bounds.extent()) < length(b.bounds.extent());
    });
    if (objects_.size() > 1) objects_.pop_back();
    middle_ = state.bvh().bounds().center();
  }

  void make(int step) {
    constexpr Accuracy kKept = Accuracy::Kept;
    const InstanceInfo& object = any(objects_);
    Affine place = object.to_world;
    place.m[0][3] += 0.2f * uniform();
    switch (step % 7) {
      case 0:
        session_.apply(SetLight{any(lights_), 2.0 * uniform(), {}}, false, kKept);
        break;
      case 1:
        session_.apply(SetMaterial{object.material, {uniform(), uniform(), uniform()}}, false,
                       kKept);
        break;
      case 2:
        session_.apply(MoveInstance{object.id, place}, false, kKept);
        break;
      case 3:
        if (const auto gone = to_remove(&copies_)) {
          session_.apply(RemoveInstance{*gone}, false, kKept);
        } else {
          copies_.push_back(
              session_.apply(AddInstance{object.id, place}, false, kKept).added_instances.at(0));
        }
        break;
      case 4:
        if (const auto gone = to_remove(&lamps_)) {
          session_.apply(RemoveLight{*gone}, false, kKept);
        } else {
          scene::PunctualLight lamp;
          lamp.position = middle_;
          lamp.intensity = {uniform(), uniform(), uniform()};
          lamps_.push_back(session_.apply(AddLight{lamp}, false, kKept).added_lights.at(0));
        }
        break;
      default:
        session_.undo(kKept);
        session_.redo(kKept);
    }
  }

 private:
  float uniform() { return static_cast<float>(rng_.next_u64() >> 40) * 0x1p-24f; }
  template <typename T>
  const T& any(const std::vector<T>& list) {
    return list[static_cast<size_t>(uniform() * static_cast<float>(list.size()))];
  }
  static std::optional<int> to_remove(std::vector<int>* added) {
    if (added->size() < kMostAdded) return std::nullopt;
    const int id = added->back();
    added->pop_back();
    return id;
  }

  Session& session_;
  Rng rng_;
  std::vector<int> lights_, copies_, lamps_;
  std::vector<InstanceInfo> objects_;
  Vec3 middle_;
};

}  // namespace

BenchResult measure_growth(Session* session, const scene::Camera& camera,
                           const RenderSettings& settings, int edits) {
  RandomEdits random(session);
  const auto make = [&](int step) {
    random.make(step);
    if (step % kEditsALight == 0) session->refine(Accuracy::Draft);
    if (step % kEditsAPicture != 0) return;
    session->refine();
    session->state()->render(camera, settings);
  };
  BenchResult row{"random edits", edits, 0, 0, {}};
  const int warm = std::max(1, edits / 10);
  double before = current_rss_mb();
  row.figures["rss_at_0_mb"] = before;
  const Timer timer;
  for (int i = 1; i <= edits; ++i) {
    make(i);
    const double now = current_rss_mb();
    if (i == warm) before = row.figures["rss_after_a_tenth_mb"] = now;
    if (i % std::max(1, edits / kRows) == 0) {
      row.figures[concat("rss_at_", i, "_mb")] = now;
      log_info(i, " of ", edits, " random edits, ", std::lround(now), " MB resident");
    }
  }
  row.seconds_min = row.seconds_median = timer.seconds() / edits;
  const SessionMemory memory = session->memory();
  const double after = current_rss_mb();
  row.figures["peak_rss_mb"] = peak_rss_mb();
  row.figures["states"] = static_cast<double>(memory.states);
  row.figures["undo_mb"] = static_cast<double>(memory.undo_bytes) / (1 << 20);
  LTE_CHECK(after - before <= kMostGrowthMb && after <= kMostResidentMb, edits,
            " random edits: resident memory grew from ", before, " to ", after, " MB: expected ",
            kMostGrowthMb, " MB more at most, and ", kMostResidentMb, " in all");
  return row;
}

}  // namespace lte::infer
