#include "engine/wii/acquisition.hpp"

#include <limits>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"

namespace verisim::wii {
namespace {

/// Depth-first over the assignments of blobs to the first `count` LEDs.
struct AssignmentSearch {
  const Reading& reading;
  const TrackerSettings& settings;
  const Pinhole& pinhole;
  const PoseSolver& solver;
  const Upright& upright;
  int count;
  Assignment current = {-1, -1, -1, -1};
  Acquired best{};

  void descend(int led, unsigned used) {
    if (led == count) {
      try_current();
      return;
    }
    for (int b = 0; b < reading.blob_count; ++b) {
      if ((used >> b & 1U) != 0) continue;
      current[static_cast<std::size_t>(led)] = b;
      descend(led + 1, used | 1U << b);
    }
  }

  void try_current() {
    const auto ray = [&](std::size_t led) {
      const Blob& b = reading.blobs[static_cast<std::size_t>(current[led])];
      return pinhole.ray(b.u, b.v);
    };
    const LedPair pair{settings.leds.p_H[0], settings.leds.p_H[1]};
    const TwoPointPose two = solve_two_points(pair, ray(0), ray(1), upright.C_LR, settings.thresholds.forward_min);
    if (!two.found || two.cos_roll <= 0) return;
    std::array<Sighting, kLedsMax> sightings;
    const int n = sightings_of(reading, settings.leds, current, 0, sightings);
    for (const double turn : {0.0, settings.thresholds.start_turn, -settings.thresholds.start_turn}) {
      const Quaterniond R_LH = rotation_about_z(two.cos_roll, two.sin_roll) * rotation_from_vector({0, turn, 0});
      const Quaterniond C_RL = Quaterniond(upright.C_LR).conjugate();
      const Pose start{upright.C_LR.transpose() * two.p_L, (C_RL * R_LH).normalized()};
      const SolvedPose solved = solver.solve(std::span(sightings).first(static_cast<std::size_t>(n)), upright, start);
      if (!solved.found || solved.cost > settings.thresholds.cost_per_led_max * n) continue;
      if (best.solved.found && solved.cost >= best.solved.cost) continue;
      best = {solved, current};
    }
  }
};

}  // namespace

int sightings_of(const Reading& reading, const LedLayout& leds, const Assignment& assignment, int remote,
                 std::span<Sighting> sightings) {
  VERISIM_ASSERT(sightings.size() >= static_cast<std::size_t>(leds.count));
  int n = 0;
  for (std::size_t led = 0; led < static_cast<std::size_t>(leds.count); ++led) {
    if (assignment[led] < 0) continue;
    VERISIM_ASSERT(assignment[led] < reading.blob_count);
    const Blob& b = reading.blobs[static_cast<std::size_t>(assignment[led])];
    sightings[static_cast<std::size_t>(n++)] = {leds.p_H[led], b.u, b.v, remote};
  }
  return n;
}

Acquired acquire_head(const Reading& reading, const TrackerSettings& settings, const Pinhole& pinhole,
                      const PoseSolver& solver, const Upright& upright) {
  for (int i = 0; i < 3; ++i) VERISIM_ASSERT(is_unit(Vector3d(upright.C_LR.row(i))));
  const int count = std::min(settings.leds.count, reading.blob_count);
  if (count < 3) return {};
  AssignmentSearch search{reading, settings, pinhole, solver, upright, count};
  search.descend(0, 0);
  return search.best;
}

}  // namespace verisim::wii
