// Acquisition: finding a head of three or four LEDs in one image without knowing where it was.
#pragma once

#include "engine/wii/assignment.hpp"
#include "engine/wii/pose_solver.hpp"

namespace verisim::wii {

struct Acquired {
  SolvedPose solved;
  Assignment blob = {-1, -1, -1, -1};
  /// What it is chosen by: SolvedPose::cost, and how far the sizes of the blobs are from those of equal LEDs at the
  /// distances where they would be.
  double cost = 0;
};

/// What the sizes of blobs are compared with: that of an LED 1 m away, 0 where none was learned yet (then equal LEDs
/// are all that is known).
struct LedSize {
  double at_1m = 0;
};

/// Solves for the pose under every assignment of blobs to LEDs, from three turns of the head each, and takes the one of
/// least cost. Needs three LEDs in view: the first three, if the head has four and only three blobs are seen. At most
/// 24 x 3 solutions; only while no head is followed.
/// @pre upright.C_LR is the levelling of this reading: its rows are unit
[[nodiscard]] Acquired acquire_head(const Reading& reading, const TrackerSettings& settings, const Pinhole& pinhole,
                                    const PoseSolver& solver, const Upright& upright, LedSize size = {});

/// The same from two blobs of a head whose other LEDs are out of view: the two LEDs and their order for which an
/// upright head has no other LED within the image. Not found if two such heads are about as likely. At most 12
/// solutions.
[[nodiscard]] Acquired acquire_head_from_two(const Reading& reading, const TrackerSettings& settings,
                                             const Pinhole& pinhole, const PoseSolver& solver, const Upright& upright,
                                             LedSize size = {});

/// Learns from a head that is seen with all its LEDs. @pre the assignment's blobs are of the reading
void learn_size(LedSize& size, const Reading& reading, const TrackerSettings& settings, const Assignment& assignment,
                const Pose& X_RH);

/// The sightings that an assignment means. Returns how many.
/// @pre blobs of the assignment are of the reading; sightings.size() >= leds.count
int sightings_of(const Reading& reading, const LedLayout& leds, const Assignment& assignment, int remote,
                 std::span<Sighting> sightings);

}  // namespace verisim::wii
