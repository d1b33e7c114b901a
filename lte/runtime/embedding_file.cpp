#include "lte/runtime/embedding_file.h"

#include <string>

#include "lte/base/check.h"
#include "lte/base/safetensors.h"
#include "lte/base/to_number.h"
#include "lte/base/version.h"
#include "lte/nn/cost.h"
#include "lte/nn/files/tensor_io.h"
#include "lte/nn/model.h"
#include "lte/runtime/torch_errors.h"
#include "lte/runtime/torch_parts.h"
#include "lte/tensor/functions.h"

namespace lte::runtime {
namespace {

constexpr const char* kFormat = "lte-embedding";
constexpr int64_t kFormatVersion = 2;
constexpr const char* kKeyPrefix = "key ";

at::Tensor one_number(double value) { return at::tensor({value}, at::kDouble); }

int64_t parse_count(const std::string& file, const std::string& key, const std::string& text) {
  const auto value = to_number<int64_t>(text);
  LTE_CHECK(value && *value >= 1, file, ": ", key, " \"", text.substr(0, 40),
            "\" is not a positive number");
  return *value;
}

/// The file is one of ours, whole, and of a version that is understood.
void check_format(const SafetensorsFile& file) {
  const std::string name = file.path().string();
  const auto& metadata = file.metadata();
  const auto format = metadata.find("format");
  LTE_CHECK(format != metadata.end() && format->second == kFormat, name,
            ": not an embedding (its metadata has no format \"", kFormat, "\")");
  const int64_t version = parse_count(name, "format_version", file.metadata("format_version"));
  LTE_CHECK(version <= kFormatVersion, name, ": format version ", version,
            " is newer than this program's ", kFormatVersion, "; update lte");
  LTE_CHECK(version == kFormatVersion, name, ": format version ", version,
            " is older than this program's ", kFormatVersion, "; save it again");
  LTE_CHECK(metadata.contains(kChecksumKey), name, ": has no checksum; save it again");
  file.verify();
}

void check_entry(const std::string& file, const std::string& what, const std::string& in_file,
                 const std::string& here) {
  LTE_CHECK(in_file == here, file, ": this embedding was made with another ", what, ": ",
            in_file.substr(0, 80), ", here it is ", here);
}

void check_key(const SafetensorsFile& file, const EmbeddingKey& key) {
  const std::string name = file.path().string();
  const std::string prefix = kKeyPrefix;
  for (const auto& [what, here] : key) {
    const auto found = file.metadata().find(prefix + what);
    LTE_CHECK(found != file.metadata().end(), name, ": this embedding does not say its ", what,
              ", here it is ", here);
    check_entry(name, what, found->second, here);
  }
  for (const auto& [entry, value] : file.metadata()) {
    if (!entry.starts_with(prefix)) continue;
    LTE_CHECK(key.contains(entry.substr(prefix.size())), name, ": this embedding was made with a ",
              entry.substr(prefix.size()), " of ", value.substr(0, 80), ", which nothing here has");
  }
}

/// The tensor, of this shape where −1 is any size, without a value that is not finite.
at::Tensor read(const SafetensorsFile& file, const std::string& tensor, at::ScalarType type,
                std::vector<int64_t> shape) {
  const TensorView& view = file.at(tensor);
  for (size_t i = 0; i < shape.size(); ++i)
    if (shape[i] < 0) shape[i] = i < view.shape.size() ? view.shape[i] : 0;
  const at::Tensor out = at::empty(shape, at::TensorOptions(type));
  nn::read_tensor(file, tensor, out);
  LTE_CHECK(at::isfinite(out).all().item<bool>(), file.path().string(), ": tensor ", tensor,
            " has a value that is not finite");
  return out;
}

double read_number(const SafetensorsFile& file, const std::string& tensor) {
  return read(file, tensor, at::kDouble, {1}).item<double>();
}

nn::Embedding read_parts(const SafetensorsFile& file, const nn::ModelConfig& config,
                         int64_t width) {
  nn::Embedding parts;
  parts.position = read(file, "position", at::kFloat, {-1, 3});
  const int64_t m = parts.position.size(0);
  LTE_CHECK(m >= 1, file.path().string(), ": has no latents");
  parts.features = read(file, "features", at::kFloat, {m, width});
  if (config.reads_normals()) parts.normal = read(file, "normal", at::kFloat, {m, 3});
  parts.origin = read(file, "origin", at::kFloat, {3});
  parts.scale = read_number(file, "scale");
  parts.spacing = read_number(file, "spacing");  // 0 where points coincide
  LTE_CHECK(parts.scale > 0 && parts.spacing >= 0, file.path().string(),
            ": scale must be more than 0 and spacing not negative, got ", parts.scale, " and ",
            parts.spacing);
  parts.emission_scale = read(file, "emission_scale", at::kDouble, {3});
  if (config.predicts_radiance())
    parts.surfels = nn::Surfels(read(file, "surfels", at::kFloat, {-1, nn::Surfels::kColumns}));
  if (!config.reads_light()) return parts;
  parts.prior.position = read(file, "prior.position", at::kFloat, {-1, 3});
  const int64_t S = parts.prior.position.size(0);
  parts.prior.normal = read(file, "prior.normal", at::kFloat, {S, 6});
  parts.prior.light = read(file, "prior.light", at::kFloat, {S, 12});
  if (config.reads_estimates()) parts.prior.error = read(file, "prior.error", at::kFloat, {S, 2});
  parts.prior.floor = read(file, "prior.floor", at::kFloat, {3});
  return parts;
}

nn::Embedding on_device(nn::Embedding parts, c10::Device device) {
  for (at::Tensor* t :
       {&parts.position, &parts.normal, &parts.features, &parts.origin, &parts.prior.position,
        &parts.prior.normal, &parts.prior.light, &parts.prior.error, &parts.prior.floor}) {
    if (t->defined()) *t = t->to(device);
  }
  if (parts.surfels.defined() && !device.is_cpu()) parts.surfels = parts.surfels.to(device);
  return parts;
}

}  // namespace

void save_embedding(const std::filesystem::path& path, const SceneEmbedding& embedding,
                    const EmbeddingKey& key) {
  const Network& network = embedding.network();
  const nn::Embedding parts = TorchParts::embedding(embedding);
  std::map<std::string, at::Tensor> tensors = {{"position", parts.position},
                                               {"features", parts.features},
                                               {"origin", parts.origin},
                                               {"scale", one_number(parts.scale)},
                                               {"spacing", one_number(parts.spacing)},
                                               {"emission_scale", parts.emission_scale}};
  if (parts.normal.defined()) tensors["normal"] = parts.normal;
  if (parts.surfels.defined()) tensors["surfels"] = parts.surfels.table();
  if (parts.prior.defined()) {
    tensors["prior.position"] = parts.prior.position;
    tensors["prior.normal"] = parts.prior.normal;
    tensors["prior.light"] = parts.prior.light;
    if (parts.prior.error.defined()) tensors["prior.error"] = parts.prior.error;
    tensors["prior.floor"] = parts.prior.floor;
  }
  SafetensorsWriter writer;
  std::map<std::string, at::Tensor> storage;
  nn::add_tensors(tensors, &storage, &writer);
  writer.set_metadata("format", kFormat);
  writer.set_metadata("format_version", std::to_string(kFormatVersion));
  writer.set_metadata("lte_version", version());
  writer.set_metadata("model", network.fingerprint());
  writer.set_metadata("precision", enum_name(network.precision()));
  writer.set_metadata("scene_points", std::to_string(embedding.info().scene_points));
  for (const auto& [what, value] : key) writer.set_metadata(kKeyPrefix + what, value);
  writer.write(path);
}

SceneEmbedding load_embedding(const std::filesystem::path& path, const Network& network,
                              const EmbeddingKey& key, const MemoryLimit& memory) {
  const SafetensorsFile file(path);
  check_format(file);
  const std::string name = path.string();
  check_entry(name, "model", file.metadata("model"), network.fingerprint());
  check_entry(name, "precision", file.metadata("precision"), enum_name(network.precision()));
  check_key(file, key);
  const at::NoGradGuard no_grad;
  const int64_t scene_points = parse_count(name, "scene_points", file.metadata("scene_points"));
  const c10::Device device = torch_device(network.device());
  return own_errors([&] {
    const c10::DeviceGuard guard(device);
    nn::Embedding parts =
        on_device(read_parts(file, network.config(), nn::latent_width(network.config())), device);
    TorchParts::model(network)->make_tables(&parts);
    return TorchParts::from(network, parts, scene_points, memory);
  });
}

}  // namespace lte::runtime
