#include "train/fit/fit.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <ATen/ATen.h>
#include <torch/types.h>

#include "lte/base/check.h"
#include "lte/base/random.h"
#include "lte/base/timer.h"
#include "lte/nn/model.h"
#include "lte/runtime/torch_parts.h"
#include "train/fit/by_heart.h"
#include "train/fit/fit_queries.h"

namespace lte::train {
namespace {

constexpr int64_t kHeldOut = 1024, kWatched = 512;
constexpr int kHeldOutRays = 256;  ///< of either half
constexpr int kRays = 64;          ///< of a point that is learnt
/// Points a second that are drawn for paths to choose from: more than two cores trace.
constexpr double kPointsPerSecond = 20'000;
constexpr double kTracedShare = 0.5;
constexpr int64_t kLooks = 12;
// Of rates of 0.01 to 0.1 and epsilons of 0.05 to 1, these had the least error after 200 steps in a
// room that no figure is of.
constexpr double kRate = 3e-2, kEpsilon = 1;

enum class Stream : uint64_t { Points = 1, Paths, HeldOut, First, Second, Batches };

uint64_t seed_of(uint64_t seed, Stream stream) {
  return hash_combine(seed, static_cast<uint64_t>(stream));
}

at::Tensor tensor(const std::vector<Vec3>& triples) {
  return at::from_blob(const_cast<Vec3*>(triples.data()), {static_cast<int64_t>(triples.size()), 3},
                       at::kFloat)
      .clone();
}

/// Points, and the light there over the emission scale.
struct Known {
  nn::QuerySet queries;
  at::Tensor light;        ///< [Q, 3] normalized
  at::Tensor other_light;  ///< the same by other paths; of points that are held out

  nn::QuerySet at_rows(const at::Tensor& rows) const {
    return {queries.position.index_select(0, rows), queries.normal.index_select(0, rows),
            queries.albedo.index_select(0, rows)};
  }
};

class Fitter {
 public:
  Fitter(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
         const runtime::SceneEmbedding& start, const FitSettings& settings)
      : bvh_(bvh),
        lights_(lights),
        start_(start),
        settings_(settings),
        model_(runtime::TorchParts::model(start.network())),
        parts_(runtime::TorchParts::embedding(start)) {
    const at::Tensor a = parts_.emission_scale;
    unit_ = at::where(a > 0, a, 1).to(at::kFloat);
  }

  Fit run() {
    hold_out();
    trace();
    const FitError before = error(parts_.features);
    learn();
    nn::Embedding parts = parts_;
    parts.features = best_;
    parts.table = at::Tensor();
    {
      const at::NoGradGuard no_grad;
      model_->make_tables(&parts);
    }
    Fit fit{runtime::TorchParts::from(start_.network(), parts, start_.info().scene_points, {}),
            before, error(best_)};
    fit.points = learnt_.light.size(0);
    fit.held_out = held_out_.light.size(0);
    fit.rays = rays_;
    fit.steps = steps_;
    fit.latents = best_.size(0);
    fit.trace_s = trace_s_;
    fit.learn_s = timer_.seconds() - trace_s_;
    return fit;
  }

 private:
  void say(const char* what, double share) const {
    if (settings_.progress) settings_.progress(what, std::min(share, 1.0));
  }

  Known known(const FitQueries& q) const {
    Known out{{tensor(q.position), tensor(q.normal), tensor(q.albedo)}, {}, {}};
    out.light = normalized(q);
    return out;
  }
  /// 0 in channels in which nothing is emitted.
  at::Tensor normalized(const FitQueries& q) const { return tensor(q.indirect).div(unit_); }

  void hold_out() {
    say("paths at held-out points", 0);
    FitQueries points =
        draw_queries(bvh_, kHeldOut + kWatched, seed_of(settings_.seed, Stream::HeldOut));
    const auto all = [](int64_t) { return false; };
    trace_queries(bvh_, lights_, kHeldOutRays, seed_of(settings_.seed, Stream::First), &points,
                  all);
    Known first = known(points);
    trace_queries(bvh_, lights_, kHeldOutRays, seed_of(settings_.seed, Stream::Second), &points,
                  all);
    first.other_light = normalized(points);
    const int64_t watched = first.light.size(0) / 3;
    const auto part = [&](int64_t begin, int64_t end) {
      const at::Tensor rows = at::arange(begin, end);
      return Known{first.at_rows(rows), first.light.index_select(0, rows),
                   first.other_light.index_select(0, rows)};
    };
    watched_ = part(0, watched);
    held_out_ = part(watched, first.light.size(0));
    const double mean = first.light.mean().item<double>();
    LTE_CHECK(mean > 0, bvh_.scene().name, ": no indirect light reaches its surfaces");
  }

  void trace() {
    const double until = kTracedShare * settings_.seconds;
    const double wanted =
        std::min(static_cast<double>(settings_.points), std::max(4096.0, kPointsPerSecond * until));
    FitQueries points =
        draw_queries(bvh_, static_cast<int64_t>(wanted), seed_of(settings_.seed, Stream::Points));
    trace_queries(bvh_, lights_, kRays, seed_of(settings_.seed, Stream::Paths), &points,
                  [&](int64_t done) {
                    const double share =
                        std::max(timer_.seconds() / until, static_cast<double>(done) / wanted);
                    say("paths", kTracedShare * share);
                    return timer_.seconds() >= until;
                  });
    learnt_ = known(points);
    rays_ = points.rays;
    mean_ = learnt_.light.mean().item<double>();
    LTE_CHECK(mean_ > 0, bvh_.scene().name, ": no indirect light reaches its surfaces");
    trace_s_ = timer_.seconds();
  }

  at::Tensor answer(const at::Tensor& features, const nn::QuerySet& queries) {
    nn::SceneBatch batch{{parts_}, features};
    batch.scenes[0].features = features;
    return model_->decode_normalized(batch, {queries}, nn::Values::Unchecked)[0];
  }

  /// Products of the deviations from two independent references are free of their noise.
  static std::pair<double, double> products(const at::Tensor& got, const Known& known) {
    const at::Tensor a = known.light.to(at::kDouble), b = known.other_light.to(at::kDouble),
                     mine = got.to(at::kDouble);
    return {((mine - a) * (mine - b)).mean().item<double>(), (a * b).mean().item<double>()};
  }
  double watched_error(const at::Tensor& features) {
    const at::NoGradGuard no_grad;
    return products(answer(features, watched_.queries), watched_).first;
  }
  FitError error(const at::Tensor& features) {
    const at::NoGradGuard no_grad;
    const at::Tensor got = answer(features, held_out_.queries);
    const auto [mse, square] = products(got, held_out_);
    const auto [w, ignored] =
        products(got * unit_, {{}, held_out_.light * unit_, held_out_.other_light * unit_});
    // Where all error is noise, chance may take off more than there was.
    return {std::max(mse, 0.0) / square, std::sqrt(std::max(w, 0.0))};
  }

  void learn() {
    say("learning", kTracedShare);
    at::Tensor features = parts_.features.detach().clone().requires_grad_();
    best_ = parts_.features;
    double least = watched_error(best_);
    torch::manual_seed(seed_of(settings_.seed, Stream::Batches));
    ByHeartLimits limits;
    const Timer timer;
    limits.seconds = std::max(settings_.seconds - timer_.seconds(), 0.0);
    limits.steps = settings_.steps;
    limits.clock = [&] { return timer.seconds(); };
    limits.rate = kRate;
    limits.epsilon = kEpsilon;
    const double factor = 1 / mean_;
    const ByHeart task{
        {features},
        [&](const at::Tensor& rows) { return answer(features, learnt_.at_rows(rows)) * factor; },
        learnt_.light * factor,
        at::arange(learnt_.light.size(0))};
    int64_t looked = 0;
    steps_ = learn_by_heart(task, limits, [&](int64_t steps, double seconds) {
      const double share = std::max(seconds / limits.seconds,
                                    static_cast<double>(steps) / static_cast<double>(limits.steps));
      say("learning", kTracedShare + (1 - kTracedShare) * share);
      if (share * kLooks < static_cast<double>(looked + 1)) return true;
      looked = static_cast<int64_t>(share * kLooks);
      const double error = watched_error(features);
      LTE_CHECK(std::isfinite(error), "step ", steps, ": the error is not finite");
      if (error < least) {
        least = error;
        best_ = features.detach().clone();
      }
      return true;
    });
  }

  const pathtrace::Bvh& bvh_;
  const pathtrace::Lights& lights_;
  const runtime::SceneEmbedding& start_;
  const FitSettings& settings_;
  Timer timer_;
  nn::LightTransportModel& model_;
  nn::Embedding parts_;
  at::Tensor unit_;  ///< [3]
  Known held_out_, watched_, learnt_;
  double mean_ = 1, trace_s_ = 0;
  int64_t rays_ = 0, steps_ = 0;
  at::Tensor best_;  ///< features
};

/// The parameters of a model stand still while one of these lives.
class FrozenModel {
 public:
  explicit FrozenModel(nn::LightTransportModel& model) {
    for (const at::Tensor& parameter : model->parameters()) {
      if (!parameter.requires_grad()) continue;
      parameter.requires_grad_(false);
      frozen_.push_back(parameter);
    }
  }
  ~FrozenModel() {
    for (const at::Tensor& parameter : frozen_) parameter.requires_grad_(true);
  }
  FrozenModel(const FrozenModel&) = delete;
  FrozenModel& operator=(const FrozenModel&) = delete;

 private:
  std::vector<at::Tensor> frozen_;
};

}  // namespace

Fit fit_embedding(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                  const runtime::SceneEmbedding& start, const FitSettings& settings) {
  LTE_CHECK(!start.network().config().predicts_radiance(),
            "the model predicts radiance by direction, and only irradiance can be fitted");
  LTE_CHECK(!lights.empty(), bvh.scene().name, ": nothing emits light");
  const FrozenModel frozen(runtime::TorchParts::model(start.network()));
  return Fitter(bvh, lights, start, settings).run();
}

}  // namespace lte::train
