#include "train/loop/preview.h"

#include <algorithm>
#include <cmath>

#include <ATen/ops/from_blob.h>
#include <torch/types.h>

#include "lte/base/file.h"
#include "lte/base/srgb.h"
#include "lte/base/text.h"
#include "lte/data/dataset.h"
#include "lte/data/scene_sample.h"
#include "lte/image/image.h"
#include "lte/image/png.h"

namespace lte::train {
namespace {

constexpr int kColumns = 3, kGap = 2;  // pictures in a sheet; pixels between them
constexpr double kWhiteShare = 0.99;
constexpr float kDifferenceGain = 4;

std::vector<Rgb> to_rgb(const at::Tensor& values) {
  const at::Tensor flat = values.to(at::kCPU, at::kFloat).contiguous();
  const auto* from = reinterpret_cast<const Rgb*>(flat.const_data_ptr<float>());
  return {from, from + flat.size(0)};
}

/// The values of the pixels whose mask is set.
template <typename T>
std::vector<T> masked(const std::vector<T>& values, const std::vector<uint8_t>& mask) {
  std::vector<T> out;
  for (size_t i = 0; i < mask.size(); ++i) {
    if (mask[i]) out.push_back(values[i]);
  }
  return out;
}

at::Tensor to_tensor(const std::vector<Vec3>& values) {
  static_assert(sizeof(Vec3) == 3 * sizeof(float));
  return at::from_blob(const_cast<Vec3*>(values.data()), {static_cast<int64_t>(values.size()), 3},
                       at::TensorOptions(at::kFloat))
      .clone();
}

/// Indirect irradiance of all light groups together at unit gain, at the pixels whose mask is set.
std::vector<Rgb> reference_of(const data::View& view, int64_t groups) {
  const size_t pixels = view.mask.size();
  std::vector<Rgb> out(pixels);
  for (size_t i = 0; i < static_cast<size_t>(groups) * pixels; ++i)
    out[i % pixels] += view.indirect[i];
  return masked(out, view.mask);
}

/// The factor that makes the 99th percentile of the luminances white.
float exposure_of(const std::vector<Rgb>& reference) {
  std::vector<float> values;
  for (const Rgb& value : reference) values.push_back(luminance(value));
  if (values.empty()) return 1;
  const auto rank =
      static_cast<std::ptrdiff_t>(kWhiteShare * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  const float white = values[static_cast<size_t>(rank)];
  return white > 0 ? 1 / white : 1;
}

/// Three pictures side by side, the background white.
class Sheet {
 public:
  Sheet(int width, int height)
      : display_(kColumns * width + (kColumns - 1) * kGap, height, 3), step_(width + kGap) {
    std::fill(display_.pixels.begin(), display_.pixels.end(), 1.0f);
  }

  void set(int column, int x, int y, const Rgb& linear) {
    display_.set_rgb(
        column * step_ + x, y,
        {linear_to_srgb(linear.x), linear_to_srgb(linear.y), linear_to_srgb(linear.z)});
  }

  PreviewPicture picture(const std::string& scene) const {
    return {scene, display_.width, display_.height, image::encode_png(display_)};
  }

 private:
  image::Image display_;
  int step_;
};

std::string step_folder(int64_t step) {
  return formatted("step_%09lld", static_cast<long long>(step));
}

}  // namespace

Previews::Previews(const TrainConfig& config, const std::vector<Example>& validation) {
  for (const Example& example : validation) {
    const data::SceneSample sample =
        data::read_scene_sample(data::scene_path(config.data.root, example.scene));
    if (sample.views.empty()) continue;
    const data::View& view = sample.views.front();
    const nn::QuerySet queries{to_tensor(masked(view.position, view.mask)),
                               to_tensor(masked(view.normal, view.mask)),
                               to_tensor(masked(view.albedo, view.mask))};
    if (queries.position.size(0) == 0) continue;
    views_.push_back({example.scene, view.width, view.height, view.mask, example.points, queries,
                      reference_of(view, sample.light_groups), example.seed});
  }
}

PreviewPicture Previews::draw(const ViewExample& view, nn::LightTransportModel& model,
                              at::Device device) const {
  Example example;
  example.points = view.points;
  example.queries = view.queries;
  example.target = view.queries.position;  // of the right shape; not looked at
  example = example.to(device);
  const std::vector<Rgb> predicted =
      to_rgb(model->decode(model->encode(example.points, view.seed), example.queries));
  const float exposure = exposure_of(view.reference);
  Sheet sheet(view.width, view.height);
  size_t next = 0;
  for (int y = 0; y < view.height; ++y) {
    for (int x = 0; x < view.width; ++x) {
      const auto pixel =
          static_cast<size_t>(y) * static_cast<size_t>(view.width) + static_cast<size_t>(x);
      if (!view.mask[pixel]) continue;
      const Rgb wanted = exposure * view.reference[next], found = exposure * predicted[next];
      const float off = kDifferenceGain * std::abs(luminance(wanted) - luminance(found));
      sheet.set(0, x, y, wanted);
      sheet.set(1, x, y, found);
      sheet.set(2, x, y, {off, off, off});
      ++next;
    }
  }
  return sheet.picture(view.scene);
}

std::vector<PreviewPicture> Previews::draw(nn::LightTransportModel& model,
                                           at::Device device) const {
  const torch::NoGradGuard no_grad;
  const bool was_training = model->is_training();
  model->eval();
  std::vector<PreviewPicture> out;
  for (const ViewExample& view : views_) out.push_back(draw(view, model, device));
  model->train(was_training);
  return out;
}

void write_previews(const std::filesystem::path& run, int64_t step,
                    const std::vector<PreviewPicture>& pictures) {
  const std::filesystem::path newest = run / "previews", kept = newest / step_folder(step);
  make_directory(newest);
  for (size_t i = 0; i < pictures.size(); ++i) {
    const auto& [scene, width, height, png] = pictures[i];
    const std::string_view bytes(reinterpret_cast<const char*>(png.data()), png.size());
    write_file(newest / (scene + ".png"), bytes);
    if (i >= kKeptPreviews) continue;
    make_directory(kept);
    write_file(kept / (scene + ".png"), bytes);
  }
}

}  // namespace lte::train
