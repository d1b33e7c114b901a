// The answers of path tracer and network to fixed questions in a scene, and how long they take.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "experiments/stability/stress_scene.h"
#include "lte/embed/point_light.h"
#include "lte/runtime/network.h"
#include "lte/runtime/points.h"

namespace lte::experiments {

/// Seconds of one piece of work.
struct WorkTime {
  double wall = 0, processor = 0;  ///< processor: user and system, of all threads
};

WorkTime time_work(const std::function<void()>& work);

/// Surface points of the room in metres, and their paths.
struct StressQuestions {
  std::vector<Vec3> position, normal;
  std::vector<Rgb> albedo;
  int paths = 256;
  int64_t scene_points = 0;  ///< 0: as in the model's training
};

StressQuestions ask_stress_room(int64_t points, int paths, int64_t scene_points);

struct StressAnswers {
  std::vector<Rgb> paths;    ///< irradiance of all depths, path-traced
  std::vector<Rgb> network;  ///< what the network answers
  WorkTime bvh, paths_time, network_time;
  int64_t triangles = 0;
};

struct StressVariation {
  uint64_t seed = 0;  ///< of paths, scene points and their light
  /// Changes the scene points once they are lit; empty: leaves them.
  std::function<void(embed::LitSamples*)> edit = {};
  bool reverse_queries = false;  ///< ask the network from the last to the first
  bool paths = true, network = true;
};

StressAnswers answer(const StressRoom& room, const StressQuestions& questions,
                     const runtime::Network& network, const StressVariation& variation = {});

}  // namespace lte::experiments
