#include "train/checkpoint/init_weights.h"

#include <algorithm>
#include <map>

#include <ATen/ops/isfinite.h>
#include <torch/types.h>

#include "lte/base/check.h"
#include "lte/base/log.h"
#include "lte/base/safetensors.h"
#include "lte/base/to_number.h"
#include "lte/nn/files/model_file.h"
#include "lte/nn/files/tensor_io.h"
#include "train/checkpoint/checkpoint.h"
#include "train/checkpoint/widen.h"
#include "train/config.h"

namespace lte::train {
namespace {

/// The file's float tensors by the names that the model gives them.
std::map<std::string, TensorView> weights_in(const SafetensorsFile& file) {
  const auto found = file.metadata().find("format");
  const std::string format = found == file.metadata().end() ? "" : found->second;
  LTE_CHECK(format == "lte-model" || format == "lte-checkpoint", file.path().string(),
            ": neither a model nor a checkpoint of lte_train (metadata \"format\" is ",
            found == file.metadata().end() ? "missing" : "\"" + format + "\"", ")");
  nn::check_format_version(file);
  if (format == "lte-model") return file.tensors();
  const std::string kWeights = "model.", kAverage = "average.";
  std::map<std::string, TensorView> weights;
  for (const auto& [name, tensor] : file.tensors()) {
    if (!name.starts_with(kWeights)) continue;
    const std::string own = name.substr(kWeights.size());
    weights[own] = file.contains(kAverage + own) ? file.at(kAverage + own) : tensor;
  }
  return weights;
}

/// Names in a list that stays readable however long it is.
class NameList {
 public:
  explicit NameList(const char* what) : what_(what) {}
  void add(const std::string& name) {
    if (++count_ <= kShown) text_ += (count_ == 1 ? "" : ", ") + name;
  }
  /// "missing (2): a, b"; empty if there is none.
  std::string text() const {
    if (count_ == 0) return "";
    return concat(what_, " (", count_, "): ", text_, count_ > kShown ? ", ..." : "");
  }

 private:
  static constexpr size_t kShown = 12;
  const char* what_;
  std::string text_;
  size_t count_ = 0;
};

bool starts_with_any(const std::string& name, const std::vector<std::string>& prefixes) {
  return std::any_of(prefixes.begin(), prefixes.end(),
                     [&](const std::string& prefix) { return name.starts_with(prefix); });
}

/// @throws lte::Error for a prefix that nothing begins with: a slip that would go unseen
void check_prefixes(const std::string& file, const std::vector<std::string>& except,
                    const nn::LightTransportModel& model,
                    const std::map<std::string, TensorView>& weights) {
  const auto parameters = model->named_parameters();
  for (const std::string& prefix : except) {
    const auto matches = [&](const auto& item) { return item.first.starts_with(prefix); };
    const bool in_model = std::any_of(parameters.begin(), parameters.end(), [&](const auto& item) {
      return item.key().starts_with(prefix);
    });
    LTE_CHECK(!prefix.empty() && (in_model || std::any_of(weights.begin(), weights.end(), matches)),
              "train.init_except: no parameter of the model or of ", file, " begins with \"",
              prefix, "\"; a name is, for example, ", parameters.begin()->key());
  }
}

/// What the metadata of a model file or a checkpoint say of the light that it was trained with.
LightEstimates light_of(const SafetensorsFile& file) {
  if (file.metadata().contains("progress"))
    return read_checkpoint_header(file.path()).progress.light;
  LightEstimates light;
  const auto read = [&](const char* key, int* value) {
    const auto found = file.metadata().find(key);
    if (found == file.metadata().end()) return;
    const auto number = to_number<int>(found->second);
    LTE_CHECK(number, file.path().string(), ": metadata ", key, " is \"", found->second,
              "\", expected a number");
    *value = *number;
  };
  read("light_paths", &light.paths);
  read("light_depth", &light.depth);
  return light;
}

nn::ModelConfig config_in(const SafetensorsFile& file) {
  return nn::ModelConfig::read(
      Config::parse(file.metadata("model_config"), file.path().string() + ": model_config"));
}

/// The first layers of F and of the query's MLP.
constexpr const char* kPointWeight = "nne.point.hidden.weight";
constexpr const char* kQueryWeight = "decoder.point.hidden.weight";

/// The last columns of a layer, for input that the file's model does not have: gloss, and before it
/// the errors of light estimates.
int64_t fresh_columns(const nn::ModelConfig& model, const nn::ModelConfig& file,
                      const std::string& parameter) {
  const bool gloss = model.predicts_radiance() && !file.predicts_radiance();
  const bool errors =
      model.reads_estimates() && !file.reads_estimates() && !file.predicts_radiance();
  if (parameter == kPointWeight) return (gloss ? nn::kGlossColumns : 0) + (errors ? 2 : 0);
  return parameter == kQueryWeight && errors ? 1 : 0;
}

void check_config(const SafetensorsFile& file, const nn::ModelConfig& before,
                  const nn::ModelConfig& model, const LightEstimates& light) {
  const std::string name = file.path().string();
  LTE_CHECK(before.scale == model.scale, name, ": its weights are for a scale of ", before.scale,
            " m, but the data set's is ", model.scale,
            " m: positions in network space would not mean the same");
  // Weights that never saw such light are bound to nothing.
  if (before.reads_estimates()) check_light_estimates(name, model, light_of(file), light);
  const std::vector<std::string> differences = model_differences(model, before);
  std::string text;
  for (const std::string& difference : differences) {
    if (difference.starts_with("channels ") && widening(model, before) > 1) continue;
    text += (text.empty() ? "" : ", ") + difference;
  }
  if (!text.empty()) log_warning(name, ": trained with another model.", text);
}

}  // namespace

void init_weights(const std::filesystem::path& path, const std::vector<std::string>& except,
                  const nn::LightTransportModel& model, const LightEstimates& light) {
  const torch::NoGradGuard no_grad;
  const SafetensorsFile file(path);
  file.verify();
  const std::string name = path.string();
  const std::map<std::string, TensorView> weights = weights_in(file);
  const nn::ModelConfig before = config_in(file);
  const int64_t factor = widening(model->config(), before);
  const auto known_shape = [&](const std::string& parameter, const at::Tensor& value) {
    std::vector<int64_t> shape = value.sizes().vec();
    if (!shape.empty()) shape.back() -= fresh_columns(model->config(), before, parameter);
    return shape;
  };
  const auto fits = [&](const TensorView& view, const std::vector<int64_t>& shape) {
    return (view.dtype == DType::F32 || view.dtype == DType::BF16) &&
           std::equal(shape.begin(), shape.end(), view.shape.begin(), view.shape.end(),
                      [&](int64_t here, int64_t there) {
                        return here == there || here == factor * there;
                      });
  };
  check_prefixes(name, except, model, weights);
  NameList missing("missing"), extra("superfluous"), shapes("of another shape");
  const auto parameters = model->named_parameters();
  for (const auto& item : parameters) {
    if (starts_with_any(item.key(), except)) continue;
    const auto found = weights.find(item.key());
    if (found == weights.end()) {
      missing.add(item.key());
    } else if (!fits(found->second, known_shape(item.key(), item.value()))) {
      shapes.add(concat(item.key(), " ", at::IntArrayRef(found->second.shape), " for ",
                        item.value().sizes()));
    }
  }
  for (const auto& [key, view] : weights) {
    if (!starts_with_any(key, except) && !parameters.contains(key)) extra.add(key);
  }
  std::string faults;
  for (const NameList* list : {&missing, &extra, &shapes}) {
    if (!list->text().empty()) faults += (faults.empty() ? "" : "; ") + list->text();
  }
  LTE_CHECK(faults.empty(), name, ": its weights do not fit the model: ", faults,
            "; --init-except PREFIX leaves out parameters by name");
  check_config(file, before, model->config(), light);
  if (factor > 1)
    log_info(name, ": ", before.channels, " channels are made ", model->config().channels,
             "; the network begins with the same answers");
  for (const auto& item : parameters) {
    if (starts_with_any(item.key(), except)) continue;
    const TensorView& view = weights.at(item.key());
    at::Tensor values = nn::float_values(view);
    LTE_CHECK(at::isfinite(values).all().item<bool>(), name, ": tensor ", item.key(),
              " holds values that are not finite");
    if (factor > 1)
      values = widened(item.key(), values, known_shape(item.key(), item.value()), factor);
    const int64_t fresh = fresh_columns(model->config(), before, item.key());
    if (fresh == 0) {
      item.value().copy_(values);
    } else {  // so that the network answers as before until it has learnt of them
      const int64_t known = values.size(1);
      item.value().narrow(1, 0, known).copy_(values);
      item.value().narrow(1, known, fresh).zero_();
    }
  }
}

}  // namespace lte::train
