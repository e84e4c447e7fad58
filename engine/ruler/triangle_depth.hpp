// How deep the triangles of one part reach into another part's: the largest distance to B's triangles of the points of
// A's that lie within B. Branch and bound over pieces of A's triangles. For a point x within B the depth is at most its
// distance to any one triangle of B, and that is convex in x: over a piece it is largest at a corner. So a piece is no
// deeper than the least, over a few triangles, of its corners' largest distance to it; nor than Lipschitz allows. A
// piece that meets no triangle of B is outside if its middle is.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/ruler/depth.hpp"

namespace verisim::ruler {

/// A closed surface of triangles, with a tree of boxes over them.
class Triangles {
 public:
  /// @pre each index is below the number of vertices
  Triangles(std::vector<Vector3d> vertices, std::vector<std::array<std::uint32_t, 3>> triangles);

  static constexpr double kTouch = 1e-12;  ///< m

  struct Nearest {
    double distance;
    std::uint32_t triangle;
  };
  [[nodiscard]] Nearest nearest(const Vector3d& x) const;  ///< @pre there is a triangle
  /// Of three rays in fixed odd directions, do most cross the surface an odd number of times?
  [[nodiscard]] bool is_inside(const Vector3d& x) const;
  [[nodiscard]] double distance(const Vector3d& x, std::uint32_t triangle) const;
  /// Does one of them meet this one? Those that are nearer than kTouch may count as if they did; none that does is
  /// missed.
  [[nodiscard]] bool meets(const std::array<Vector3d, 3>& corners) const;
  [[nodiscard]] std::size_t size() const { return triangles_.size(); }
  [[nodiscard]] std::array<Vector3d, 3> corners(std::uint32_t triangle) const;
  /// `act(triangle)` of every triangle, but those of whose balls `skip(middle, radius)` says to leave them out.
  template <typename Skip, typename Act>
  void each(const Skip& skip, const Act& act, std::uint32_t box = 0) const {
    const Box& here = boxes_[box];
    if (skip(here.bounds.center(), 0.5 * here.bounds.diagonal().norm())) return;
    for (std::uint32_t i = 0; i < here.count; ++i) act(order_[here.first + i]);
    if (here.count > 0) return;
    each(skip, act, here.first);
    each(skip, act, here.first + 1);
  }
  [[nodiscard]] const Eigen::AlignedBox3d& bounds() const { return boxes_.front().bounds; }

 private:
  /// A leaf has `count` triangles from `first` in order_; another node its children at `first` and first + 1.
  struct Box {
    Eigen::AlignedBox3d bounds;
    std::uint32_t first = 0, count = 0;
  };
  void divide(std::uint32_t box, std::uint32_t begin, std::uint32_t end);
  [[nodiscard]] bool crosses_oddly(const Vector3d& x, const Vector3d& direction) const;

  std::vector<Vector3d> vertices_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::vector<std::uint32_t> order_;
  std::vector<Box> boxes_;
};

/// Of a's triangles, placed by X_BA, in b. `place` is in b's coordinates. 10 us for each piece of a small mesh.
[[nodiscard]] Depth depth_in(const Triangles& a, const Pose& X_BA, const Triangles& b, const Accuracy& accuracy);

}  // namespace verisim::ruler
