// Kitchen units and the fridge.
#include <algorithm>
#include <cmath>

#include "datagen/common/daylight.h"
#include "datagen/homes/furniture/furniture.h"

namespace lte::datagen::homes {
namespace {

constexpr float kBack = -0.3f, kFront = 0.3f, kTop = 0.9f, kSlab = 0.038f;

/// A row of units: where things are along it, and what they are made of.
struct Run {
  float x0, x1;
  float sink, hob;  ///< middles
  int body, front, worktop, handle;
};

constexpr float kSinkHalf = 0.26f, kHobHalf = 0.29f, kSinkBack = -0.2f, kSinkFront = 0.2f;

/// The worktop around the sink's cut-out, and the sink hanging in it.
void add_worktop(Kit* kit, Piece* piece, const Run& run) {
  const float y0 = kTop - kSlab, a = run.sink - kSinkHalf, b = run.sink + kSinkHalf,
              edge = kFront + 0.02f;
  const float r = 0.003f;
  kit->block(piece, {run.x0, y0, kBack}, {a, kTop, edge}, run.worktop, r);
  kit->block(piece, {b, y0, kBack}, {run.x1, kTop, edge}, run.worktop, r);
  kit->block(piece, {a, y0, kBack}, {b, kTop, kSinkBack}, run.worktop, r);
  kit->block(piece, {a, y0, kSinkFront}, {b, kTop, edge}, run.worktop, r);
  const int steel = kit->palette->chrome();
  Mesh bowl = lathe(smooth(std::vector<Vec2>{{0, -0.2f},
                                             {0.9f, -0.19f},
                                             {0.97f, -0.1f},
                                             {0.985f, 0.001f},
                                             {1.02f, 0.003f},
                                             {1.02f, 0.006f},
                                             {0.97f, 0.005f},
                                             {0.93f, -0.02f},
                                             {0.9f, -0.15f},
                                             {0.8f, -0.185f},
                                             {0, -0.19f}},
                           3),
                    2 * kit->detail.turn(0.26f));
  square_off(&bowl, 8);
  piece->add(bowl, steel,
             translation({run.sink, kTop, 0}) * scaling({kSinkHalf - 0.002f, 1, 0.198f}));
  kit->turned(piece, {{0, kTop}, {0.026f, kTop}, {0.022f, kTop + 0.03f}, {0, kTop + 0.035f}}, steel,
              {run.sink, 0, kSinkBack - 0.05f}, false, 2);
  kit->bar(piece,
           smooth(std::vector<Vec3>{{run.sink, kTop + 0.02f, kSinkBack - 0.05f},
                                    {run.sink, kTop + 0.22f, kSinkBack - 0.05f},
                                    {run.sink, kTop + 0.3f, kSinkBack + 0.02f},
                                    {run.sink, kTop + 0.2f, kSinkBack + 0.1f}},
                  6),
           0.012f, steel);
  kit->bar(piece,
           {{run.sink + 0.01f, kTop + 0.05f, kSinkBack - 0.05f},
            {run.sink + 0.08f, kTop + 0.075f, kSinkBack - 0.05f}},
           0.006f, steel);
}

void add_hob_and_oven(Kit* kit, Piece* piece, const Run& run) {
  const int black = kit->palette->black(), metal = kit->palette->metal();
  kit->block(piece, {run.hob - kHobHalf, kTop, -0.22f}, {run.hob + kHobHalf, kTop + 0.008f, 0.24f},
             black, 0.003f);
  const float y = kTop + 0.008f;
  for (const float dx : {-0.14f, 0.14f}) {
    for (const float z : {-0.1f, 0.12f}) {
      const float r = kit->draw(0.075f, 0.1f);
      Mesh grate = lathe({{r - 0.008f, y}, {r, y}, {r, y + 0.01f}, {r - 0.008f, y + 0.01f}},
                         kit->detail.turn(r), true);
      piece->add(grate, metal, translation({run.hob + dx, 0, z}));
      kit->turned(piece, {{0, y}, {0.045f, y}, {0.04f, y + 0.008f}, {0, y + 0.01f}}, black,
                  {run.hob + dx, 0, z}, false, 1);
    }
  }
  const float x0 = run.hob - 0.295f, x1 = run.hob + 0.295f, z = kFront - 0.02f;
  kit->block(piece, {x0, 0.1f, z}, {x1, kTop - kSlab - 0.005f, kFront}, metal, 0.004f);
  kit->block(piece, {x0 + 0.04f, 0.16f, kFront - 0.005f}, {x1 - 0.04f, 0.62f, kFront + 0.006f},
             black, 0.004f);
  kit->bar(piece,
           smooth(std::vector<Vec3>{{x0 + 0.06f, 0.68f, kFront - 0.01f},
                                    {x0 + 0.06f, 0.68f, kFront + 0.035f},
                                    {x1 - 0.06f, 0.68f, kFront + 0.035f},
                                    {x1 - 0.06f, 0.68f, kFront - 0.01f}},
                  3),
           0.009f, metal);
  for (int i = 0; i < 4; ++i) {
    Mesh knob = lathe({{0, 0}, {0.018f, 0}, {0.016f, 0.02f}, {0, 0.02f}}, kit->detail.turn(0.018f));
    piece->add(knob, black,
               translation({x0 + 0.12f + 0.115f * static_cast<float>(i), 0.77f, kFront}) *
                   rotation(0, 90));
  }
}

/// Base units from the run's start to its end, leaving room for oven and sink.
void add_base_units(Kit* kit, Piece* piece, const Run& run) {
  const float top = kTop - kSlab;
  std::vector<std::pair<float, float>> spans{
      {run.x0, run.hob - 0.3f}, {run.hob + 0.3f, run.sink - 0.3f}, {run.sink + 0.3f, run.x1}};
  if (run.sink < run.hob)
    spans = {
        {run.x0, run.sink - 0.3f}, {run.sink + 0.3f, run.hob - 0.3f}, {run.hob + 0.3f, run.x1}};
  for (const auto& [a, b] : spans) {
    if (b - a < 0.15f) {
      if (b - a > 0.002f)
        kit->block(piece, {a, 0, kBack}, {b, top, kFront - 0.02f}, run.body, 0.002f);
      continue;
    }
    const int units = std::max(1, static_cast<int>(std::lround((b - a) / 0.55f)));
    for (int i = 0; i < units; ++i) {
      const float w = (b - a) / static_cast<float>(units), x = a + w * static_cast<float>(i);
      const int drawers = kit->chance(0.4f) ? 3 : 0;
      kit->cabinet(piece, {x, 0, kBack}, {x + w, top, kFront}, !drawers && w > 0.5f ? 2 : 1,
                   drawers, run.body, run.front, run.handle);
    }
  }
  kit->block(piece, {run.hob - 0.299f, 0, kBack}, {run.hob + 0.299f, top, kFront - 0.021f},
             run.body, 0.002f);
  // The sink hangs into its unit: a low carcass behind full doors.
  kit->block(piece, {run.sink - 0.299f, 0, kBack},
             {run.sink + 0.299f, kTop - 0.22f, kFront - 0.021f}, run.body, 0.002f);
  kit->fronts(piece, {run.sink - 0.297f, 0.064f, kFront - 0.02f},
              {run.sink + 0.297f, top - 0.004f, kFront}, 2, 0, run.front, run.handle);
}

void add_wall_units(Kit* kit, Piece* piece, const Run& run) {
  const float low = 1.42f, high = 2.12f, depth = 0.34f;
  for (const auto& [a, b] :
       {std::pair{run.x0, run.hob - 0.32f}, std::pair{run.hob + 0.32f, run.x1}}) {
    const int units = static_cast<int>((b - a) / 0.38f);
    for (int i = 0; i < units; ++i) {
      const float w = (b - a) / static_cast<float>(units), x = a + w * static_cast<float>(i);
      kit->cabinet(piece, {x, low, kBack}, {x + w, high, kBack + depth}, w > 0.55f ? 2 : 1, 0,
                   run.body, run.front, run.handle);
    }
    if (b - a < 0.4f || !kit->chance(kit->lit_share)) continue;
    const int light =
        kit->palette->emitter("kitchen strip", light_tint(0.6f) * (3 * kit->radiance));
    const float z = kBack + 0.12f, x0 = a + 0.05f, x1 = b - 0.05f;
    kit->block(piece, {x0, low - 0.014f, z}, {x1, low, z + 0.03f}, kit->palette->chrome(), 0.002f);
    piece->add(
        panel({x0 + 0.005f, low - 0.0145f, z + 0.004f}, {x1 - x0 - 0.01f, 0, 0}, {0, 0, 0.022f}),
        light);
  }
  // A hood: a broad foot and a chimney.
  const int metal = kit->palette->chrome();
  kit->block(piece, {run.hob - 0.3f, 1.5f, kBack}, {run.hob + 0.3f, 1.57f, kBack + 0.46f}, metal,
             0.006f);
  kit->block(piece, {run.hob - 0.14f, 1.57f, kBack}, {run.hob + 0.14f, high, kBack + 0.26f}, metal,
             0.004f);
}

}  // namespace

Piece make_kitchen_run(Kit* kit, float length, bool upper) {
  Piece piece;
  piece.name = "kitchen run";
  Run run{-length / 2,
          length / 2,
          0,
          0,
          kit->palette->lacquer(),
          kit->palette->front(),
          kit->palette->worktop(),
          kit->count(0, 5)};
  const bool sink_left = kit->chance(0.5f);
  run.sink = (sink_left ? -1.0f : 1.0f) *
             (length / 2 - 0.31f - kit->draw(0, std::max(0.0f, length / 2 - 0.95f)));
  run.hob = -(sink_left ? -1.0f : 1.0f) *
            (length / 2 - 0.31f - kit->draw(0, std::max(0.0f, length / 2 - 0.95f)));
  add_base_units(kit, &piece, run);
  add_worktop(kit, &piece, run);
  add_hob_and_oven(kit, &piece, run);
  kit->block(&piece, {run.x0, kTop, kBack}, {run.x1, upper ? 1.42f : kTop + 0.1f, kBack + 0.012f},
             upper ? kit->palette->wall_tiles() : run.worktop, 0.001f);
  if (upper) add_wall_units(kit, &piece, run);
  const float z0 = kBack + 0.05f, z1 = kFront - 0.02f, clear = kTop + (upper ? 0.42f : 0.5f);
  const float a = std::min(run.sink, run.hob) + 0.33f, b = std::max(run.sink, run.hob) - 0.33f;
  for (const auto& [x0, x1] :
       {std::pair{run.x0 + 0.02f, std::min(run.sink, run.hob) - 0.33f}, std::pair{a, b},
        std::pair{std::max(run.sink, run.hob) + 0.33f, run.x1 - 0.02f}})
    if (x1 - x0 > 0.15f) piece.tops.push_back({{x0, kTop, z0}, {x1, clear, z1}});
  return piece;
}

Piece make_fridge(Kit* kit) {
  Piece piece;
  piece.name = "fridge";
  const float high = kit->draw(1.7f, 1.95f), split = kit->draw(0.6f, 0.8f);
  const int body = kit->chance(0.5f) ? kit->palette->chrome() : kit->palette->ceramic(),
            metal = kit->palette->metal();
  kit->block(&piece, {-0.3f, 0.03f, -0.31f}, {0.3f, high, 0.25f}, body, 0.01f);
  kit->block(&piece, {-0.28f, 0, -0.3f}, {0.28f, 0.05f, 0.22f}, kit->palette->black(), 0.004f);
  for (const auto& [y0, y1] : {std::pair{0.06f, split}, std::pair{split + 0.008f, high}}) {
    kit->block(&piece, {-0.3f, y0, 0.254f}, {0.3f, y1, 0.31f}, body, 0.012f);
    const float low = y0 < split ? y1 - 0.3f : y0 + 0.06f;
    kit->bar(&piece,
             smooth(std::vector<Vec3>{{-0.25f, low, 0.3f},
                                      {-0.25f, low, 0.345f},
                                      {-0.25f, low + 0.24f, 0.345f},
                                      {-0.25f, low + 0.24f, 0.3f}},
                    3),
             0.009f, metal);
  }
  return piece;
}

}  // namespace lte::datagen::homes
