// The matrix of recognizers: which pairs of entity types give a constraint. The compiler checks it against the list.
//
// To add a pair: (1) recognize/NAME.hpp, one struct (multi_method.hpp shows its shape); (2) its include and its place
// in the list below, and its cell in the drawing; (3) its test. The compiler compares list and drawing.
#pragma once

#include <string_view>

#include "engine/constraint/multi_method.hpp"
#include "engine/constraint/recognize/circle_circle.hpp"
#include "engine/constraint/recognize/circle_cone.hpp"
#include "engine/constraint/recognize/circle_cylinder.hpp"
#include "engine/constraint/recognize/cone_cone.hpp"
#include "engine/constraint/recognize/cylinder_cylinder.hpp"
#include "engine/constraint/recognize/cylinder_plane.hpp"
#include "engine/constraint/recognize/line_plane.hpp"
#include "engine/constraint/recognize/plane_plane.hpp"
#include "engine/constraint/recognize/sphere_cone.hpp"
#include "engine/constraint/recognize/sphere_cylinder.hpp"
#include "engine/constraint/recognize/sphere_plane.hpp"
#include "engine/constraint/recognize/sphere_sphere.hpp"
#include "engine/constraint/recognize/torus_torus.hpp"

namespace verisim {

using Recognizers =
    RecognizerList<PlanePlane, CylinderCylinder, ConeCone, SphereSphere, TorusTorus, CircleCircle, CircleCylinder,
                   CircleCone, SphereCylinder, SphereCone, SpherePlane, CylinderPlane, LinePlane>;

/// Rows and columns in the order of Entity. Letters: P planar, C cylindrical, K conical, S spherical, A annular,
/// O other; '.' see the mirrored cell; '-' none, on purpose:
///   cone on plane, cone on cylinder, torus on anything but a torus: contact along a line or at a point that moves with
///     the pose, so there is no axis or centre to keep; the voxels' force stands.
///   edges on edges (but circles): two curves cross at a point and press along the normal to both, which turns with the
///     pose.
///   line on round faces: a straight edge touches them at points, and the faces beside it are in the set anyway.
///   circle on plane: the end face that the rim bounds is in the set as well and gives the same normal.
///   circle on sphere or torus: contact all around the rim only while coaxial, else at points that move with the pose;
///     the faces beside the rim answer.
///   ellipse (the rim of an oblique cut) on anything: as circle on sphere.
///   other: no equation is known.
inline constexpr std::array<std::string_view, 10> kDrawing = {
    //               plane
    //               | cylinder
    //               | | cone
    //               | | | sphere
    //               | | | | torus
    //               | | | | | other surface
    //               | | | | | | line
    //               | | | | | | | circle
    //               | | | | | | | | ellipse
    //               | | | | | | | | | other curve
    /* plane    */ "P O - O - - O - - -",
    /* cylinder */ ". C - A - - - C - -",
    /* cone     */ ". . K S - - - K - -",
    /* sphere   */ ". . . S - - - - - -",
    /* torus    */ ". . . . O - - - - -",
    /* other    */ ". . . . . - - - - -",
    /* line     */ ". . . . . . - - - -",
    /* circle   */ ". . . . . . . C - -",
    /* ellipse  */ ". . . . . . . . - -",
    /* other    */ ". . . . . . . . . -",
};

namespace recognizing {
template <typename List>
consteval bool is_as_drawn() {
  constexpr auto drawing = drawing_of<List, Entity>();
  for (std::size_t i = 0; i < drawing.size(); ++i) {
    for (std::size_t j = 0; j < drawing.size(); ++j) {
      if (drawing[i][j] != kDrawing[i][2 * j]) return false;
    }
  }
  return true;
}
}  // namespace recognizing
static_assert(recognizing::is_as_drawn<Recognizers>(), "the drawing above does not show the list of recognizers");

}  // namespace verisim
