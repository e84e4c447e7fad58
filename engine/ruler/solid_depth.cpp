#include "engine/ruler/solid_depth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "engine/base/error.hpp"
#include "engine/ruler/best_first.hpp"
#include "engine/ruler/patch.hpp"
#include "engine/ruler/point_depth.hpp"
#include "engine/ruler/polygon.hpp"

namespace verisim::ruler {
namespace {

class Search {
 public:
  Search(const Csg& a, const Csg& b, const Accuracy& accuracy)
      : a_(a), b_(b), search_(accuracy), values_a_(a), values_b_(b), point_depth_(b) {}

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
      search_.add(piece);
    }
    return search_.run([&](const Piece& piece) { split(piece); });
  }

 private:
  /// The longer way, unless the other one, tried, leaves clearly less to search.
  void split(const Piece& piece) {
    const Patch patch = patch_of(a_, piece);
    const auto by_u = halves(piece, true), by_v = halves(piece, false);
    const auto gain = [&](const std::array<Piece, 2>& pair) {
      return 2 * piece.limit - std::max(pair[0].limit, search_.enough()) - std::max(pair[1].limit, search_.enough());
    };
    const double gain_u = gain(by_u), gain_v = gain(by_v), clear = 0.2 * (piece.limit - search_.enough());
    const bool is_longer_u = patch.a.squaredNorm() >= patch.b.squaredNorm();
    const bool split_u = is_longer_u ? !(gain_v > clear && gain_v > 2 * gain_u) : gain_u > clear && gain_u > 2 * gain_v;
    for (const Piece& half : split_u ? by_u : by_v) search_.add(half);
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
    piece.number = search_.next_number();
    piece.limit = std::min(piece.limit, limit_of(piece));
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
    if (least_tree(patch, radius, proven) > 0) return 0;
    double limit = tree_b > 0 ? radius - tree_b : kInfinity;
    limit = std::min(limit, limit_by_faces(patch, radius, proven));
    if (limit > search_.enough() && !likely.is_empty()) look_at(own, patch, likely);
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
  /// What the tree of B is at least, on what is left of the patch: above 0, nothing of it is within B.
  double least_tree(const Patch& patch, double radius, const Polygon& proven) {
    low_.resize(values_b_.size());
    high_.resize(values_b_.size());
    for (std::size_t i = 0; i < values_b_.size(); ++i) {
      low_[i] = values_b_[i] - radius;
      high_[i] = values_b_[i] + radius;
      if (low_[i] > 0 || high_[i] < 0) continue;
      const Model model = model_of(b_.dividers()[i], patch, 1);
      low_[i] =
          std::max(low_[i], -largest({-model.linear.at, -model.linear.du, -model.linear.dv}, proven) - model.below);
      high_[i] = std::min(high_[i], largest(model.linear, proven) + model.above);
    }
    return b_.least_value(low_, high_);
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
    for (std::size_t i = 0; i < n && limit > search_.enough(); ++i)
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
    const double distance = hypotenuse(at_g, at_h);
    if (margin < distance + 2 * radius) return margin >= distance ? distance + radius : kInfinity;
    const auto farthest = [&](const Divider& d) {
      double most = 0;
      for (const double sign : {-1.0, 1.0}) {
        const Model model = model_of(d, patch, sign);
        most = std::max(most, largest(model.linear, proven) + model.above);
      }
      return most;
    };
    return std::min(distance + radius, hypotenuse(farthest(g), farthest(h)) * (1 + kSquare));
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
    search_.found(point_depth_(x), x);
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
  BestFirst<Piece> search_;
  Values values_a_, values_b_;
  PointDepth point_depth_;
  std::vector<std::uint32_t> cutting_;
  std::vector<double> low_, high_;  ///< of b's dividers on a patch
  static constexpr std::size_t kUncertainMax = 6;
  std::vector<Linear> depths_;            ///< bounds of the last patch's depth
  std::vector<std::uint32_t> uncertain_;  ///< dividers of b near it that may not be b's surface there
};

}  // namespace

bool are_apart(const Csg& a, const Csg& b) {
  Values values_a(a), values_b(b);
  values_b.at(a.middle());
  values_a.at(b.middle());
  return values_b.tree() >= a.radius() || values_a.tree() >= b.radius();
}

Depth depth_in(const Csg& a, const Csg& b, const Accuracy& accuracy) {
  if (are_apart(a, b)) return {};
  return Search(a, b, accuracy).run();
}

double depth_of(const Vector3d& x, const Csg& b) {
  return PointDepth(b)(x);
}

}  // namespace verisim::ruler
