// Generated scenes, data sets of them, and the arrays of a scene's sample.
#include <cstring>

#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include "datagen/dataset/generate.h"
#include "lte/base/safetensors.h"
#include "lte/data/scene_sample.h"

#include "python/src/module.h"

namespace lte::python {
namespace {

std::unique_ptr<Scene> generate(const std::string& generator, uint64_t seed) {
  datagen::DatagenConfig config;
  for (const auto kind : {datagen::GeneratorKind::Boxes, datagen::GeneratorKind::Homes,
                          datagen::GeneratorKind::Wild}) {
    if (generator == datagen::generator_name(kind)) config.generator = kind;
  }
  return interruptible(
      [&] { return std::make_unique<Scene>(datagen::generate_scene(config, seed, generator)); });
}

nb::typed<nb::dict, nb::str, int> generate_dataset(const std::string& config_path,
                                                   const std::string& out,
                                                   const std::vector<std::string>& overrides,
                                                   bool resume) {
  const datagen::GenerateResult result = interruptible([&] {
    datagen::GenerateOptions options;
    options.out = out;
    options.resume = resume;
    return datagen::generate_dataset(datagen::load_datagen_config(config_path, overrides), options);
  });
  LTE_CHECK(result.failed == 0, out, ": ", result.failed, " scenes failed, the first of them ",
            result.first_error, "; resume=True tries them again");
  nb::dict counts;
  counts["baked"] = result.baked;
  counts["kept"] = result.kept;
  counts["planned"] = result.planned;
  return counts;
}

std::unique_ptr<Scene> make_scene(const std::string& config_path,
                                  const std::vector<std::string>& overrides, int64_t index) {
  return interruptible([&] {
    return std::make_unique<Scene>(
        datagen::make_scene(datagen::load_datagen_config(config_path, overrides), index));
  });
}

/// An array that owns what `rows` has.
template <typename Rows>
nb::ndarray<nb::numpy> array_with(Rows rows, const std::vector<int64_t>& shape, DType dtype) {
  const auto code = dtype == DType::U8                           ? nb::dlpack::dtype_code::UInt
                    : dtype == DType::I32 || dtype == DType::I64 ? nb::dlpack::dtype_code::Int
                                                                 : nb::dlpack::dtype_code::Float;
  const std::vector<size_t> sizes(shape.begin(), shape.end());
  auto* kept = new Rows(std::move(rows));
  const nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<Rows*>(p); });
  return {
      kept->data(), sizes.size(),
      sizes.data(), owner,
      nullptr,      {static_cast<uint8_t>(code), static_cast<uint8_t>(8 * dtype_size(dtype)), 1}};
}

/// The tensors of a sample file, each an array of its own.
Arrays read_sample(const std::string& path) {
  const SafetensorsFile file = interruptible([&] {
    SafetensorsFile opened{path};
    opened.verify();
    return opened;
  });
  nb::dict out;
  for (const auto& [name, tensor] : file.tensors()) {
    LTE_CHECK(tensor.dtype != DType::BF16, path, ": ", name, " is of BF16, which NumPy has not");
    out[name.c_str()] =
        array_with(std::vector<std::byte>(tensor.data, tensor.data + tensor.size_bytes()),
                   tensor.shape, tensor.dtype);
  }
  return out;
}

/// Bakes a scene as that of this number in a data set: what its file would have.
Arrays bake_sample(const Scene& self, const std::string& config_path,
                   const std::vector<std::string>& overrides, int64_t index) {
  data::SceneSample sample = interruptible([&] {
    const datagen::DatagenConfig config = datagen::load_datagen_config(config_path, overrides);
    return datagen::bake_scene(self.scene(), datagen::bake_options(config, index, self.scene()),
                               false);
  });
  nb::dict out;
  data::for_each_tensor(sample, [&](const data::TensorRule& rule, auto& values) {
    using Value = typename std::remove_reference_t<decltype(values)>::value_type;
    if (rule.optional() && values.empty()) return;
    out[rule.name.c_str()] = array_with(std::move(values), data::file_shape<Value>(rule),
                                        dtype_of<data::ScalarOf<Value>>());
  });
  return out;
}

}  // namespace

void bind_data(nb::module_& m) {
  m.def("generate_scene", &generate);
  m.def("generate_dataset", &generate_dataset);
  m.def("make_scene", &make_scene);
  m.def("bake_sample", &bake_sample);
  m.def("read_sample", &read_sample);
}

}  // namespace lte::python
