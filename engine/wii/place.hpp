// Where to put the remote: the place and aim that see most of a set of head poses, and see them best
// (dissertation section 2.9: "a tool that suggests an optimal position for the Wii Remote").
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "engine/wii/tracker.hpp"

namespace verisim::wii {

/// How the search goes. Heuristic: wii_thresholds_test says how little the place's worth depends on it.
struct PlaceSearch {
  int grid = 5;                       ///< places along each side of the room: 0.25 m apart in the usual one
  std::size_t finalists = 8;          ///< of the grid, improved further: the best of the grid need not lead to the best
  double first_turn = 8 * kDegree;    ///< rad, first step of heading and pitch; of places it is the grid's
  double step_min = 0.001;            ///< m, last step: nobody puts a remote more exactly
  double angle_min = 0.05 * kDegree;  ///< rad, likewise
  double equal_coverage = 0.001;      ///< shares of covered heads this near count as equal, and the error decides
};

/// What a remote cannot stand in nor see through: a screen, a wall, furniture. An axis-aligned box of its own
/// coordinates.
struct Obstacle {
  Pose X_WO;                         ///< of its middle
  Vector3d half = Vector3d::Zero();  ///< of its sides [m]
};
/// @pre there are heads
[[nodiscard]] Vector3d middle_of(const std::vector<Pose>& heads);
/// A flat screen 4 cm thick that faces `toward`. @pre it does not stand right above or below that
[[nodiscard]] Obstacle screen_at(const Vector3d& middle, const Vector3d& toward, double width, double height);

struct PlaceOptions {
  std::vector<Pose> heads;                 ///< X_WH, recorded or modelled; W with +y up
  Vector3d room_min = {-0.5, -0.5, -0.5};  ///< where the remote may stand, m, W
  Vector3d room_max = {0.5, 0.5, 0.5};
  TrackerSettings tracker;                    ///< LEDs, field of view and pixel noise
  double emission_half_angle = 60 * kDegree;  ///< an LED turned further away is not counted as seen
  std::vector<Obstacle> obstacles;
  PlaceSearch search = {};
};

struct Placement {
  Pose X_WR;           ///< without roll
  double heading = 0;  ///< rad about +y; 0 looks along +z of W
  double pitch = 0;    ///< rad, lens up
  double covered = 0;  ///< fraction of the heads whose first two LEDs are both in view
  double error = 0;    ///< m, expected rms error over the covered heads (yaw left out)
};

/// Error(input) for no heads, an empty or endless room, a head that is not finite, or settings that no tracker takes.
void check_place(const PlaceOptions& options);

/// Why a head is not covered, by the first of its two LEDs that is not.
enum class Lost { no, out_of_view, too_near, too_far, turned_away, hidden };
[[nodiscard]] std::string_view name_of(Lost why);
/// Of every head. @pre as for judge_place
[[nodiscard]] std::vector<Lost> lost_heads(const PlaceOptions& options, const Pose& X_WR);

/// What a given place is worth; nothing within an obstacle. Cost: two projections per head, a covariance for those
/// covered.
/// @pre there are heads; the settings are such that a tracker takes them (check_settings); the place is finite
[[nodiscard]] Placement judge_place(const PlaceOptions& options, const Vector3d& p_WR, double heading, double pitch);

/// The places of which none covers more heads with no larger error than another: the first covers most, the last errs
/// least. A 5 x 5 x 5 grid of places aimed at the middle of the heads, then the best eight improved along each
/// coordinate by steps that halve down to 1 mm and 0.05 degrees, for coverages that count as equal to 0.1, 5 and 20 %.
/// Deterministic. Error(input) for no heads, an empty or endless room, one that obstacles fill, a head that is not
/// finite, or settings that no tracker takes.
[[nodiscard]] std::vector<Placement> good_places(const PlaceOptions& options);

/// Heads of someone at work at `middle` who faces `toward`: normal about it with `spread` [m] per axis, turned as heads
/// turn (the settings' yaw and pitch sigma, half of it as roll). @pre count >= 0
[[nodiscard]] std::vector<Pose> modelled_heads(const Vector3d& middle, const Vector3d& toward, const Vector3d& spread,
                                               int count, std::uint64_t seed);

}  // namespace verisim::wii
