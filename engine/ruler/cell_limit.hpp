// How deep no point of a patch is in a solid: by the cells that lie outside of it (outside.hpp). Three proofs, each of
// a point of the cell that is near enough for every point of the patch:
//  - one divider keeps the patch out of the cell: its foot is in the cell, and the divider's model bounds how far;
//  - the cell is convex: the distance to it is largest at a corner of the patch's polygon, but for how the patch bends;
//  - two dividers that cross at a right angle keep it out: the edge in which they do.
// What is found is moved into the cell by kShift, so that it is not a seam of no thickness. Private to this folder.
#pragma once

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "engine/ruler/coaxial.hpp"
#include "engine/ruler/foot.hpp"
#include "engine/ruler/outside.hpp"
#include "engine/ruler/ranges.hpp"

namespace verisim::ruler {

class CellLimit {
 public:
  explicit CellLimit(const Csg& solid) : solid_(solid), cells_(solid) {}

  /// @param reach [m] how far from the patch a cell is looked for @param limit [m] what is known already
  /// @return the lesser of `limit` and what is found
  double operator()(const Patch& patch, const Polygon& polygon, Ranges& ranges, const Values& values, double reach,
                    double limit) {
    patch_ = &patch;
    polygon_ = &polygon;
    ranges_ = &ranges;
    reach_ = reach;
    linear_.clear();
    corner_.reset();
    sides_.resize(ranges.size());
    for (std::size_t i = 0; i < ranges.size(); ++i)
      sides_[i] = static_cast<std::int8_t>(ranges.low(i) > reach + 2 * kShift     ? 1
                                           : ranges.high(i) < -reach - 2 * kShift ? -1
                                                                                  : 0);
    cells_.find(sides_);
    order_.clear();
    for (std::uint32_t i = 0; i < cells_.cells().size(); ++i) {
      double worst = -kInfinity, least = -kInfinity;
      cells_.each(cells_.cells()[i], [&](std::uint32_t divider, double sign) {
        worst = std::max(worst, sign * values[divider]);
        least = std::max(least, sign > 0 ? ranges.low(divider) : -ranges.high(divider));
      });
      if (least < limit) order_.push_back({worst, i});
    }
    std::sort(order_.begin(), order_.end());
    if (order_.size() > kCellsTried) order_.resize(kCellsTried);
    for (const auto& [worst, i] : order_) limit = std::min(limit, of_cell(cells_.cells()[i], limit));
    return limit;
  }
  /// Linear functions of which each is nowhere on the polygon less than the depth.
  [[nodiscard]] std::vector<Linear>& linear() { return linear_; }
  /// The corner of the polygon that is farthest from the cell that decided, if one did so by its corners.
  [[nodiscard]] const std::optional<Eigen::Vector2d>& corner() const { return corner_; }

 private:
  static constexpr double kShift = 1e-10;  // m: above roundings, far below what is measured
  static constexpr double kSquare = 1e-9;  // the cosine of a right angle
  static constexpr std::size_t kCellsTried = 12;

  /// A side of a divider that the cell needs. The patch is at most `high` beyond it.
  struct Need {
    std::uint32_t divider;
    double sign, high;
  };

  double of_cell(const Cell& cell, double limit) {
    open_.clear();
    met_.clear();
    cells_.each(cell, [&](std::uint32_t i, double sign) {
      const Need need{i, sign, sign > 0 ? ranges_->high(i) : -ranges_->low(i)};
      (need.high > kOnSurface ? open_ : met_).push_back(need);
    });
    if (open_.empty()) return are_met_within(0) ? kShift : kInfinity;
    double found = kInfinity;
    if (open_.size() <= 2)
      for (Need& need : open_) sharpen(need);
    if (open_.size() == 1) {
      found = of_one(open_[0]);
      if (found < kInfinity) return found;
      for (const Need& need : met_)
        if (need.high + open_[0].high > -kOnSurface) found = std::min(found, of_edge(open_[0], need));
    }
    if (open_.size() == 2) found = of_edge(open_[0], open_[1]);
    return std::min(found, of_corners(cell, std::min(limit, found)));
  }

  [[nodiscard]] const Divider& divider(const Need& need) const { return solid_.dividers()[need.divider]; }
  [[nodiscard]] bool is_plane(const Need& need) const { return divider(need).kind == Divider::Kind::plane; }
  /// Whatever the way across the one, the other stays what it is.
  [[nodiscard]] bool is_square(const Need& a, const Need& b) const {
    const auto is_cylinder = [&](const Need& need) { return divider(need).kind == Divider::Kind::cylinder; };
    if (is_plane(a) && is_plane(b)) return std::abs(divider(a).axis.dot(divider(b).axis)) < kSquare;
    if ((is_plane(a) && is_cylinder(b)) || (is_cylinder(a) && is_plane(b)))
      return divider(a).axis.cross(divider(b).axis).norm() < kSquare;
    return false;
  }
  /// The cosine between the gradients of two that cross at the same angle everywhere.
  [[nodiscard]] std::optional<double> cosine_between(const Need& a, const Need& b) const {
    const double sign = a.sign * b.sign;
    const Divider &g = divider(a), &h = divider(b);
    if (is_plane(a) && is_plane(b)) return sign * g.axis.dot(h.axis);
    if (is_square(a, b)) return 0;
    const bool is_upright = g.axis.cross(h.axis).norm() < kSquare;
    if (is_upright && is_plane(a) && h.kind == Divider::Kind::cone) return -sign * h.sine * g.axis.dot(h.axis);
    if (is_upright && is_plane(b) && g.kind == Divider::Kind::cone) return -sign * g.sine * g.axis.dot(h.axis);
    return {};
  }
  /// The distance to the edge of two: in the plane of both gradients, two lines that cross.
  [[nodiscard]] double of_edge(const Need& a, const Need& b) const {
    const std::optional<double> cosine = cosine_between(a, b);
    if (!cosine || std::abs(*cosine) > 0.99) return kInfinity;
    const double u = std::max(0.0, a.high), v = std::max(0.0, b.high), c = *cosine;
    const double far = std::sqrt((u * u + v * v + 2 * std::abs(c) * u * v) / (1 - c * c)) * (1 + kSquare);
    if (far > reach_) return kInfinity;
    for (const Need* need : {&a, &b}) {
      if (is_plane(*need)) continue;  // not across the axis
      if (local_at(divider(*need), patch_->middle).bend_radius - patch_->first < 2 * far) return kInfinity;
    }
    for (const Need& need : met_) {
      if (need.divider == a.divider || need.divider == b.divider || need.high + far <= -kOnSurface) continue;
      if (need.high > kOnSurface || !is_square(need, a) || !is_square(need, b)) return kInfinity;
    }
    return far + kShift;
  }
  /// Is every point that is no farther than `way` from the patch on the sides that are met?
  [[nodiscard]] bool are_met_within(double way) const {
    for (std::size_t i = 0; i < met_.size(); ++i) {
      if (met_[i].high + way <= -kOnSurface) continue;
      // Those that the patch just meets, and that no way taken changes, can be left by a step along their normals.
      for (const Need& other : open_)
        if (!is_square(met_[i], other)) return false;
      if (met_[i].high > kOnSurface) return false;
      for (std::size_t k = 0; k < i; ++k)
        if (met_[k].high > -kOnSurface && !is_square(met_[i], met_[k])) return false;
    }
    return true;
  }

  /// Ranges have no more than the Lipschitz bound where all of the patch is on one side.
  void sharpen(Need& need) const {
    if (ranges_->sides()[need.divider] == 0) return;
    need.high = std::min(need.high,
                         largest(linear_of(need), *polygon_) + (need.sign > 0 ? model(need).above : model(need).below));
  }

  /// Through the foot on the one divider that is not met.
  double of_one(const Need& one) {
    if (one.high > reach_) return kInfinity;
    for (std::size_t i = 0; i < met_.size(); ++i) {
      const Need& need = met_[i];
      if (need.high + one.high <= -kOnSurface) continue;
      if (is_plane(one) && is_plane(need)) {
        // At the foot the other plane's value is its own less the cosine times this one's.
        const double cosine = one.sign * need.sign * divider(one).axis.dot(divider(need).axis);
        const Linear f = linear_of(need), g = linear_of(one);
        const double high =
            largest({f.at - cosine * g.at, f.du - cosine * g.du, f.dv - cosine * g.dv}, *polygon_) + patch_->bent();
        if (high <= -kOnSurface) continue;
      }
      if (!is_square(one, need) || need.high > kOnSurface) return kInfinity;
      for (std::size_t k = 0; k < i; ++k)
        if (met_[k].high > -kOnSurface && !is_square(need, met_[k])) return kInfinity;
    }
    Linear f = linear_of(one);
    f.at += (one.sign > 0 ? model(one).above : model(one).below) + kShift;
    linear_.push_back(f);
    return one.high + kShift;
  }
  [[nodiscard]] Model model(const Need& need) const { return best_model_of(divider(need), *patch_); }
  [[nodiscard]] Linear linear_of(const Need& need) const {
    const Linear f = model(need).linear;
    return {need.sign * f.at, need.sign * f.du, need.sign * f.dv};
  }

  double of_corners(const Cell& cell, double limit) {
    double far = 0;
    Eigen::Vector2d farthest = Eigen::Vector2d::Zero();
    for (const Eigen::Vector2d& p : polygon_->corners()) {
      const double distance = distance_to(cell, patch_->middle + p.x() * patch_->a + p.y() * patch_->b);
      if (distance > far) {
        far = distance;
        farthest = p;
      }
      if (far + patch_->bent() >= std::min(limit, reach_)) return kInfinity;
    }
    far += patch_->bent() + kShift;
    const auto is_in_the_way = [&](const Need& need) {
      const bool is_convex = is_plane(need) || (need.sign > 0 && is_convex_below(divider(need)));
      return !is_convex && need.high + far > -kOnSurface;
    };
    if (std::any_of(open_.begin(), open_.end(), is_in_the_way) || std::any_of(met_.begin(), met_.end(), is_in_the_way))
      return kInfinity;
    corner_ = farthest;
    return far;
  }

  /// From x to a point within the cell, near the nearest one; infinite if none is found.
  double distance_to(const Cell& cell, const Vector3d& x) const {
    Vector3d y = x;
    DividerSet on{};
    std::array<double, 3> signs{};
    for (std::size_t n = 0;; ++n) {
      double worst = -kInfinity, sign = 0;
      std::uint32_t next = 0;
      cells_.each(cell, [&](std::uint32_t i, double s) {
        const double value = s * value_at(solid_.dividers()[i], y);
        if (value <= worst) return;
        worst = value;
        next = i;
        sign = s;
      });
      if (worst <= kOnSurface) break;
      if (n == on.size()) return kInfinity;
      on[n] = next;
      signs[n] = sign;
      y = foot(solid_.dividers(), x, on, n + 1);
      if (!y.allFinite()) return kInfinity;
    }
    Vector3d inward = Vector3d::Zero();
    bool is_within = true;
    const auto each_near = [&](double margin, const auto& act) {
      cells_.each(cell, [&](std::uint32_t i, double s) {
        if (s * value_at(solid_.dividers()[i], y) > -margin) act(i, s);
      });
    };
    each_near(kShift, [&](std::uint32_t i, double s) { inward -= s * local_at(solid_.dividers()[i], y).gradient; });
    y += kShift * inward;
    each_near(1e-12, [&](std::uint32_t, double) { is_within = false; });
    return is_within ? (y - x).norm() : kInfinity;
  }

  const Csg& solid_;
  OutsideCells cells_;
  const Patch* patch_ = nullptr;
  const Polygon* polygon_ = nullptr;
  Ranges* ranges_ = nullptr;
  double reach_ = 0;
  std::vector<std::int8_t> sides_;
  std::vector<std::pair<double, std::uint32_t>> order_;
  std::vector<Need> open_, met_;
  std::vector<Linear> linear_;
  std::optional<Eigen::Vector2d> corner_;
};

}  // namespace verisim::ruler
