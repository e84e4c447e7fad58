#include "engine/ruler/solid_depth.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <queue>
#include <vector>

#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"
#include "engine/ruler/polygon.hpp"

namespace verisim::ruler {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// m, within which a point counts as on a surface: far above roundings (1e-16 of a scene of metres), far below what is
/// measured.
constexpr double kOnSurface = 1e-11;
constexpr std::uint32_t kNone = static_cast<std::uint32_t>(-1);

/// The values of a solid's dividers at a point.
class Values {
 public:
  explicit Values(const Csg& csg) : csg_(csg), values_(csg.dividers().size()) {}
  void at(const Vector3d& x) {
    for (std::size_t i = 0; i < values_.size(); ++i) values_[i] = value_at(csg_.dividers()[i], x);
  }
  double& operator[](std::size_t i) { return values_[i]; }
  [[nodiscard]] std::size_t size() const { return values_.size(); }
  [[nodiscard]] double tree() const { return csg_.value(values_); }
  /// The tree with one divider on a side of our choice.
  [[nodiscard]] double tree_with(std::size_t divider, double value) {
    const double kept = values_[divider];
    values_[divider] = value;
    const double result = tree();
    values_[divider] = kept;
    return result;
  }

 private:
  const Csg& csg_;
  std::vector<double> values_;
};

/// The side of a divider on which nothing of the solid is near: +1 where the divider's values are above 0, -1 where
/// they are below, 0: there is none. `margin` [m]: the solid is farther off than that, on that side.
///
/// A point x within the solid can then be no deeper than its distance |g(x)| to the divider if |g(x)| and what x is
/// away from here are together less than the margin: the straight way to the divider and a step further leads out of
/// the solid, and so through its surface.
struct OutSide {
  double sign = 0, margin = 0;
};

/// Looks no further once there is as much margin as is wanted.
OutSide out_side_of(Values& values, std::size_t divider, double wanted) {
  const double below = values.tree_with(divider, -kInfinity), above = values.tree_with(divider, kInfinity);
  OutSide out = above >= below ? OutSide{1, above} : OutSide{-1, below};
  if (out.margin < 0) return {};
  // Where another divider bounds two primitives (a hole as deep as its block is high) the tree is 0 on it, though both
  // of its sides are outside.
  const double kept = values[divider];
  values[divider] = out.sign * kInfinity;
  for (std::size_t i = 0; i < values.size() && out.margin < wanted; ++i) {
    if (i == divider || std::abs(values[i]) != out.margin) continue;  // not the one that decides
    out.margin = std::max(out.margin, std::min(values.tree_with(i, -kInfinity), values.tree_with(i, kInfinity)));
  }
  values[divider] = kept;
  return out;
}

// --- depth of a point -----------------------------------------------------------------------------------------------

class PointDepth {
 public:
  explicit PointDepth(const Csg& csg) : csg_(csg), values_(csg), there_(csg) {}

  double operator()(const Vector3d& x) {
    values_.at(x);
    const double tree = values_.tree();
    if (tree >= 0 && !is_between_touching()) return 0;
    least_ = kInfinity;
    near_.clear();
    order_.clear();
    for (std::uint32_t i = 0; i < values_.size(); ++i) order_.push_back({std::abs(values_[i]), i});
    std::sort(order_.begin(), order_.end());
    for (const auto& [distance, i] : order_) {
      if (distance >= least_) break;
      if (is_own({{i}}, 1, foot(x, {{i}}, 1)))
        least_ = distance;
      else
        near_.push_back(i);
    }
    edges_and_corners(x);
    return std::isinf(least_) ? std::max(0.0, -tree) : least_;
  }

 private:
  using Set = std::array<std::uint32_t, 3>;
  static constexpr std::size_t kNearMax = 8;

  /// On a surface where two primitives of the solid touch the tree's value is 0; the solid goes on on both sides.
  bool is_between_touching() {
    for (std::size_t i = 0; i < values_.size(); ++i) {
      if (std::abs(values_[i]) > kOnSurface) continue;
      if (values_.tree_with(i, -kInfinity) < 0 && values_.tree_with(i, kInfinity) < 0) return true;
    }
    return false;
  }

  /// A point near x on all of the first n dividers of the set: Newton, each step the shortest one.
  Vector3d foot(const Vector3d& x, const Set& set, std::size_t n) const {
    Vector3d y = x;
    for (int step = 0; step < 8; ++step) {
      Eigen::Matrix<double, Eigen::Dynamic, 3, 0, 3, 3> J(static_cast<Eigen::Index>(n), 3);
      Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1> g(static_cast<Eigen::Index>(n));
      for (std::size_t k = 0; k < n; ++k) {
        const Local local = local_at(csg_.dividers()[set[k]], y);
        J.row(static_cast<Eigen::Index>(k)) = local.gradient.transpose();
        g(static_cast<Eigen::Index>(k)) = local.value;
      }
      if (g.cwiseAbs().maxCoeff() < 1e-15) break;
      const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3> JJ = J * J.transpose();
      if (std::abs(JJ.determinant()) < 1e-12) return Vector3d::Constant(kInfinity);  // surfaces that never cross here
      const Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1> lambda = JJ.inverse() * g;
      y -= J.transpose() * lambda;
    }
    return y;
  }

  /// Is y, on the first n of the set, a point of the solid's surface? Not if all of these dividers' sides are inside.
  bool is_own(const Set& set, std::size_t n, const Vector3d& y) {
    if (!y.allFinite()) return false;
    there_.at(y);
    bool some_in = false, some_out = false;
    for (std::size_t sides = 0; sides < (std::size_t{1} << n); ++sides) {
      for (std::size_t k = 0; k < n; ++k) {
        if (std::abs(there_[set[k]]) > kOnSurface && sides == 0) return false;
        there_[set[k]] = (sides >> k & 1) != 0 ? kInfinity : -kInfinity;
      }
      const double tree = there_.tree();
      some_in = some_in || tree <= kOnSurface;
      some_out = some_out || tree >= -kOnSurface;
    }
    return some_in && some_out;
  }

  void edges_and_corners(const Vector3d& x) {
    // Every divider nearer than the least so far that has no foot of its own can have an edge or a corner.
    const std::size_t n = std::min(near_.size(), kNearMax);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < values_.size(); ++j) {
        const auto second = static_cast<std::uint32_t>(j);
        if (second == near_[i] || std::abs(values_[j]) >= least_) continue;
        meet(x, {near_[i], second}, 2);
        for (std::size_t k = j + 1; k < values_.size(); ++k)
          if (k != near_[i] && std::abs(values_[k]) < least_)
            meet(x, {near_[i], second, static_cast<std::uint32_t>(k)}, 3);
      }
  }
  void meet(const Vector3d& x, const Set& set, std::size_t n) {
    const Vector3d y = foot(x, set, n);
    const double distance = (y - x).norm();
    if (distance < least_ && is_own(set, n, y)) least_ = distance;
  }

  const Csg& csg_;
  Values values_, there_;
  std::vector<std::pair<double, std::uint32_t>> order_;
  std::vector<std::uint32_t> near_;
  double least_ = kInfinity;
};

// --- pieces of a surface --------------------------------------------------------------------------------------------

struct Piece {
  std::uint32_t face = 0;
  double u = 0, v = 0, half_u = 0, half_v = 0;  ///< middle and half sizes of its parameters
  double limit = 0;                             ///< no point of it is deeper
  std::uint32_t number = 0;
  bool operator<(const Piece& other) const {  // the deepest first; of equals the older one
    return limit != other.limit ? limit < other.limit : number > other.number;
  }
};

/// A piece as p(s, t), s and t in [-1, 1], to second order: middle + s a + t b + (s^2 aa + 2 s t ab + t^2 bb) / 2.
/// Along any straight way from the middle to a point of the square, over a parameter from 0 to 1, no derivative is
/// longer than `first`, `second` and `third` [m].
struct Patch {
  Vector3d middle, a, b;
  Vector3d aa = Vector3d::Zero(), ab = Vector3d::Zero(), bb = Vector3d::Zero();
  double first = 0, second = 0, third = 0;
  [[nodiscard]] double radius() const { return first; }
  [[nodiscard]] double bent() const { return 0.5 * second; }
};

Patch patch_of(const Csg& solid, const Piece& piece) {
  const Face& face = solid.faces()[piece.face];
  const Divider& d = solid.dividers()[face.divider];
  const double u = piece.u, v = piece.v, hu = piece.half_u, hv = piece.half_v;
  if (d.kind == Divider::Kind::plane)
    return {.middle = face.origin + u * face.x + v * face.y,
            .a = hu * face.x,
            .b = hv * face.y,
            .first = std::hypot(hu, hv)};
  const Vector3d out = pinned::cos(u) * face.x + pinned::sin(u) * face.y;
  const Vector3d on = pinned::cos(u) * face.y - pinned::sin(u) * face.x;
  const double r = d.radius;
  switch (d.kind) {
    case Divider::Kind::cylinder:
      return {.middle = face.origin + r * out + v * face.z,
              .a = hu * r * on,
              .b = hv * face.z,
              .aa = -r * hu * hu * out,
              .first = std::hypot(r * hu, hv),
              .second = r * hu * hu,
              .third = r * hu * hu * hu};
    case Divider::Kind::cone: {
      const double far = (v + hv) * d.sine;  // m, largest radius
      const Vector3d along = d.sine * out + d.cosine * face.z;
      return {.middle = face.origin + v * along,
              .a = hu * v * d.sine * on,
              .b = hv * along,
              .aa = -v * d.sine * hu * hu * out,
              .ab = hu * hv * d.sine * on,
              .first = std::hypot(far * hu, hv),
              .second = 2 * hv * hu * d.sine + far * hu * hu,
              .third = 3 * hv * hu * hu * d.sine + far * hu * hu * hu};
    }
    default: {
      const double c = pinned::cos(v), s = pinned::sin(v);
      const double c_max = std::min(1.0, c + hv), s_max = std::min(1.0, std::abs(s) + hv);
      const Vector3d normal = c * out + s * face.z;
      return {.middle = face.origin + r * normal,
              .a = hu * r * c * on,
              .b = hv * r * (c * face.z - s * out),
              .aa = -r * c * hu * hu * out,
              .ab = -r * s * hu * hv * on,
              .bb = -r * hv * hv * normal,
              .first = r * std::hypot(c_max * hu, hv),
              .second = r * (c_max * hu * hu + 2 * s_max * hu * hv + hv * hv),
              .third = r * (c_max * hu * hu * hu + 3 * s_max * hu * hu * hv + 3 * c_max * hu * hv * hv + hv * hv * hv)};
    }
  }
}

/// A divider's value on a patch, times a sign: no more than linear + above, no less than linear - below.
struct Model {
  Linear linear;
  double above = 0, below = 0;
};

Model model_of(const Divider& divider, const Patch& patch, double sign) {
  const Local local = local_at(divider, patch.middle);
  Model model{{sign * local.value, sign * local.gradient.dot(patch.a), sign * local.gradient.dot(patch.b)}};
  const bool is_plane = divider.kind == Divider::Kind::plane;
  const double wide = is_plane ? 0 : across(divider, patch.a) + across(divider, patch.b) + patch.bent();
  // Value and linear model each change by no more than the way.
  model.above = model.below = 2 * patch.first;
  const double least_radius = local.bend_radius - wide;
  if (least_radius <= 0) return model;
  const double second = (is_plane ? 0 : 0.5 * wide * wide / least_radius) + patch.bent();
  model.above = model.below = std::min(model.above, second);
  // The second derivatives as they are, and a bound of the third along any way p from the middle, by the chain rule:
  // D3g(p', p', p') + 3 D2g(p', p'') + Dg(p''').
  const auto twice = [&](const Vector3d& a, const Vector3d& b, const Vector3d& ab) {
    return sign * (local.gradient.dot(ab) + bend(divider, patch.middle, local, a, b));
  };
  const double aa = twice(patch.a, patch.a, patch.aa), ab = twice(patch.a, patch.b, patch.ab),
               bb = twice(patch.b, patch.b, patch.bb);
  const double speed = is_plane ? 0 : wide + patch.bent();  // of p across the axis, at most
  const double ways = is_plane ? 0 : speed / least_radius;
  const double third = (1.1548 * ways * ways * speed + 3 * ways * patch.second + patch.third) / 6;
  model.above = std::min(model.above, 0.5 * std::max(0.0, aa) + 0.5 * std::max(0.0, bb) + std::abs(ab) + third);
  model.below = std::min(model.below, 0.5 * std::max(0.0, -aa) + 0.5 * std::max(0.0, -bb) + std::abs(ab) + third);
  return model;
}

// --- the search -----------------------------------------------------------------------------------------------------

class Search {
 public:
  Search(const Csg& a, const Csg& b, const Accuracy& accuracy)
      : a_(a), b_(b), accuracy_(accuracy), values_a_(a), values_b_(b), point_depth_(b) {}

  Depth run() {
    for (std::uint32_t i = 0; i < a_.faces().size(); ++i) {
      const Face& f = a_.faces()[i];
      Piece piece{i,
                  0.5 * (f.u_low + f.u_high),
                  0.5 * (f.v_low + f.v_high),
                  0.5 * (f.u_high - f.u_low),
                  0.5 * (f.v_high - f.v_low),
                  kInfinity,
                  0};
      look(piece);
      add(piece);
    }
    while (!waiting_.empty() && waiting_.top().limit > enough() && found_.pieces < accuracy_.pieces_max) {
      const Piece piece = waiting_.top();
      waiting_.pop();
      split(piece);
    }
    if (!waiting_.empty()) dropped_ = std::max(dropped_, waiting_.top().limit);
    found_.bound = std::max(0.0, dropped_ - found_.depth);
    return found_;
  }

 private:
  double enough() const { return found_.depth + std::max(accuracy_.absolute, accuracy_.relative * found_.depth); }

  /// The longer way, unless the other one, tried, leaves clearly less to search.
  void split(const Piece& piece) {
    const Patch patch = patch_of(a_, piece);
    const auto by_u = halves(piece, true), by_v = halves(piece, false);
    const auto gain = [&](const std::array<Piece, 2>& pair) {
      return 2 * piece.limit - std::max(pair[0].limit, enough()) - std::max(pair[1].limit, enough());
    };
    const double gain_u = gain(by_u), gain_v = gain(by_v), clear = 0.2 * (piece.limit - enough());
    const bool is_longer_u = patch.a.squaredNorm() >= patch.b.squaredNorm();
    const bool split_u = is_longer_u ? !(gain_v > clear && gain_v > 2 * gain_u) : gain_u > clear && gain_u > 2 * gain_v;
    for (const Piece& half : split_u ? by_u : by_v) add(half);
  }
  std::array<Piece, 2> halves(const Piece& piece, bool of_u) {
    std::array<Piece, 2> both = {piece, piece};
    for (std::size_t i = 0; i < 2; ++i) {
      const double half = 0.5 * (of_u ? piece.half_u : piece.half_v);
      (of_u ? both[i].half_u : both[i].half_v) = half;
      (of_u ? both[i].u : both[i].v) += i == 0 ? -half : half;
      look(both[i]);
    }
    return both;
  }

  void look(Piece& piece) {
    piece.number = ++found_.pieces;
    piece.limit = std::min(piece.limit, limit_of(piece));
  }
  void add(const Piece& piece) {
    if (piece.limit > enough())
      waiting_.push(piece);
    else
      dropped_ = std::max(dropped_, piece.limit);
  }

  /// No point of the piece that belongs to A's surface is deeper in B. Looks at a point or two of it, too.
  double limit_of(const Piece& piece) {
    const Patch patch = patch_of(a_, piece);
    const double radius = patch.radius();
    values_b_.at(patch.middle);
    const double tree_b = values_b_.tree();
    if (tree_b >= radius) return 0;

    const std::uint32_t own = a_.faces()[piece.face].divider;
    values_a_.at(patch.middle);
    if (away_from_surface(own) > radius) return 0;

    Polygon proven, likely;
    cut_by_own(own, patch, radius, proven, likely);
    cut_by_other(patch, radius, proven, likely);
    if (proven.is_empty()) return 0;
    double limit = tree_b > 0 ? radius - tree_b : kInfinity;
    limit = std::min(limit, limit_by_faces(patch, radius, proven));
    if (limit > enough() && !likely.is_empty()) look_at(own, patch, likely);
    return limit;
  }

  /// m, to A's surface at least, from a point of the divider `own`: both sides of it are inside, or both outside.
  double away_from_surface(std::uint32_t own) {
    const double below = values_a_.tree_with(own, -kInfinity), above = values_a_.tree_with(own, kInfinity);
    return std::max(std::min(below, above), -std::max(below, above));
  }

  /// What A's other surfaces leave of the patch: `proven` at least that, `likely` about that.
  void cut_by_own(std::uint32_t own, const Patch& patch, double radius, Polygon& proven, Polygon& likely) {
    cutting_.clear();
    for (std::uint32_t i = 0; i < values_a_.size() && !proven.is_empty(); ++i) {
      const double value = values_a_[i];
      if (i == own || std::abs(value) > radius) continue;
      for (const double side : {1.0, -1.0}) {
        // With this divider on that side nothing of the patch is A's surface: so what is, is on the other side.
        values_a_[i] = side * kInfinity;
        const double away = away_from_surface(own);
        values_a_[i] = value;
        if (away <= radius) continue;
        keep_below(model_of(a_.dividers()[i], patch, side), proven, likely);
        cutting_.push_back(i);
        break;
      }
    }
  }
  /// What B's surfaces leave of the patch that can be within B.
  void cut_by_other(const Patch& patch, double radius, Polygon& proven, Polygon& likely) {
    for (std::uint32_t i = 0; i < values_b_.size() && !proven.is_empty(); ++i) {
      if (std::abs(values_b_[i]) > radius) continue;
      const OutSide out = out_side_of(values_b_, i, 2 * radius);
      if (out.margin > radius) keep_below(model_of(b_.dividers()[i], patch, out.sign), proven, likely);
    }
  }
  static void keep_below(const Model& model, Polygon& proven, Polygon& likely) {
    Linear linear = model.linear;
    likely.keep_below(linear);
    linear.at -= model.below;
    proven.keep_below(linear);
  }

  double limit_by_faces(const Patch& patch, double radius, const Polygon& proven) {
    depths_.clear();
    uncertain_.clear();
    double limit = kInfinity;
    for (std::uint32_t i = 0; i < values_b_.size(); ++i) {
      const double distance = std::abs(values_b_[i]);
      if (distance > limit + 2 * radius) continue;
      const OutSide out = out_side_of(values_b_, i, distance + 2 * radius);
      if (out.margin >= distance) limit = std::min(limit, distance + radius);
      if (out.margin < distance + 2 * radius) {
        if (distance < limit && uncertain_.size() < kUncertainMax) uncertain_.push_back(i);
        continue;
      }
      Model model = model_of(b_.dividers()[i], patch, -out.sign);
      model.linear.at += model.above;
      limit = std::min(limit, largest(model.linear, proven));
      depths_.push_back(model.linear);
    }
    for (std::size_t i = 0; i < uncertain_.size(); ++i)
      for (std::size_t j = i + 1; j < uncertain_.size(); ++j)
        limit = std::min(limit, limit_by_edge(uncertain_[i], uncertain_[j], patch, radius, proven));
    std::sort(depths_.begin(), depths_.end(), [](const Linear& f, const Linear& g) { return f.at < g.at; });
    const std::size_t n = std::min<std::size_t>(depths_.size(), 3);
    for (std::size_t i = 0; i < n && limit > enough(); ++i)
      for (std::size_t j = i + 1; j < n; ++j)
        limit = std::min(limit, largest_of_lesser(depths_[i], depths_[j], proven));
    return limit;
  }

  /// The same by an edge in which two dividers meet at a right angle, along all of it: planes, or a plane across a
  /// cylinder. Its distance is sqrt(g^2 + h^2). One of the four quarters around it has to be outside, with margin.
  double limit_by_edge(std::uint32_t i, std::uint32_t j, const Patch& patch, double radius, const Polygon& proven) {
    const Divider& g = b_.dividers()[i];
    const Divider& h = b_.dividers()[j];
    const auto is_plane = [](const Divider& d) { return d.kind == Divider::Kind::plane; };
    const auto is_cylinder = [](const Divider& d) { return d.kind == Divider::Kind::cylinder; };
    constexpr double kSquare = 1e-9;
    const bool square = (is_plane(g) && is_plane(h) && std::abs(g.axis.dot(h.axis)) < kSquare) ||
                        (is_plane(g) && is_cylinder(h) && g.axis.cross(h.axis).norm() < kSquare) ||
                        (is_cylinder(g) && is_plane(h) && g.axis.cross(h.axis).norm() < kSquare);
    if (!square) return kInfinity;
    const double at_g = values_b_[i], at_h = values_b_[j];
    double margin = -kInfinity;
    for (const double side : {-kInfinity, kInfinity}) {
      values_b_[i] = side;
      for (const double other : {-kInfinity, kInfinity}) margin = std::max(margin, values_b_.tree_with(j, other));
    }
    values_b_[i] = at_g;
    const double distance = std::hypot(at_g, at_h);
    if (margin < distance + 2 * radius) return margin >= distance ? distance + radius : kInfinity;
    const auto farthest = [&](const Divider& d) {
      double most = 0;
      for (const double sign : {-1.0, 1.0}) {
        const Model model = model_of(d, patch, sign);
        most = std::max(most, largest(model.linear, proven) + model.above);
      }
      return most;
    };
    return std::min(distance + radius, std::hypot(farthest(g), farthest(h)) * (1 + kSquare));
  }

  /// Tries the places of the patch that its linear models take for the deepest.
  void look_at(std::uint32_t own, const Patch& patch, const Polygon& likely) {
    const auto least = [&](const Eigen::Vector2d& p) {
      double value = kInfinity;
      for (const Linear& f : depths_) value = std::min(value, f(p));
      return value;
    };
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();
    for (const Eigen::Vector2d& corner : likely.corners()) middle += corner;
    middle /= static_cast<double>(likely.corners().size());
    Eigen::Vector2d best = middle;
    for (const Eigen::Vector2d& corner : likely.corners())
      if (least(corner) > least(best)) best = corner;
    try_at(own, patch, best);
    if (depths_.empty()) {
      for (const Eigen::Vector2d& corner : likely.corners()) try_at(own, patch, corner);
    } else if (depths_.size() > 1) {  // on the way to the middle two depths may become equal
      for (int i = 0; i < 24; ++i) {
        const Eigen::Vector2d half = 0.5 * (best + middle);
        if (least(half) >= least(best))
          best = half;
        else
          middle = half;
      }
      try_at(own, patch, best);
    }
  }

  void try_at(std::uint32_t own, const Patch& patch, const Eigen::Vector2d& p) {
    const Vector3d x = onto_surface(own, patch.middle + p.x() * patch.a + p.y() * patch.b);
    values_a_.at(x);
    if (!(std::abs(values_a_[own]) <= kOnSurface)) return;
    if (away_from_surface(own) > kOnSurface) return;
    const double depth = point_depth_(x);
    if (depth > found_.depth) {
      found_.depth = depth;
      found_.place = x;
    }
  }

  /// On the patch's own surface, and on those that cut it and which x has crossed.
  Vector3d onto_surface(std::uint32_t own, Vector3d x) const {
    for (int step = 0; step < 4; ++step) {
      for (const std::uint32_t i : cutting_) {
        const Local local = local_at(a_.dividers()[i], x);
        if (std::abs(local.value) > 1e-6) continue;
        // Along the own surface, so that both are met at once.
        const Vector3d n = local_at(a_.dividers()[own], x).gradient;
        const Vector3d along = local.gradient - n.dot(local.gradient) * n;
        if (along.squaredNorm() > 1e-6) x -= local.value / along.squaredNorm() * along;
      }
      const Local local = local_at(a_.dividers()[own], x);
      x -= local.value * local.gradient;
    }
    return x;
  }

  const Csg& a_;
  const Csg& b_;
  const Accuracy& accuracy_;
  Values values_a_, values_b_;
  PointDepth point_depth_;
  std::priority_queue<Piece> waiting_;
  std::vector<std::uint32_t> cutting_;
  static constexpr std::size_t kUncertainMax = 6;
  std::vector<Linear> depths_;            ///< bounds of the last patch's depth
  std::vector<std::uint32_t> uncertain_;  ///< dividers of b near it that may not be b's surface there
  Depth found_;
  double dropped_ = 0;
};

}  // namespace

Depth depth_in(const Csg& a, const Csg& b, const Accuracy& accuracy) {
  return Search(a, b, accuracy).run();
}

double depth_of(const Vector3d& x, const Csg& b) {
  return PointDepth(b)(x);
}

}  // namespace verisim::ruler
