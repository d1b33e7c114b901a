// What the wild generator draws, and how often: every distribution that is no key of `wild:`.
#pragma once

#include <array>

namespace lte::datagen::wild {

/// Shapes of plans. All but the first and Round join several cells; L, T and U are joined by whole
/// sides and so make one concave room.
enum class PlanKind { Single, L, T, U, Corridor, Alcoves, Round, Enfilade, Cluster };
inline constexpr int kPlanKinds = 9;

/// Gable and Vault rise along one direction, Tent and Dome from all sides; None is open to the sky.
enum class CeilingKind { Flat, Shed, Gable, Vault, Tent, Dome, None };
inline constexpr int kCeilingKinds = 7;

/// What joins two cells, or a cell and the outside. Whole takes all that both sides share; Missing
/// is an outer wall that is not there.
enum class OpeningKind { Whole, Wide, Door, Ajar, Arch, Slit, Hatch, Window, Missing };
inline constexpr int kOpeningKinds = 9;

/// Pane is a window that shines; Kit a lamp of datagen/homes; Shell makes all walls of a closed
/// room shine, alone in it: a furnace.
enum class LampKind {
  FlushPanel,
  HangingPanel,
  TwoSidedSheet,
  Globe,
  Tube,
  OpenShade,
  Screen,
  Spot,
  Point,
  GlowingWall,
  Cove,
  BehindBoard,
  Pane,
  Kit,
  Shell
};
inline constexpr int kLampKinds = 15;

struct Shares {
  // In the order of the enums above.
  std::array<float, kPlanKinds> plans{0.16f, 0.12f, 0.08f, 0.08f, 0.12f, 0.08f, 0.08f, 0.1f, 0.18f};
  std::array<float, kCeilingKinds> ceilings{0.56f, 0.12f, 0.1f, 0.08f, 0.05f, 0.05f, 0.04f};
  std::array<float, 7> joints{0.12f, 0.18f, 0.25f, 0.15f, 0.12f, 0.1f, 0.08f};  // Whole to Hatch
  // Of lamps; Pane counts 0 in a scene without a window, Shell is drawn for a whole scene.
  std::array<float, kLampKinds> lamps{0.13f, 0.08f, 0.11f, 0.1f,  0.08f, 0.07f, 0.05f, 0.06f,
                                      0.05f, 0.06f, 0.05f, 0.05f, 0.05f, 0.06f, 0};
  float furnace = 0.02f;      // of scenes with one cell: closed, all of its shell shines
  float one_to_three = 0.6f;  // of scenes: so many lamps; of the others half have 4 to 12
  float elsewhere = 0.25f;    // of scenes of several cells: one cell alone has all lamps
  float sheet_walls = 0.35f;  // of joints: the wall between is one sheet that both sides see
  float thickness_m[2] = {0.04f, 0.5f};  // of the others, log-uniform
  float turned = 0.8f;                   // of scenes: by any angle against the axes
  float other_height = 0.3f;             // of cells: 0.7 to 1.5 times the height of the first
  float step = 0.15f;                    // of cells: the floor is up to 0.4 m higher or lower
  float window = 0.25f;                  // of outer walls; 0.6 under a sky
  float missing_wall = 0.06f;            // of cells: one outer wall is not there
  float mezzanine = 0.3f;                // of rectangular cells of 2.6 m and more
  float columns = 0.15f;                 // of cells: one to six
  float boards = 0.2f;                   // of cells: one to three thin walls that stand free
  // Albedo of a surface: uniform in a range that its scene draws: dark, mid, bright or any.
  std::array<float, 4> keys{0.12f, 0.33f, 0.15f, 0.4f};
  float albedo[4][2] = {{0.02f, 0.25f}, {0.2f, 0.7f}, {0.75f, 0.97f}, {0.02f, 0.97f}};
  float plain = 0.6f;       // of surfaces: one color; the others have a texture
  float muted = 0.35f;      // of scenes: no color is more saturated than 0.2, all lamps are white
  float saturated = 0.25f;  // of colors elsewhere: saturation 0.5 to 1, else 0 to 0.4
  float power_m2[2] = {2, 120};  // W of all lamps a square metre of floor, log-uniform
  float unequal = 8;             // a lamp's share of it is log-uniform in [1/8, 8], then normalized
  float colored_lamp = 0.15f;    // of lamps: saturated light, else white from cool to warm
  float sun = 0.5f;              // of skies
  float sky_picture = 0.6f;      // of skies: one of CIE's, else one radiance
  float lamps_under_sky = 0.5f;  // of scenes with a sky
  float pieces_m2[2] = {0, 0.9f};  // things a square metre of floor of 4 m rooms, uniform
};

inline constexpr Shares kShares;
inline constexpr int kMaxGroups = 8;          ///< light groups; lamps beyond share them in turn
inline constexpr int kMaxTriangles = 300000;  ///< of a scene; one with more is drawn again
inline constexpr int kMaxPieces = 40;         ///< things in a cell

}  // namespace lte::datagen::wild
