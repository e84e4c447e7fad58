// A solid described by primitives and booleans of them, as the ruler knows it: a tree over surfaces that divide space,
// and the pieces of these surfaces that can be its own. Read from the text of a Solid (engine/geometry/solid.hpp),
// which is data here: nothing of the CAD kernel's or the engine's geometry is asked.
//
// The tree's value T(x) [m] at a point: union = min, common part = max, complement = -. Negative inside. It is never
// larger than the distance to the solid's surface, and changes by at most 1 m per m.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/ruler/divider.hpp"

namespace verisim::ruler {

/// A rectangle of parameters (u, v) on a divider; its x, y and z are directions of the solid's coordinates.
///   plane     origin + u x + v y                                        [m, m]
///             is_polar: origin + v (cos u x + sin u y)                  [rad, m]
///   cylinder  origin + radius (cos u x + sin u y) + v z                 [rad, m]
///   cone      apex + v (sine (cos u x + sin u y) + cosine z)            [rad, m along the slant]
///   sphere    centre + radius (cos v (cos u x + sin u y) + sin v z)     [rad, rad]
///   torus     centre + (ring + radius cos v) (cos u x + sin u y) + radius sin v z   [rad, rad]
struct Face {
  std::uint32_t divider = 0;
  Vector3d origin = Vector3d::Zero();
  Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  double u_low = 0, u_high = 0, v_low = 0, v_high = 0;
  bool is_polar = false;
  /// Of a plane: faces that cover all within their v_high of their origins, and so leave the rest to this one.
  std::vector<std::uint32_t> discs{};
};

class Csg {
 public:
  /// Error(input) if it is not the text of a Solid.
  explicit Csg(std::string_view text);

  [[nodiscard]] const std::vector<Divider>& dividers() const { return dividers_; }
  [[nodiscard]] const std::vector<Face>& faces() const { return faces_; }
  /// T, from the values of the dividers. @pre one value for each
  [[nodiscard]] double value(std::span<const double> values) const;
  /// On which side of the solid's surface a point is, from the sides of the dividers on which it is: below 0 within,
  /// above 0 outside, 0 unknown. Only the sides that matter have to be known. @pre one side for each
  [[nodiscard]] int side(std::span<const std::int8_t> sides) const;
  /// The dividers of which either side is within some primitive and outside of another, as of a hole that is as deep
  /// as its block is high.
  [[nodiscard]] const std::vector<std::uint32_t>& of_both_senses() const { return of_both_senses_; }
  /// A ball around all of its faces.
  [[nodiscard]] const Vector3d& middle() const { return middle_; }
  [[nodiscard]] double radius() const { return radius_; }
  /// The same solid elsewhere.
  [[nodiscard]] Csg placed(const Pose& X) const;

  enum class Operation : std::uint8_t { divider, complement, least, greatest };
  /// After those it works on. `divider`: its index; complement: of the node `first`.
  struct Node {
    Operation operation;
    std::uint32_t first = 0, second = 0;
  };
  /// The tree; its root is the last.
  [[nodiscard]] const std::vector<Node>& nodes() const { return nodes_; }

 private:
  friend class CsgReader;
  void find_senses();
  void add_discs();

  std::vector<Node> nodes_;
  std::vector<Divider> dividers_;
  std::vector<Face> faces_;
  std::vector<std::uint32_t> of_both_senses_;
  Vector3d middle_ = Vector3d::Zero();
  double radius_ = 0;
};

}  // namespace verisim::ruler
