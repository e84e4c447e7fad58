#include "engine/wii/place.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/base/random.hpp"
#include "engine/wii/admission.hpp"
#include "engine/wii/gravity.hpp"
#include "engine/wii/trajectories.hpp"
#include "engine/wii/two_led_covariance.hpp"

namespace verisim::wii {
namespace {

using Parameters = std::array<double, 5>;  // x, y, z, heading, pitch

Quaterniond aim(double heading, double pitch) {
  return rotation_from_vector({0, heading, 0}) * rotation_from_vector({-pitch, 0, 0});
}

/// Coverage in steps, so that this is an order: "nearly equal" would not be transitive.
bool better(const Placement& a, const Placement& b, double equal_coverage) {
  const double steps_a = std::round(a.covered / equal_coverage);
  const double steps_b = std::round(b.covered / equal_coverage);
  return steps_a != steps_b ? steps_a > steps_b : a.error < b.error;
}

Placement judge(const PlaceOptions& options, const Parameters& x) {
  return judge_place(options, {x[0], x[1], x[2]}, x[3], x[4]);
}

}  // namespace

void check_place(const PlaceOptions& options) {
  if (options.heads.empty()) fail(ErrorKind::input, "wii place: no head poses; give a trace or model some");
  for (const Pose& X_WH : options.heads)
    if (!X_WH.position.allFinite() || !X_WH.rotation.coeffs().allFinite())
      fail(ErrorKind::input, "wii place: a head pose is not finite; remove it from the trace");
  if (!options.room_min.allFinite() || !options.room_max.allFinite())
    fail(ErrorKind::input, "wii place: a corner of the room is not finite; correct it");
  check_settings(options.tracker);
  if (!(options.room_min.array() <= options.room_max.array()).all())
    fail(ErrorKind::input, "wii place: the room's lower corner lies above its upper one; exchange them");
}

namespace {

Parameters aimed_at(const Vector3d& p, const Vector3d& target) {
  const Vector3d way = target - p;
  return {p.x(), p.y(), p.z(), pinned::atan2(way.x(), way.z()),
          pinned::atan2(way.y(), std::sqrt(way.x() * way.x() + way.z() * way.z()))};
}

/// Whether the way from one point to another meets an obstacle.
bool crosses(const Obstacle& o, const Vector3d& from_W, const Vector3d& to_W) {
  const Pose X_OW = o.X_WO.inverse();
  const Vector3d from = X_OW * from_W;
  const Vector3d way = X_OW * to_W - from;
  double enter = 0;
  double leave = 1;
  for (int i = 0; i < 3; ++i) {
    if (way[i] == 0) {
      if (std::abs(from[i]) > o.half[i]) return false;
      continue;
    }
    const double a = (-o.half[i] - from[i]) / way[i];
    const double b = (o.half[i] - from[i]) / way[i];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave;
}

/// What a remote sees of a head's first two LEDs.
struct View {
  View(const PlaceOptions& place, const Pose& X)
      : options(place),
        X_WR(X),
        X_RW(X.inverse()),
        pinhole(place.tracker.fov),
        emission(pinned::cos(place.emission_half_angle)) {}

  [[nodiscard]] Lost lost(const Pose& X_WH) const {
    const Lost first = led_lost(X_WH, 0);
    return first != Lost::no ? first : led_lost(X_WH, 1);
  }
  [[nodiscard]] Lost led_lost(const Pose& X_WH, std::size_t led) const {
    const Vector3d p_W = X_WH * options.tracker.leds.p_H[led];
    const Vector3d p_R = X_RW * p_W;
    if (p_R.norm() < kDistanceMin) return Lost::too_near;
    if (p_R.norm() > kDistanceMax) return Lost::too_far;
    if (!(p_R.z() > 0)) return Lost::out_of_view;
    const Eigen::Vector2d pixel = pinhole.project(p_R);
    if (!(pixel.x() >= 0 && pixel.x() <= kWidth - 1 && pixel.y() >= 0 && pixel.y() <= kHeight - 1))
      return Lost::out_of_view;
    if ((X_WH.rotation * Vector3d(0, 0, -1)).dot((X_WR.position - p_W).normalized()) < emission)
      return Lost::turned_away;
    const bool hidden = std::any_of(options.obstacles.begin(), options.obstacles.end(),
                                    [&](const Obstacle& o) { return crosses(o, X_WR.position, p_W); });
    return hidden ? Lost::hidden : Lost::no;
  }

  const PlaceOptions& options;
  Pose X_WR, X_RW;
  Pinhole pinhole;
  double emission;  ///< cosine
};

/// Moves along one coordinate after another while that helps, with steps that halve.
Placement improve(const PlaceOptions& options, Parameters x, double equal_coverage) {
  Placement best = judge(options, x);
  const Vector3d room = options.room_max - options.room_min;
  double step = room.maxCoeff() / options.search.grid;
  double turn = options.search.first_turn;
  while (step > options.search.step_min || turn > options.search.angle_min) {
    bool helped = false;
    for (std::size_t i = 0; i < x.size(); ++i)
      for (const double sign : {1.0, -1.0}) {
        Parameters y = x;
        y[i] += sign * (i < 3 ? step : turn);
        if (i < 3) {
          const auto axis = static_cast<Eigen::Index>(i);
          y[i] = std::clamp(y[i], options.room_min[axis], options.room_max[axis]);
        }
        const Placement candidate = judge(options, y);
        if (!better(candidate, best, equal_coverage)) continue;
        best = candidate;
        x = y;
        helped = true;
      }
    if (!helped) {
      step /= 2;
      turn /= 2;
    }
  }
  return best;
}

std::vector<Parameters> places_of_the_grid(const PlaceOptions& options) {
  const Vector3d target = middle_of(options.heads);
  std::vector<Parameters> places;
  const int grid = options.search.grid;
  for (int i = 0; i < grid * grid * grid; ++i) {
    const Eigen::Array3i cell(i % grid, i / grid % grid, i / (grid * grid));
    const Eigen::Array3d fraction = cell.cast<double>() / (grid - 1);
    const Vector3d rounded = options.room_min.array() + fraction * (options.room_max - options.room_min).array();
    const Vector3d p = rounded.cwiseMin(options.room_max);  // by roundings the last one would stand outside
    if ((target - p).norm() >= kDistanceMin) places.push_back(aimed_at(p, target));
  }
  if (places.empty())
    fail(ErrorKind::input, "wii place: every place of the room is within {} m of the heads; allow places further away",
         kDistanceMin);
  return places;
}

/// Those that no other dominates, by falling coverage; of coverages that count as equal one.
std::vector<Placement> front_of(std::vector<Placement> all, double equal_coverage) {
  std::stable_sort(all.begin(), all.end(),
                   [&](const Placement& a, const Placement& b) { return better(a, b, equal_coverage); });
  std::vector<Placement> front;
  for (const Placement& place : all)
    if (place.covered > 0 && (front.empty() || place.error < front.back().error)) front.push_back(place);
  return front;
}

}  // namespace

Vector3d middle_of(const std::vector<Pose>& heads) {
  VERISIM_ASSERT(!heads.empty());
  Vector3d sum = Vector3d::Zero();
  for (const Pose& X_WH : heads) sum += X_WH.position;
  return sum / static_cast<double>(heads.size());
}

Obstacle screen_at(const Vector3d& middle, const Vector3d& toward, double width, double height) {
  constexpr double kThick = 0.04;  // m
  const Vector3d way = toward - middle;
  const Quaterniond facing = rotation_from_vector({0, pinned::atan2(way.x(), way.z()), 0});
  return {{middle, facing}, {width / 2, height / 2, kThick / 2}};
}

std::string_view name_of(Lost why) {
  switch (why) {
    case Lost::no:
      return "seen";
    case Lost::out_of_view:
      return "out of view";
    case Lost::too_near:
      return "too near";
    case Lost::too_far:
      return "too far";
    case Lost::turned_away:
      return "turned away";
    case Lost::hidden:
      return "hidden";
  }
  return "";
}

std::vector<Lost> lost_heads(const PlaceOptions& options, const Pose& X_WR) {
  VERISIM_ASSERT(is_placement(X_WR));
  const View view(options, X_WR);
  std::vector<Lost> lost;
  for (const Pose& X_WH : options.heads) lost.push_back(view.lost(X_WH));
  return lost;
}

Placement judge_place(const PlaceOptions& options, const Vector3d& p_WR, double heading, double pitch) {
  VERISIM_ASSERT(!options.heads.empty());
  VERISIM_ASSERT(is_finite(p_WR));
  Placement place{.X_WR = {p_WR, aim(heading, pitch)}, .heading = heading, .pitch = pitch};
  place.error = std::numeric_limits<double>::infinity();
  for (const Obstacle& o : options.obstacles)
    if (crosses(o, p_WR, p_WR)) return place;
  const View view(options, place.X_WR);
  TrackerSettings known = options.tracker;
  known.yaw_sigma = known.pitch_sigma = 0;
  const Matrix3d C_LR = levelling(view.X_RW.rotation * Vector3d::UnitY());
  int covered = 0;
  double square = 0;
  for (const Pose& X_WH : options.heads) {
    if (view.lost(X_WH) != Lost::no) continue;
    ++covered;
    const Vector3d p_L = C_LR * (view.X_RW * X_WH.position);
    Matrix6d covariance = two_led_covariance(known, view.pinhole, p_L, 1, 0);
    add_tilt(covariance, p_L, C_LR, known.gravity_sigma * known.gravity_sigma);
    square += covariance.diagonal().head<3>().sum();
  }
  place.covered = static_cast<double>(covered) / static_cast<double>(options.heads.size());
  if (covered > 0) place.error = std::sqrt(square / covered);
  return place;
}

std::vector<Placement> good_places(const PlaceOptions& options) {
  check_place(options);
  const std::vector<Parameters> grid = places_of_the_grid(options);
  std::vector<Placement> all;
  for (const Parameters& x : grid) all.push_back(judge(options, x));
  if (std::none_of(all.begin(), all.end(), [](const Placement& p) { return p.covered > 0; }))
    fail(ErrorKind::input,
         "wii place: from no place of the room is a head seen; allow other places, or fewer or smaller obstacles");
  for (const double equal_coverage : {options.search.equal_coverage, 0.05, 0.2}) {
    std::vector<std::size_t> order(grid.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return better(all[a], all[b], equal_coverage); });
    for (std::size_t i = 0; i < std::min(options.search.finalists, order.size()); ++i)
      all.push_back(improve(options, grid[order[i]], equal_coverage));
  }
  return front_of(all, options.search.equal_coverage);
}

std::vector<Pose> modelled_heads(const Vector3d& middle, const Vector3d& toward, const Vector3d& spread, int count,
                                 std::uint64_t seed) {
  VERISIM_ASSERT(count >= 0);
  const TrackerSettings typical;
  const RandomStream random(seed, "wii/heads");
  const Vector3d way = middle - toward;  // +z of H points backwards
  const Quaterniond facing = rotation_from_vector({0, pinned::atan2(way.x(), way.z()), 0});
  std::vector<Pose> heads;
  for (int k = 0; k < count; ++k) {
    const auto normal = [&](std::uint64_t i) { return random.normal(6 * static_cast<std::uint64_t>(k) + i); };
    const Vector3d p = middle + spread.cwiseProduct(Vector3d(normal(0), normal(1), normal(2)));
    const Quaterniond turned = head_rotation(typical.yaw_sigma * normal(3), typical.pitch_sigma * normal(4),
                                             typical.yaw_sigma / 2 * normal(5));
    heads.push_back({p, (facing * turned).normalized()});
  }
  return heads;
}

}  // namespace verisim::wii
