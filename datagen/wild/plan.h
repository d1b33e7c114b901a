// Plans: one to five convex cells, joined along their sides, each with a floor and a ceiling.
#pragma once

#include <optional>
#include <vector>

#include "datagen/wild/dice.h"
#include "datagen/wild/polygon.h"
#include "datagen/wild/shares.h"

namespace lte::datagen::wild {

struct Ceiling {
  CeilingKind kind = CeilingKind::Flat;
  float eaves = 2.5f;  ///< world height of the lowest part
  /// Flat, Shed, Gable, Vault: height y at x = dot(p, along), linear between knots.
  Vec2 along{1, 0};
  std::vector<Vec2> profile;
  /// Tent, Dome: height y on the outline shrunk towards its centre to x of its size, from 1 to 0.
  std::vector<Vec2> rings;
};

/// A part of a wall that is not there. u runs along the edge from its first corner; heights are of
/// the world.
struct Hole {
  OpeningKind kind = OpeningKind::Window;
  float u0 = 0, u1 = 0, low = 0;
  std::vector<Vec2> top;  ///< (u, y) from u0 to u1
  float depth = 0;        ///< metres of wall to go through; 0 for a sheet
  int other = -1;         ///< cell on the other side; -1 for the outside
  bool reveal = false;    ///< the sides of the hole are built from here
  bool closed = false;    ///< a pane fills it
};

struct Cell {
  Polygon outline;
  float floor = 0;
  Ceiling ceiling;
  std::vector<std::vector<Hole>> holes;  ///< by edge

  /// Height of the ceiling over a point of the cell.
  float height_at(const Vec2& p) const;
  /// Top of a wall: (u, y) from one corner to the next, linear between.
  std::vector<Vec2> top_of(size_t edge) const;
  bool rectangular() const;
  /// Whether no hole is within `margin` of this part of a wall.
  bool is_wall(size_t edge, float u0, float u1, float low, float high, float margin) const;
};

/// Two cells side by side: [u0, u1] of an edge of `a`, on edge 0 of `b`.
struct Link {
  int a = 0, b = 0;
  size_t edge = 0;
  float u0 = 0, u1 = 0, thickness = 0;
  OpeningKind kind = OpeningKind::Door;
};

struct Plan {
  PlanKind kind = PlanKind::Single;
  std::vector<Cell> cells;
  std::vector<Link> links;
  float unit = 4;  ///< metres, size of a typical cell: furniture and doors follow it

  float floor_area() const;
};

/// Height y of a polyline at x.
float height_on(const std::vector<Vec2>& line, float x);

/// Cells with ceilings, whose walls have no holes yet.
/// @param max_cells  1 to 5
Plan make_plan(int min_cells, int max_cells, float unit, Dice* dice);

}  // namespace lte::datagen::wild
