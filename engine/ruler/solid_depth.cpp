#include "engine/ruler/solid_depth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "engine/base/error.hpp"
#include "engine/ruler/best_first.hpp"
#include "engine/ruler/cell_limit.hpp"
#include "engine/ruler/patch.hpp"
#include "engine/ruler/point_depth.hpp"
#include "engine/ruler/polygon.hpp"
#include "engine/ruler/ranges.hpp"

namespace verisim::ruler {
namespace {

class Search {
 public:
  Search(const Csg& a, const Csg& b, const Accuracy& accuracy)
      : a_(a),
        b_(b),
        search_(accuracy),
        values_a_(a),
        values_b_(b),
        point_depth_(b),
        ranges_a_(a),
        ranges_b_(b),
        cell_limit_(b) {}

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
    if (is_covered(piece, patch)) return 0;
    values_b_.at(patch.middle);
    const double tree_b = values_b_.tree();
    if (tree_b >= radius) return 0;

    const std::uint32_t own = a_.faces()[piece.face].divider;
    values_a_.at(patch.middle);
    ranges_a_.of(patch, values_a_);
    ranges_b_.of(patch, values_b_);
    Polygon proven, likely;
    cutting_.clear();
    for (int pass = 0; pass < 2; ++pass) {  // what the one cuts off may tell the other more
      if (side_beside(own) != 0) return 0;
      cut_by_other(proven, likely);
      if (proven.is_empty()) return 0;
      ranges_a_.narrow(proven);
      cut_by_own(own, proven, likely);
      if (proven.is_empty()) return 0;
      ranges_b_.narrow(proven);
    }
    if (b_.side(ranges_b_.sides()) > 0) return 0;
    double limit = tree_b > 0 ? radius - tree_b : kInfinity;
    // A point may be as deep as the middle of what is left and as it is far from there.
    const auto [middle, left] = ball_around(patch, proven);
    values_b_.at(middle);
    const double tree = values_b_.tree();
    if (tree >= left) return 0;
    const double at_middle = tree > 0 ? -tree : point_depth_(middle);
    limit = std::min(limit, at_middle + left);
    limit = cell_limit_(patch, proven, ranges_b_, values_b_, std::max(at_middle, 0.0) + 2 * left, limit);
    limit = by_two_at_once(proven, limit);
    if (limit > search_.enough() && !likely.is_empty()) look_at(own, patch, likely);
    return limit;
  }

  /// By discs of the same plane.
  [[nodiscard]] bool is_covered(const Piece& piece, const Patch& patch) const {
    const auto& discs = a_.faces()[piece.face].discs;
    return std::any_of(discs.begin(), discs.end(), [&](std::uint32_t i) {
      const Face& disc = a_.faces()[i];
      return (disc.origin - patch.middle).norm() + patch.radius() <= disc.v_high;
    });
  }

  /// Around all points of the patch that belong to the polygon.
  static std::pair<Vector3d, double> ball_around(const Patch& patch, const Polygon& polygon) {
    const auto at = [&](const Eigen::Vector2d& p) {
      return Vector3d(patch.middle + p.x() * patch.a + p.y() * patch.b);
    };
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();
    for (const Eigen::Vector2d& p : polygon.corners()) middle += p;
    middle /= static_cast<double>(polygon.corners().size());
    double radius = 0;
    for (const Eigen::Vector2d& p : polygon.corners()) radius = std::max(radius, (at(p) - at(middle)).norm());
    return {at(middle), radius + patch.bent()};
  }

  /// 0 if A's surface can pass through the patch, on the divider `own`; else both sides of it are inside or outside.
  int side_beside(std::uint32_t own) {
    std::vector<std::int8_t>& sides = ranges_a_.sides();
    const std::int8_t kept = sides[own];
    sides[own] = -1;
    const int below = side_of(a_, sides);
    sides[own] = 1;
    const int above = below != 0 ? side_of(a_, sides) : 0;
    sides[own] = kept;
    return below == above ? below : 0;
  }

  /// What A's other surfaces leave of the patch: `proven` at least that, `likely` about that.
  void cut_by_own(std::uint32_t own, Polygon& proven, Polygon& likely) {
    std::vector<std::int8_t>& sides = ranges_a_.sides();
    for (std::uint32_t i = 0; i < ranges_a_.size() && !proven.is_empty(); ++i) {
      if (i == own || sides[i] != 0) continue;
      for (const int side : {1, -1}) {
        // With this divider on that side nothing of the patch is A's surface: so what is, is on the other side.
        sides[i] = static_cast<std::int8_t>(side);
        const bool is_none = side_beside(own) != 0;
        sides[i] = 0;
        if (!is_none) continue;
        keep_below(side > 0 ? ranges_a_.model(i) : -ranges_a_.model(i), proven, likely);
        if (std::find(cutting_.begin(), cutting_.end(), i) == cutting_.end()) cutting_.push_back(i);
        break;
      }
    }
  }
  /// What B's surfaces leave of the patch that can be within B.
  void cut_by_other(Polygon& proven, Polygon& likely) {
    std::vector<std::int8_t>& sides = ranges_b_.sides();
    for (std::uint32_t i = 0; i < ranges_b_.size() && !proven.is_empty(); ++i) {
      if (sides[i] != 0) continue;
      for (const int side : {1, -1}) {
        sides[i] = static_cast<std::int8_t>(side);
        const bool is_out = side_of(b_, sides) > 0;
        sides[i] = 0;
        if (!is_out) continue;
        keep_below(side > 0 ? ranges_b_.model(i) : -ranges_b_.model(i), proven, likely);
        break;
      }
    }
  }

  static void keep_below(const Model& model, Polygon& proven, Polygon& likely) {
    Linear linear = model.linear;
    likely.keep_below(linear);
    linear.at -= model.below;
    proven.keep_below(linear);
  }

  double by_two_at_once(const Polygon& proven, double limit) {
    std::vector<Linear>& depths = cell_limit_.linear();
    std::sort(depths.begin(), depths.end(), [](const Linear& f, const Linear& g) { return f.at < g.at; });
    const std::size_t n = std::min<std::size_t>(depths.size(), 3);
    for (std::size_t i = 0; i < n && limit > search_.enough(); ++i)
      for (std::size_t j = i + 1; j < n; ++j) limit = std::min(limit, largest_of_lesser(depths[i], depths[j], proven));
    return limit;
  }

  /// Tries the places of the patch that its linear models take for the deepest.
  void look_at(std::uint32_t own, const Patch& patch, const Polygon& likely) {
    const std::vector<Linear>& depths = cell_limit_.linear();
    const auto least = [&](const Eigen::Vector2d& p) {
      double value = kInfinity;
      for (const Linear& f : depths) value = std::min(value, f(p));
      return value;
    };
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();
    for (const Eigen::Vector2d& corner : likely.corners()) middle += corner;
    middle /= static_cast<double>(likely.corners().size());
    Eigen::Vector2d best = middle;
    for (const Eigen::Vector2d& corner : likely.corners())
      if (least(corner) > least(best)) best = corner;
    try_at(own, patch, best);
    if (cell_limit_.corner()) try_at(own, patch, *cell_limit_.corner());
    if (depths.empty()) {
      for (const Eigen::Vector2d& corner : likely.corners()) try_at(own, patch, corner);
    } else if (depths.size() > 1) {  // on the way to the middle two depths may become equal
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

  /// m, to A's surface at least, from a point of the divider `own`: both sides of it are inside, or both outside. Where
  /// the point is on a divider of both senses, too, as on a flush countersink's rim, on either side of that.
  double away_from_surface(std::uint32_t own, std::size_t from = 0) {
    const std::vector<std::uint32_t>& both = a_.of_both_senses();
    for (std::size_t k = from; k < both.size(); ++k) {
      const double kept = values_a_[both[k]];
      if (both[k] == own || std::abs(kept) > kOnSurface) continue;
      double least = kInfinity;
      for (const double side : {-kInfinity, kInfinity}) {
        values_a_[both[k]] = side;
        least = std::min(least, away_from_surface(own, k + 1));
      }
      values_a_[both[k]] = kept;
      return least;
    }
    const double below = values_a_.tree_with(own, -kInfinity), above = values_a_.tree_with(own, kInfinity);
    return std::max(std::min(below, above), -std::max(below, above));
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
  Ranges ranges_a_, ranges_b_;
  CellLimit cell_limit_;
  std::vector<std::uint32_t> cutting_;
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
