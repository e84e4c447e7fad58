#include "engine/wii/acquisition.hpp"

#include <algorithm>
#include <utility>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"

namespace verisim::wii {
namespace {

/// Calls back with the blob of each LED that has one, and its distance.
template <typename Each>
void each_blob(const Reading& reading, const LedLayout& leds, const Assignment& assignment, const Pose& X_RH,
               Each each) {
  for (std::size_t led = 0; led < static_cast<std::size_t>(leds.count); ++led)
    if (assignment[led] >= 0)
      each(reading.blobs[static_cast<std::size_t>(assignment[led])], (X_RH * leds.p_H[led]).norm());
}

double mean_size_at_1m(const Reading& reading, const LedLayout& leds, const Assignment& assignment, const Pose& X_RH) {
  double sum = 0;
  int n = 0;
  each_blob(reading, leds, assignment, X_RH, [&](const Blob& blob, double distance) {
    sum += blob.size * distance;
    ++n;
  });
  return sum / n;
}

/// How unequal the blobs are, were they of equal LEDs at these distances, and how far from the size that was learned.
double size_cost(const LedSize& size, const Reading& reading, const TrackerSettings& settings,
                 const Assignment& assignment, const Pose& X_RH) {
  const double at_1m = mean_size_at_1m(reading, settings.leds, assignment, X_RH);
  double unequal = 0;
  double unlike = 0;
  each_blob(reading, settings.leds, assignment, X_RH, [&](const Blob& blob, double distance) {
    const double expected = std::clamp(at_1m / distance, 1.0, 15.0);
    unequal += (blob.size - expected) * (blob.size - expected);
    const double learned = size.at_1m > 0 ? std::clamp(size.at_1m / distance, 1.0, 15.0) : expected;
    unlike += (expected - learned) * (expected - learned);
  });
  const Thresholds& n = settings.thresholds;
  return unequal / (n.size_sigma * n.size_sigma) + unlike / (n.size_spread * n.size_spread);
}

/// Depth-first over the assignments of blobs to the first `count` LEDs.
struct AssignmentSearch {
  const Reading& reading;
  const TrackerSettings& settings;
  const Pinhole& pinhole;
  const PoseSolver& solver;
  const Upright& upright;
  LedSize size;
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
      if (!solved.found) continue;
      const double cost = solved.cost + size_cost(size, reading, settings, current, solved.X_RH);
      if (cost > settings.thresholds.acquisition_cost_per_led * n || (best.solved.found && cost >= best.cost)) continue;
      best = {solved, current, cost};
    }
  }
};

/// LEDs without a blob that would be seen, well within the image.
int missing_in_view(const TrackerSettings& settings, const PoseSolver& solver, const Acquired& head) {
  int missing = 0;
  const double edge = settings.thresholds.pixel_gate;
  for (std::size_t led = 0; led < static_cast<std::size_t>(settings.leds.count); ++led) {
    Eigen::Vector2d pixel;
    if (head.blob[led] >= 0 || !solver.project(head.solved.X_RH, settings.leds.p_H[led], 0, pixel)) continue;
    const bool in_view =
        pixel.x() > edge && pixel.x() < kWidth - edge && pixel.y() > edge && pixel.y() < kHeight - edge;
    missing += in_view ? 1 : 0;
  }
  return missing;
}

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
                      const PoseSolver& solver, const Upright& upright, LedSize size) {
  for (int i = 0; i < 3; ++i) VERISIM_ASSERT(is_unit(Vector3d(upright.C_LR.row(i))));
  const int count = std::min(settings.leds.count, reading.blob_count);
  if (count < 3) return {};
  AssignmentSearch search{reading, settings, pinhole, solver, upright, size, count};
  search.descend(0, 0);
  return search.best;
}

Acquired acquire_head_from_two(const Reading& reading, const TrackerSettings& settings, const Pinhole& pinhole,
                               const PoseSolver& solver, const Upright& upright, LedSize size) {
  if (reading.blob_count != 2) return {};
  Acquired best, second;
  for (std::size_t i = 0; i < static_cast<std::size_t>(settings.leds.count); ++i)
    for (std::size_t j = 0; j < static_cast<std::size_t>(settings.leds.count); ++j) {
      if (i == j) continue;
      Acquired here;
      here.blob[i] = 0;
      here.blob[j] = 1;
      const auto ray = [&](std::size_t b) { return pinhole.ray(reading.blobs[b].u, reading.blobs[b].v); };
      const TwoPointPose two = solve_two_points({settings.leds.p_H[i], settings.leds.p_H[j]}, ray(0), ray(1),
                                                upright.C_LR, settings.thresholds.forward_min);
      if (!two.found || two.cos_roll <= 0) continue;
      std::array<Sighting, kLedsMax> sightings;
      const int n = sightings_of(reading, settings.leds, here.blob, 0, sightings);
      const Quaterniond C_RL = Quaterniond(upright.C_LR).conjugate();
      here.solved = solver.solve(std::span(sightings).first(static_cast<std::size_t>(n)), upright,
                                 {C_RL * two.p_L, (C_RL * rotation_about_z(two.cos_roll, two.sin_roll)).normalized()});
      if (!here.solved.found) continue;
      here.cost = here.solved.cost + size_cost(size, reading, settings, here.blob, here.solved.X_RH) +
                  settings.thresholds.missing_led_cost * missing_in_view(settings, solver, here);
      if (!best.solved.found || here.cost < best.cost) std::swap(best, here);
      if (here.solved.found && (!second.solved.found || here.cost < second.cost)) second = here;
    }
  const Thresholds& limits = settings.thresholds;
  const bool alone = !second.solved.found || second.cost > best.cost + 2 * limits.acquisition_cost_per_led;
  return best.solved.found && best.cost <= 2 * limits.acquisition_cost_per_led && alone ? best : Acquired{};
}

void learn_size(LedSize& size, const Reading& reading, const TrackerSettings& settings, const Assignment& assignment,
                const Pose& X_RH) {
  const double here = mean_size_at_1m(reading, settings.leds, assignment, X_RH);
  size.at_1m = size.at_1m > 0 ? size.at_1m + settings.thresholds.size_learning * (here - size.at_1m) : here;
}

}  // namespace verisim::wii
