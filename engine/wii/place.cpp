#include "engine/wii/place.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/base/random.hpp"
#include "engine/wii/admission.hpp"
#include "engine/wii/trajectories.hpp"
#include "engine/wii/gravity.hpp"
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

void check(const PlaceOptions& options) {
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

Vector3d middle_of(const std::vector<Pose>& heads) {
  Vector3d sum = Vector3d::Zero();
  for (const Pose& X_WH : heads) sum += X_WH.position;
  return sum / static_cast<double>(heads.size());
}

Parameters aimed_at(const Vector3d& p, const Vector3d& target) {
  const Vector3d way = target - p;
  return {p.x(), p.y(), p.z(), pinned::atan2(way.x(), way.z()),
          pinned::atan2(way.y(), std::sqrt(way.x() * way.x() + way.z() * way.z()))};
}

/// Moves along one coordinate after another while that helps, with steps that halve.
Placement improve(const PlaceOptions& options, Parameters x) {
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
        if (!better(candidate, best, options.search.equal_coverage)) continue;
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

}  // namespace

Placement judge_place(const PlaceOptions& options, const Vector3d& p_WR, double heading, double pitch) {
  VERISIM_ASSERT(!options.heads.empty());
  VERISIM_ASSERT(is_finite(p_WR));
  Placement place{.X_WR = {p_WR, aim(heading, pitch)}, .heading = heading, .pitch = pitch};
  const Pinhole pinhole(options.tracker.fov);
  TrackerSettings known = options.tracker;
  known.yaw_sigma = known.pitch_sigma = 0;
  const Pose X_RW = place.X_WR.inverse();
  const Matrix3d C_LR = levelling(X_RW.rotation * Vector3d::UnitY());
  const double emission = pinned::cos(options.emission_half_angle);
  int covered = 0;
  double square = 0;
  for (const Pose& X_WH : options.heads) {
    const auto in_view = [&](std::size_t led) {
      const Vector3d p_W = X_WH * known.leds.p_H[led];
      const Vector3d p_R = X_RW * p_W;
      if (!(p_R.z() > 0) || p_R.norm() > kDistanceMax || p_R.norm() < kDistanceMin) return false;
      const Eigen::Vector2d pixel = pinhole.project(p_R);
      const double shines = (X_WH.rotation * Vector3d(0, 0, -1)).dot((p_WR - p_W).normalized());
      return pixel.x() >= 0 && pixel.x() <= kWidth - 1 && pixel.y() >= 0 && pixel.y() <= kHeight - 1 &&
             shines >= emission;
    };
    if (!in_view(0) || !in_view(1)) continue;
    ++covered;
    const Vector3d p_L = C_LR * (X_RW * X_WH.position);
    Matrix6d covariance = two_led_covariance(known, pinhole, p_L, 1, 0);
    add_tilt(covariance, p_L, C_LR, known.gravity_sigma * known.gravity_sigma);
    square += covariance.diagonal().head<3>().sum();
  }
  place.covered = static_cast<double>(covered) / static_cast<double>(options.heads.size());
  place.error = covered > 0 ? std::sqrt(square / covered) : std::numeric_limits<double>::infinity();
  return place;
}

Placement best_place(const PlaceOptions& options) {
  check(options);
  const Vector3d target = middle_of(options.heads);
  struct Candidate {
    Parameters x;
    Placement worth;
  };
  std::vector<Candidate> candidates;
  const int grid = options.search.grid;
  for (int i = 0; i < grid * grid * grid; ++i) {
    const Eigen::Array3i cell(i % grid, i / grid % grid, i / (grid * grid));
    const Eigen::Array3d fraction = cell.cast<double>() / (grid - 1);
    const Vector3d p = options.room_min.array() + fraction * (options.room_max - options.room_min).array();
    if ((target - p).norm() < kDistanceMin) continue;
    const Parameters x = aimed_at(p, target);
    candidates.push_back({x, judge(options, x)});
  }
  if (candidates.empty())
    fail(ErrorKind::input, "wii place: every place of the room is within {} m of the heads; allow places further away",
         kDistanceMin);
  std::stable_sort(candidates.begin(), candidates.end(), [&](const Candidate& a, const Candidate& b) {
    return better(a.worth, b.worth, options.search.equal_coverage);
  });
  Placement best = candidates.front().worth;
  for (std::size_t i = 0; i < std::min(options.search.finalists, candidates.size()); ++i) {
    const Placement improved = improve(options, candidates[i].x);
    if (better(improved, best, options.search.equal_coverage)) best = improved;
  }
  return best;
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
