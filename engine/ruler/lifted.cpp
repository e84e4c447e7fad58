#include "engine/ruler/lifted.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/ruler/foot.hpp"

namespace verisim::ruler {
namespace {

/// Surfaces on which a point lies: at most three are met at once.
using Faces = std::vector<std::uint32_t>;

class Lifter {
 public:
  Lifter(FacedTriangles part, double tolerance) : part_(std::move(part)), tolerance_(tolerance) {}

  Lifted run() {
    for (const std::uint32_t face : part_.face_of_triangle) result_.known += is_known(face);
    lift_corners();
    for (std::size_t i = 0; i < part_.triangles.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) join(faces_of_side(i, k), part_.face_of_triangle[i]);
    while (halve_all()) continue;
    // Over a triangle a function that is 0 at the corners is at most a third more than at the middles of sides.
    result_.off = 4.0 / 3 * tolerance_;
    result_.triangles = std::move(part_);
    return std::move(result_);
  }

 private:
  using Side = std::pair<std::uint32_t, std::uint32_t>;
  static constexpr std::size_t kTrianglesMax = 2'000'000;

  [[nodiscard]] bool is_known(std::uint32_t face) const { return face != kNoFace && part_.faces[face].has_value(); }
  void join(Faces& faces, std::uint32_t face) const {
    if (is_known(face) && std::find(faces.begin(), faces.end(), face) == faces.end()) faces.push_back(face);
  }
  Faces& faces_of_side(std::size_t triangle, std::size_t k) {
    const auto& t = part_.triangles[triangle];
    return sides_[std::minmax(t[k], t[(k + 1) % 3])];
  }

  /// The nearest point on all of these surfaces; x where they do not meet near it.
  [[nodiscard]] Vector3d onto(const Faces& faces, const Vector3d& x, double near) const {
    std::vector<Divider> dividers;
    for (const std::uint32_t face : faces) dividers.push_back(*part_.faces[face]);
    for (std::size_t n = std::min<std::size_t>(dividers.size(), 3); n > 0; --n) {
      Vector3d y = foot(dividers, x, {0, 1, 2}, n);
      if (y.allFinite() && (y - x).norm() <= near) return y;
    }
    return x;
  }

  void lift_corners() {
    std::vector<Faces> faces(part_.vertices.size());
    std::vector<double> shortest(part_.vertices.size(), kInfinity);
    for (std::size_t i = 0; i < part_.triangles.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = part_.triangles[i][k], b = part_.triangles[i][(k + 1) % 3];
        join(faces[a], part_.face_of_triangle[i]);
        const double length = (part_.vertices[a] - part_.vertices[b]).norm();
        shortest[a] = std::min(shortest[a], length);
        shortest[b] = std::min(shortest[b], length);
      }
    for (std::size_t i = 0; i < faces.size(); ++i) {
      const Vector3d before = part_.vertices[i];
      part_.vertices[i] = onto(faces[i], before, 0.3 * shortest[i]);  // no triangle turns over
      result_.moved = std::max(result_.moved, (part_.vertices[i] - before).norm());
    }
  }

  /// A new corner in the middle of a side, if its middle is far from its surfaces; else kNone.
  std::uint32_t middle_of(const Side& side) {
    const auto [found, is_new] = middles_.try_emplace(side, kNone);
    if (!is_new) return found->second;
    const Faces& faces = sides_.at(side);
    const Vector3d a = part_.vertices[side.first], b = part_.vertices[side.second], middle = 0.5 * (a + b);
    const Vector3d y = onto(faces, middle, (b - a).norm());
    if ((y - middle).norm() <= tolerance_) return kNone;
    found->second = static_cast<std::uint32_t>(part_.vertices.size());
    part_.vertices.push_back(y);
    for (const std::uint32_t end : {side.first, side.second}) sides_[std::minmax(end, found->second)] = faces;
    return found->second;
  }

  /// Halves every side that is too far off, once. False: there was none.
  bool halve_all() {
    middles_.clear();
    FacedTriangles next;
    for (std::size_t i = 0; i < part_.triangles.size(); ++i) halve(i, next);
    const bool is_done = next.triangles.size() == part_.triangles.size();
    if (next.triangles.size() > kTrianglesMax)
      fail(ErrorKind::input, "a part needs more than {} triangles to lie on its surfaces", kTrianglesMax);
    part_.triangles = std::move(next.triangles);
    part_.face_of_triangle = std::move(next.face_of_triangle);
    return !is_done;
  }
  void halve(std::size_t i, FacedTriangles& next) {
    const std::array<std::uint32_t, 3> t = part_.triangles[i];
    const std::uint32_t face = part_.face_of_triangle[i];
    std::array<std::uint32_t, 3> middle{};
    for (std::size_t k = 0; k < 3; ++k) middle[k] = middle_of(std::minmax(t[k], t[(k + 1) % 3]));
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      next.triangles.push_back({a, b, c});
      next.face_of_triangle.push_back(face);
      for (const Side side : {std::minmax(a, b), std::minmax(b, c), std::minmax(c, a)}) {
        Faces& faces = sides_[side];
        if (faces.empty()) join(faces, face);
      }
    };
    const auto count = std::count_if(middle.begin(), middle.end(), [](std::uint32_t m) { return m != kNone; });
    if (count == 0) return add(t[0], t[1], t[2]);
    if (count == 3) {
      for (std::size_t k = 0; k < 3; ++k) add(t[k], middle[k], middle[(k + 2) % 3]);
      return add(middle[0], middle[1], middle[2]);
    }
    // Turned so that the first side is halved, and of two the first and the second.
    std::size_t k = 0;
    while (middle[k] == kNone || (count == 2 && middle[(k + 1) % 3] == kNone)) ++k;
    const std::uint32_t a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3], ab = middle[k], bc = middle[(k + 1) % 3];
    add(a, ab, c);
    if (count == 1) return add(ab, b, c);
    add(ab, b, bc);
    add(ab, bc, c);
  }

  FacedTriangles part_;
  double tolerance_;
  Lifted result_;
  std::map<Side, Faces> sides_;
  std::map<Side, std::uint32_t> middles_;
};

}  // namespace

Lifted lifted(FacedTriangles part, double tolerance) {
  VERISIM_ASSERT(is_positive(tolerance));
  VERISIM_ASSERT(part.face_of_triangle.size() == part.triangles.size());
  for (const std::uint32_t face : part.face_of_triangle) VERISIM_ASSERT(face == kNoFace || face < part.faces.size());
  for (const auto& triangle : part.triangles)
    for (const std::uint32_t index : triangle) VERISIM_ASSERT(index < part.vertices.size());
  return Lifter(std::move(part), tolerance).run();
}

}  // namespace verisim::ruler
