// The shapes that homes are modelled from: rounded boxes, cushions, surfaces of revolution, tubes,
// swept profiles and thin sheets. All but panel() are closed: welded by position, every edge is
// shared by exactly two triangles. They are wound counter-clockwise seen from outside and have no
// zero-area triangles. UV set 0 is in metres, or in [0, 1] where it says so.
#pragma once

#include <functional>
#include <vector>

#include "lte/base/math.h"
#include "lte/scene/scene.h"

namespace lte::datagen::homes {

using scene::Mesh;

/// Fineness of curves. 1 is the default; the number of triangles grows with about its square.
struct Detail {
  float level = 1;

  int turn(float radius_m) const;               ///< segments of a full circle, a multiple of 4
  int bevel() const;                            ///< segments of 45 degrees of a rounded edge
  int steps(float length_m, float step) const;  ///< cells of a length that are `step` m at level 1
};

/// A box from `low` to `high` whose edges are rounded.
/// @param radius   metres; at most half the shortest edge is taken
/// @param bevel    segments of 45 degrees of an edge
/// @param cell_m   longest edge of the flat parts' cells, for displace(); INFINITY for none
/// @note u runs along the longest axis, and so does the grain of wood.
Mesh rounded_box(const Vec3& low, const Vec3& high, float radius, int bevel,
                 float cell_m = INFINITY);

/// A pillow about the origin: a superellipsoid pinched towards its rim, with a seam along it.
/// @param size  full extents, metres; thickness along y
Mesh cushion(const Vec3& size, int turn, float seam_m = 0.006f);

/// Surface of revolution about y. The profile runs upwards on the outside, from the axis to the
/// axis (x = radius, y = height); a `ring` profile is a counter-clockwise loop off the axis
/// instead, such as a lampshade's or a bowl's wall.
Mesh lathe(const std::vector<Vec2>& profile, int turn, bool ring = false);

/// A lathed sphere around the origin.
Mesh sphere(float radius, int turn);

/// A Catmull-Rom curve through the points, with `steps` chords a span. The ends are kept. A curve
/// in the plane stays within the box of each span's ends.
std::vector<Vec2> smooth(const std::vector<Vec2>& points, int steps);
std::vector<Vec3> smooth(const std::vector<Vec3>& points, int steps);

/// A round bar along a path; both ends are capped.
Mesh tube(const std::vector<Vec3>& path, float radius, int turn);

/// Sweeps a convex counter-clockwise profile (x to the left of the way, y up) along a path in the
/// xz plane, mitred at its corners. An open path is capped at its ends.
Mesh sweep(const std::vector<Vec2>& path_xz, const std::vector<Vec2>& profile, bool closed);

/// The surface `at(u, v)` over [0, 1]², made solid by half of `thickness` (metres) to either side.
Mesh sheet(int cells_u, int cells_v, const std::function<Vec3(float, float)>& at, float thickness);

/// A rectangle from `corner` along `right` and `up` whose front faces right × up: the only open
/// shape. UVs cover [0, 1]², upright as pictures are.
Mesh panel(const Vec3& corner, const Vec3& right, const Vec3& up);

/// Moves every vertex by `offset(position)`. A closed mesh stays closed.
void displace(Mesh* mesh, const std::function<Vec3(const Vec3&)>& offset);

/// Bends circles about y to superellipses |x|^power + |z|^power = r^power: round bodies with nearly
/// rectangular outlines, such as tubs.
void square_off(Mesh* mesh, float power);

/// Appends `part`, transformed. A transform that mirrors keeps front faces in front.
void append(Mesh* mesh, const Mesh& part, const Affine& to_mesh);

/// Maps UVs so that their range becomes `low` to `high`, for atlases and pictures.
void fit_uvs(Mesh* mesh, const Vec2& low, const Vec2& high);

Bounds bounds_of(const Mesh& mesh);
/// Signed volume, m³: positive for closed meshes wound outwards.
double volume_of(const Mesh& mesh);

Affine translation(const Vec3& by);
/// Rotation about x, y or z (axis 0 to 2), right-handed, in degrees.
Affine rotation(int axis, double degrees);
Affine scaling(const Vec3& by);

}  // namespace lte::datagen::homes
