#include "infer/bench/encoding_reuse.h"

#include <cmath>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include <ATen/core/Tensor.h>

#include "infer/session/state.h"
#include "lte/base/check.h"
#include "lte/nn/model.h"
#include "lte/runtime/torch_parts.h"

namespace lte::infer {
namespace {

/// A difference that nobody would see.
constexpr float kSmall = 0.01f;

using Place = std::tuple<float, float, float>;

/// Values, all of one length, by where they are. Of those at one place the last.
using Values = std::map<Place, std::vector<float>>;

Values light_by_place(const GroupedPoints& points) {
  Values out;
  const size_t count = points.surface.position.size();
  for (size_t i = 0; i < count; ++i) {
    const Vec3& p = points.surface.position[i];
    std::vector<float>& light = out[{p.x, p.y, p.z}];
    light.assign(6, 0);
    for (size_t at = i; points.light && at < points.light->direct.size(); at += count) {
      for (int c = 0; c < 3; ++c) {
        light[static_cast<size_t>(c)] += points.light->direct[at][c];
        light[static_cast<size_t>(3 + c)] += points.light->indirect[at][c];
      }
    }
  }
  return out;
}

Values latents_by_place(const LightLayer& layer) {
  const nn::Embedding parts = runtime::TorchParts::embedding(*layer.embedding);
  const at::Tensor position = parts.position.cpu().contiguous(),
                   features = parts.features.cpu().to(at::kFloat).contiguous();
  const auto* p = position.const_data_ptr<float>();
  const auto* f = features.const_data_ptr<float>();
  const auto width = static_cast<size_t>(features.size(1));
  Values out;
  for (int64_t i = 0; i < position.size(0); ++i, p += 3, f += width)
    out[{p[0], p[1], p[2]}].assign(f, f + width);
  return out;
}

/// Shares of `now`: in the same place as before; with the same values, too; with nearly the same.
struct Kept {
  double place = 0, values = 0, nearly = 0;
};

Kept kept(const Values& before, const Values& now) {
  Kept out;
  for (const auto& [place, values] : now) {
    const auto found = before.find(place);
    if (found == before.end()) continue;
    double off = 0, sum = 0;
    for (size_t i = 0; i < values.size(); ++i) {
      off += std::fabs(double{values[i]} - found->second[i]);
      sum += std::fabs(double{found->second[i]});
    }
    const double share = 1.0 / static_cast<double>(now.size());
    out.place += share;
    if (values == found->second) out.values += share;
    if (off <= kSmall * sum) out.nearly += share;
  }
  return out;
}

void put(const std::string& what, const Kept& share, BenchResult* row) {
  row->figures[what + "_in_place"] = share.place;
  row->figures[what + "_kept"] = share.values;
  row->figures[what + "_within_1pc"] = share.nearly;
}

}  // namespace

BenchResult compare_encodings(const SessionState& before, const SessionState& now) {
  for (const SessionState* state : {&before, &now})
    LTE_CHECK(state->accuracy() == Accuracy::Full && state->parts().layers.size() == 1,
              "expected a scene whose light the network answers for, all in one encoding");
  const LightLayer &first = *before.parts().layers.front().layer,
                   &second = *now.parts().layers.front().layer;
  BenchResult row{
      "what an encoding keeps", static_cast<int64_t>(second.points->surface.size()), 0, 0, {}};
  put("points", kept(light_by_place(*first.points), light_by_place(*second.points)), &row);
  put("latents", kept(latents_by_place(first), latents_by_place(second)), &row);
  row.figures["latents"] = static_cast<double>(second.embedding->info().latents);
  return row;
}

}  // namespace lte::infer
