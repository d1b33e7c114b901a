// Shared by the files of this module: the scene as Python holds it, arrays, errors of arguments,
// and work that Ctrl-C ends.
#pragma once

#include <cstring>
#include <initializer_list>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include "infer/renderer/renderer.h"
#include "lte/base/check.h"
#include "lte/base/interruption.h"
#include "lte/base/timer.h"
#include "lte/runtime/network.h"
#include "lte/scene/point_table.h"

namespace lte::python {

namespace nb = nanobind;

/// [N, 3], read in place: three adjacent numbers a row, rows any distance apart.
using Triples = nb::ndarray<const float, nb::shape<-1, 3>, nb::device::cpu>;
using Array = nb::ndarray<nb::numpy, float>;
/// By name.
using Arrays = nb::typed<nb::dict, nb::str, nb::any>;
using FloatArrays = nb::typed<nb::dict, nb::str, Array>;

inline Vec3 row_of(const Triples& rows, size_t i) {
  const float* row = rows.data() + static_cast<int64_t>(i) * rows.stride(0);
  return {row[0], row[1], row[2]};
}

inline std::vector<Vec3> vector_of(const Triples& rows) {
  std::vector<Vec3> out;
  out.reserve(rows.shape(0));
  for (size_t i = 0; i < rows.shape(0); ++i) out.push_back(row_of(rows, i));
  return out;
}

/// Unit vectors.
inline std::vector<Vec3> directions_of(const Triples& rows) {
  std::vector<Vec3> out = vector_of(rows);
  for (Vec3& row : out) row = normalize(row);
  return out;
}

/// An array that owns the numbers.
inline Array array_of(std::vector<float> numbers, std::initializer_list<size_t> shape) {
  auto* kept = new std::vector<float>(std::move(numbers));
  const nb::capsule owner(kept,
                          [](void* p) noexcept { delete static_cast<std::vector<float>*>(p); });
  return Array(kept->data(), shape, owner);
}

/// [N, 3].
inline Array array_of(std::span<const Vec3> rows) {
  const auto* first = reinterpret_cast<const float*>(rows.data());
  return array_of({first, first + 3 * rows.size()}, {rows.size(), 3});
}

/// Runs a check of an argument: what it has to say is a ValueError, not an Error of a file.
template <typename Check>
auto argument(const Check& check) {
  try {
    return check();
  } catch (const Error& error) {
    throw nb::value_error(error.what());
  }
}

/// A network, and what tells it from others.
struct Model {
  Model(const std::string& file, runtime::Precision precision);

  std::string path;
  runtime::Network network;
  std::string fingerprint;  ///< with its precision
};

/// What a cache of a scene is made of.
struct CacheKey {
  int64_t records = 0;
  int paths = 0, depth = 0;
  uint64_t seed = 0;
  std::string network;  ///< whose light it has; traced light: none
  std::vector<int> culled_lights;

  bool operator==(const CacheKey&) const = default;
};

/// A scene with what all questions about it share. Nothing in it changes but the irradiance cache.
class Scene {
 public:
  explicit Scene(scene::Scene scene);
  /// The same surfaces, whose lights are dimmed. Either may be destroyed first.
  Scene(const Scene& bright, std::span<const float> gains);

  const scene::Scene& scene() const { return *scene_; }
  const std::shared_ptr<const pathtrace::Bvh>& bvh() const { return bvh_; }
  const std::shared_ptr<const pathtrace::Lights>& lights() const { return lights_; }
  /// One a call: several threads may ask at the same time.
  infer::Renderer renderer() const { return {bvh_, lights_, denoiser_}; }
  /// Gives a renderer the cache that pictures read; that of the last call where it is the same.
  /// @param model     whose light it has, with what is embedded; null: paths trace it
  void provide_cache(const render::CacheSettings& settings, const Model* model,
                     const embed::EmbedSettings& embedding, infer::Renderer* renderer);

 private:
  std::unique_ptr<const scene::Scene> scene_;
  std::shared_ptr<const pathtrace::Bvh> bvh_;
  std::shared_ptr<const pathtrace::Lights> lights_;
  std::shared_ptr<render::SharedDenoiser> denoiser_;
  std::mutex mutex_;  ///< for what follows
  CacheKey cached_;
  std::shared_ptr<const gi::IrradianceCache> cache_;
};

/// Points given with too few digits lie on their surfaces, as lte_probe has it.
scene::PointTable table_of(const Scene& scene, const Triples& points, const Triples& normals);

/// Has the network compute by the threads of set_threads(). Before any work of it, in each thread.
void apply_threads();

/// Whether Python handles signals in this thread.
inline bool in_main_thread() {
  const nb::module_ threading = nb::module_::import_("threading");
  return threading.attr("get_ident")().equal(threading.attr("main_thread")().attr("ident"));
}

/// Runs `work` without the interpreter's lock. Ctrl-C ends it, and is then an exception as
/// elsewhere in Python.
template <typename Work>
auto interruptible(const Work& work) {
  constexpr double kLookEach = 0.05;  // seconds
  Timer since;
  const auto wanted = [&since] {
    if (since.seconds() < kLookEach) return false;
    since.restart();
    const nb::gil_scoped_acquire lock;
    return PyErr_CheckSignals() != 0;
  };
  std::optional<Interruption> interruption;
  if (in_main_thread()) interruption.emplace(wanted);
  try {
    const nb::gil_scoped_release unlocked;
    return work();
  } catch (const Interrupted&) {
    throw nb::python_error();  // that which the signal's handler has raised
  }
}

void bind_scene(nb::module_& m);
void bind_data(nb::module_& m);
void bind_picture(nb::module_& m);
void bind_light(nb::module_& m);
void bind_network(nb::module_& m);
void bind_bake(nb::module_& m);

}  // namespace lte::python
