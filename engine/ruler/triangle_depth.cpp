#include "engine/ruler/triangle_depth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "engine/base/error.hpp"
#include "engine/ruler/best_first.hpp"

namespace verisim::ruler {
namespace {

constexpr double kFarAway = std::numeric_limits<double>::infinity();
constexpr std::uint32_t kLeafMax = 4;

double squared_to_segment(const Vector3d& x, const Vector3d& a, const Vector3d& b) {
  const Vector3d along = b - a;
  const double length2 = along.squaredNorm();
  const double t = length2 > 0 ? std::clamp((x - a).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (x - a - t * along).squaredNorm();
}

double distance_to_triangle(const Vector3d& x, const std::array<Vector3d, 3>& c) {
  const Vector3d n = (c[1] - c[0]).cross(c[2] - c[0]);
  const double area2 = n.squaredNorm();
  bool over = area2 > 0;  // x stands over the triangle
  for (std::size_t i = 0; i < 3 && over; ++i) over = n.cross(c[(i + 1) % 3] - c[i]).dot(x - c[i]) >= 0;
  if (over) return std::abs(n.dot(x - c[0])) / std::sqrt(area2);
  return std::sqrt(std::min(
      {squared_to_segment(x, c[0], c[1]), squared_to_segment(x, c[1], c[2]), squared_to_segment(x, c[2], c[0])}));
}

/// Does the ray from x meet the triangle? (Möller and Trumbore 1997)
bool crosses(const Vector3d& x, const Vector3d& d, const std::array<Vector3d, 3>& c) {
  const Vector3d e1 = c[1] - c[0], e2 = c[2] - c[0], p = d.cross(e2);
  const double det = e1.dot(p);
  if (det == 0) return false;
  const Vector3d s = x - c[0], q = s.cross(e1);
  const double u = s.dot(p) / det, v = d.dot(q) / det;
  return u >= 0 && v >= 0 && u + v <= 1 && e2.dot(q) / det > 0;
}

bool ray_meets(const Vector3d& x, const Vector3d& d, const Eigen::AlignedBox3d& box) {
  double from = 0, to = kFarAway;
  for (int k = 0; k < 3; ++k) {
    const double a = (box.min()[k] - x[k]) / d[k], b = (box.max()[k] - x[k]) / d[k];
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  }
  return from <= to * (1 + 1e-12) + 1e-15;
}

/// Is there a direction in which they are more than `gap` apart? Tried are those that decide for two triangles: both
/// normals, and across a side of each; for those in one plane across their sides within it.
bool are_triangles_apart(const std::array<Vector3d, 3>& a, const std::array<Vector3d, 3>& b, double gap) {
  const auto is_apart_along = [&](const Vector3d& axis) {
    const double length = axis.norm();
    if (length == 0) return false;
    const double a0 = axis.dot(a[0]), a1 = axis.dot(a[1]), a2 = axis.dot(a[2]);
    const double b0 = axis.dot(b[0]), b1 = axis.dot(b[1]), b2 = axis.dot(b[2]);
    return std::min({a0, a1, a2}) - std::max({b0, b1, b2}) > gap * length ||
           std::min({b0, b1, b2}) - std::max({a0, a1, a2}) > gap * length;
  };
  const std::array<Vector3d, 3> of_a = {a[1] - a[0], a[2] - a[1], a[0] - a[2]};
  const std::array<Vector3d, 3> of_b = {b[1] - b[0], b[2] - b[1], b[0] - b[2]};
  const Vector3d normal_a = of_a[0].cross(of_a[1]), normal_b = of_b[0].cross(of_b[1]);
  if (is_apart_along(normal_a) || is_apart_along(normal_b)) return true;
  for (const Vector3d& e : of_a)
    for (const Vector3d& f : of_b)
      if (is_apart_along(e.cross(f))) return true;
  for (std::size_t i = 0; i < 3; ++i)
    if (is_apart_along(normal_a.cross(of_a[i])) || is_apart_along(normal_b.cross(of_b[i]))) return true;
  return false;
}

/// A piece of a triangle of A, in B's coordinates.
struct TrianglePiece {
  std::array<Vector3d, 3> corners;
  double limit = kFarAway;
  std::uint32_t number = 0;
  bool operator<(const TrianglePiece& other) const {  // the deepest first; of equals the older one
    return limit != other.limit ? limit < other.limit : number > other.number;
  }
};

class TriangleSearch {
 public:
  TriangleSearch(const Triangles& b, const Accuracy& accuracy) : b_(b), search_(accuracy) {}

  Depth run(const Triangles& a, const Pose& X_BA) {
    const auto is_outside = [&](const Vector3d& middle, double radius) {
      const Vector3d x = X_BA * middle;
      if (b_.bounds().squaredExteriorDistance(x) > radius * radius) return true;
      return b_.nearest(x).distance > radius && !b_.is_inside(x);
    };
    const auto add_triangle = [&](std::uint32_t i) {
      TrianglePiece piece{a.corners(i)};
      Eigen::AlignedBox3d box;
      for (Vector3d& corner : piece.corners) box.extend(corner = X_BA * corner);
      if (box.intersects(b_.bounds())) add(piece);
    };
    a.each(is_outside, add_triangle);
    return search_.run([&](const TrianglePiece& piece) { split(piece); });
  }

 private:
  void split(const TrianglePiece& piece) {
    std::size_t longest = 0;
    const auto side = [&](std::size_t i) { return (piece.corners[(i + 1) % 3] - piece.corners[i]).squaredNorm(); };
    for (std::size_t i = 1; i < 3; ++i)
      if (side(i) > side(longest)) longest = i;
    const std::size_t next = (longest + 1) % 3;
    const Vector3d middle = 0.5 * (piece.corners[longest] + piece.corners[next]);
    for (const std::size_t moved : {longest, next}) {
      TrianglePiece half = piece;
      half.corners[moved] = middle;
      add(half);
    }
  }

  void add(TrianglePiece piece) {
    piece.number = search_.next_number();
    piece.limit = std::min(piece.limit, limit_of(piece));
    search_.add(piece);
  }

  double limit_of(const TrianglePiece& piece) {
    const auto& c = piece.corners;
    const Vector3d middle = (c[0] + c[1] + c[2]) / 3;
    const double radius = std::sqrt(
        std::max({(c[0] - middle).squaredNorm(), (c[1] - middle).squaredNorm(), (c[2] - middle).squaredNorm()}));
    const Triangles::Nearest near = b_.nearest(middle);
    const bool is_inside = b_.is_inside(middle);
    double limit = is_inside ? near.distance + radius : radius - near.distance;
    if (limit <= search_.enough()) return std::max(0.0, limit);
    if (!is_inside && !b_.meets(c)) return 0;
    for (const Vector3d& x : {c[0], c[1], c[2], middle}) {
      const Triangles::Nearest there = b_.nearest(x);
      if (there.distance > search_.depth() && b_.is_inside(x)) search_.found(there.distance, x);
      const double farthest = std::max(
          {b_.distance(c[0], there.triangle), b_.distance(c[1], there.triangle), b_.distance(c[2], there.triangle)});
      limit = std::min(limit, farthest);
    }
    return limit;
  }

  const Triangles& b_;
  BestFirst<TrianglePiece> search_;
};

}  // namespace

Triangles::Triangles(std::vector<Vector3d> vertices, std::vector<std::array<std::uint32_t, 3>> triangles)
    : vertices_(std::move(vertices)), triangles_(std::move(triangles)), order_(triangles_.size()), boxes_(1) {
  for (const auto& triangle : triangles_)
    for (const std::uint32_t index : triangle) VERISIM_ASSERT(index < vertices_.size());
  std::iota(order_.begin(), order_.end(), 0U);
  divide(0, 0, static_cast<std::uint32_t>(order_.size()));
}

void Triangles::divide(std::uint32_t box, std::uint32_t begin, std::uint32_t end) {
  Eigen::AlignedBox3d bounds, middles;
  const auto middle = [&](std::uint32_t triangle) {
    const auto c = corners(triangle);
    return Vector3d(c[0] + c[1] + c[2]);
  };
  for (std::uint32_t i = begin; i < end; ++i) {
    for (const Vector3d& corner : corners(order_[i])) bounds.extend(corner);
    middles.extend(middle(order_[i]));
  }
  boxes_[box] = {bounds, begin, end - begin};
  if (end - begin <= kLeafMax) return;
  Eigen::Index axis = 0;
  middles.sizes().maxCoeff(&axis);
  std::sort(order_.begin() + begin, order_.begin() + end, [&](std::uint32_t a, std::uint32_t b) {
    const double at_a = middle(a)[axis], at_b = middle(b)[axis];
    return at_a != at_b ? at_a < at_b : a < b;
  });
  const std::uint32_t half = begin + (end - begin) / 2;
  const auto children = static_cast<std::uint32_t>(boxes_.size());
  boxes_.resize(boxes_.size() + 2);
  boxes_[box].first = children;
  boxes_[box].count = 0;
  divide(children, begin, half);
  divide(children + 1, half, end);
}

std::array<Vector3d, 3> Triangles::corners(std::uint32_t triangle) const {
  const auto& [a, b, c] = triangles_[triangle];
  return {vertices_[a], vertices_[b], vertices_[c]};
}

double Triangles::distance(const Vector3d& x, std::uint32_t triangle) const {
  return distance_to_triangle(x, corners(triangle));
}

Triangles::Nearest Triangles::nearest(const Vector3d& x) const {
  VERISIM_ASSERT(!triangles_.empty());
  Nearest best{kFarAway, 0};
  std::array<std::pair<double, std::uint32_t>, 128> open;  // deeper than any tree of 2^32 triangles needs
  std::size_t n = 0;
  open[n++] = {boxes_.front().bounds.squaredExteriorDistance(x), 0};
  while (n > 0) {
    const auto [squared, index] = open[--n];
    if (squared >= best.distance * best.distance) continue;
    const Box& box = boxes_[index];
    if (box.count > 0) {
      for (std::uint32_t i = box.first; i < box.first + box.count; ++i) {
        const double d = distance(x, order_[i]);
        if (d < best.distance) best = {d, order_[i]};
      }
      continue;
    }
    const double left = boxes_[box.first].bounds.squaredExteriorDistance(x);
    const double right = boxes_[box.first + 1].bounds.squaredExteriorDistance(x);
    const bool left_first = left <= right;  // the one pushed last is looked at first
    open[n++] = left_first ? std::pair{right, box.first + 1} : std::pair{left, box.first};
    open[n++] = left_first ? std::pair{left, box.first} : std::pair{right, box.first + 1};
  }
  return best;
}

bool Triangles::meets(const std::array<Vector3d, 3>& corners_of_one) const {
  Eigen::AlignedBox3d reach;
  for (const Vector3d& corner : corners_of_one) reach.extend(corner);
  reach.min().array() -= kTouch;
  reach.max().array() += kTouch;
  std::array<std::uint32_t, 128> open;
  std::size_t n = 0;
  open[n++] = 0;
  while (n > 0) {
    const Box& box = boxes_[open[--n]];
    if (!box.bounds.intersects(reach)) continue;
    if (box.count == 0) {
      open[n++] = box.first;
      open[n++] = box.first + 1;
      continue;
    }
    for (std::uint32_t i = box.first; i < box.first + box.count; ++i)
      if (!are_triangles_apart(corners(order_[i]), corners_of_one, kTouch)) return true;
  }
  return false;
}

bool Triangles::crosses_oddly(const Vector3d& x, const Vector3d& direction) const {
  bool odd = false;
  std::array<std::uint32_t, 128> open;
  std::size_t n = 0;
  open[n++] = 0;
  while (n > 0) {
    const Box& box = boxes_[open[--n]];
    if (!ray_meets(x, direction, box.bounds)) continue;
    if (box.count == 0) {
      open[n++] = box.first;
      open[n++] = box.first + 1;
      continue;
    }
    for (std::uint32_t i = box.first; i < box.first + box.count; ++i)
      if (crosses(x, direction, corners(order_[i]))) odd = !odd;
  }
  return odd;
}

bool Triangles::is_inside(const Vector3d& x) const {
  if (!bounds().contains(x)) return false;
  const int odd = static_cast<int>(crosses_oddly(x, {0.5377, 0.8339, -0.1259})) +
                  static_cast<int>(crosses_oddly(x, {-0.8622, 0.3188, 0.3077})) +
                  static_cast<int>(crosses_oddly(x, {0.3426, -0.4336, 0.8358}));
  return odd >= 2;
}

Depth depth_in(const Triangles& a, const Pose& X_BA, const Triangles& b, const Accuracy& accuracy) {
  if (a.size() == 0 || b.size() == 0) return {};
  return TriangleSearch(b, accuracy).run(a, X_BA);
}

}  // namespace verisim::ruler
