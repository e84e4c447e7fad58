// Acquisition: finding a head of three or four LEDs in one image without knowing where it was.
#pragma once

#include "engine/wii/assignment.hpp"
#include "engine/wii/pose_solver.hpp"

namespace verisim::wii {

struct Acquired {
  SolvedPose solved;
  Assignment blob = {-1, -1, -1, -1};
};

/// Solves for the pose under every assignment of blobs to LEDs, from three turns of the head each, and takes the one of
/// least cost (SolvedPose::cost). Needs three LEDs in view: the first three, if the head has four and only three blobs
/// are seen. At most 24 x 3 solutions; only while no head is followed.
/// @pre upright.C_LR is the levelling of this reading: its rows are unit
[[nodiscard]] Acquired acquire_head(const Reading& reading, const TrackerSettings& settings, const Pinhole& pinhole,
                                    const PoseSolver& solver, const Upright& upright);

/// The sightings that an assignment means. Returns how many.
/// @pre blobs of the assignment are of the reading; sightings.size() >= leds.count
int sightings_of(const Reading& reading, const LedLayout& leds, const Assignment& assignment, int remote,
                 std::span<Sighting> sightings);

}  // namespace verisim::wii
