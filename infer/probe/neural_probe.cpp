#include "infer/probe/neural_probe.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "infer/light/cached_light.h"
#include "lte/base/parallel.h"
#include "lte/base/random.h"
#include "lte/nn/model.h"
#include "lte/pathtrace/hemisphere.h"
#include "lte/scene/surface.h"

namespace lte::infer {
namespace {

/// Rays by which nearness_at() looks around, in a grid over the unit square.
constexpr int kLooks = 4;
/// Places around a point at which its answer is compared.
constexpr int kAround = 4;

}  // namespace

PointAlbedo albedo_at(const pathtrace::Bvh& bvh, const scene::PointTable& points) {
  PointAlbedo out;
  const float reach = kSurfaceDistance * length(bvh.bounds().extent());
  for (size_t i = 0; i < points.size(); ++i) {
    const Vec3& n = points.normal[i];
    const pathtrace::Hit hit = bvh.intersect({points.position[i] + n * reach, -n, 0, 2 * reach});
    Rgb albedo = kFreeAlbedo, emission;
    if (hit.valid()) {
      scene::evaluate_appearance(bvh.scene(), hit.instance, hit.triangle, hit.u, hit.v, 0, &albedo,
                                 &emission);
    } else {
      ++out.off_surface;
    }
    out.albedo.push_back(albedo);
  }
  return out;
}

std::vector<double> nearness_at(const pathtrace::Bvh& bvh, const scene::PointTable& points,
                                double reach) {
  std::vector<double> out(points.size());
  const float magnitude = 0.5f * length(bvh.bounds().extent());
  parallel_for(static_cast<int64_t>(points.size()), 1024, [&](int64_t begin, int64_t end) {
    for (int64_t point = begin; point < end; ++point) {
      const auto i = static_cast<size_t>(point);
      const Vec3 origin = pathtrace::offset_origin(points.position[i], points.normal[i], magnitude);
      Rng rng(0, i);
      const auto in_cell = [&rng](int cell) {
        return (static_cast<float>(cell) + rng.uniform()) / kLooks;
      };
      for (int ray = 0; ray < kLooks * kLooks; ++ray) {
        const Vec2 u{in_cell(ray % kLooks), in_cell(ray / kLooks)};
        float density = 0;
        const Vec3 direction = pathtrace::cosine_direction(points.normal[i], u, &density);
        const auto distance = double{bvh.intersect({origin, direction}).t};  // 0 in a corner
        out[i] += (distance > reach ? reach / distance : 1) / (kLooks * kLooks);
      }
    }
  });
  return out;
}

double latent_spacing(const runtime::SceneEmbedding& embedding) {
  const nn::Embedding parts = embedding.parts();
  return parts.spacing * parts.scale;
}

PointAnswers ask_at(const runtime::SceneEmbedding& embedding, const scene::PointTable& points,
                    const std::vector<Rgb>& albedo) {
  const QueryPoints queries{points.position, points.normal, albedo};
  PointAnswers out{embedding.decode(queries), std::vector<double>(points.size()),
                   std::vector<double>(points.size())};
  const auto reach = static_cast<float>(0.5 * latent_spacing(embedding));
  for (int k = 0; k < kAround; ++k) {
    std::vector<Vec3> moved = points.position;
    for (size_t i = 0; i < moved.size(); ++i) {
      Vec3 tangent, bitangent;
      make_frame(points.normal[i], &tangent, &bitangent);
      moved[i] += (k < 2 ? tangent : bitangent) * (k % 2 == 0 ? reach : -reach);
    }
    const std::vector<Rgb> there = embedding.decode({moved, points.normal, albedo});
    for (size_t i = 0; i < moved.size(); ++i)
      out.change[i] += std::pow(rms(there[i] - out.irradiance[i]), 2) / kAround;
  }
  for (double& change : out.change) change = std::sqrt(change);
  const std::vector<Rgb> cached = cached_light(embedding, queries);
  for (size_t i = 0; i < cached.size(); ++i) out.cache[i] = rms(out.irradiance[i] - cached[i]);
  return out;
}

void Draws::add(PointAnswers answers) { answers_.push_back(std::move(answers)); }

std::vector<Rgb> Draws::mean() const {
  std::vector<Rgb> sum(answers_.front().irradiance.size());
  for (const PointAnswers& answers : answers_)
    for (size_t i = 0; i < sum.size(); ++i) sum[i] += answers.irradiance[i];
  for (Rgb& value : sum) value *= 1 / static_cast<float>(answers_.size());
  return sum;
}

double Draws::standard_error(size_t point, const Rgb& middle) const {
  if (answers_.size() < 2) return 0;
  const auto draws = static_cast<double>(answers_.size());
  double squares = 0;
  for (const PointAnswers& answers : answers_)
    squares += std::pow(rms(answers.irradiance[point] - middle), 2);
  return std::sqrt(squares / (draws - 1) / draws);
}

std::vector<ErrorTerms> Draws::error_terms(const std::vector<double>& nearness,
                                           const std::vector<Rgb>& direct) const {
  const std::vector<Rgb> middle = mean();
  double overall = 0;
  for (const Rgb& value : middle) overall += rms(value) / static_cast<double>(middle.size());
  std::vector<ErrorTerms> out(middle.size());
  for (size_t i = 0; i < out.size(); ++i) {
    ErrorTerms& terms = out[i];
    terms.draws = standard_error(i, middle[i]);
    terms.mean = overall;
    terms.answer = rms(middle[i]);
    terms.near = nearness[i] * terms.answer;
    terms.direct = rms(direct[i]);
    for (const PointAnswers& answers : answers_) {
      terms.change += answers.change[i] / static_cast<double>(answers_.size());
      terms.cache += answers.cache[i] / static_cast<double>(answers_.size());
    }
  }
  return out;
}

double rms(const Rgb& value) { return std::sqrt(double{dot(value, value)} / 3); }

}  // namespace lte::infer
