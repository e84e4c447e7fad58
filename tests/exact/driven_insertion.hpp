// The driven insertion of ../shared/reference/peers/README.md: the hand leans by half a degree, is 1 mm off the axis
// and pushes the pin down at 50 mm/s to 20 mm below the block.
#pragma once

#include "tests/exact/held_pin.hpp"

namespace verisim::exact::test {

enum class Start { engaged_10mm, above };

struct Insertion {
  double clearance;
  Start start = Start::engaged_10mm;
  double chamfer = 0;
  double spacing = 0.0045;
  double force_max = 100, torque_max = 5;
  double push = 1;  ///< multiplies the coupling's stiffness
  LoadOptions load = {};
  BodyOptions options = {};
  SearchThresholds thresholds = {};
};

struct Outcome {
  double bottom = 0;       ///< m, height of the pin's lower end at the end of the run
  double force_max = 0;    ///< N
  double overlap_max = 0;  ///< m
  double jump_max = 0;     ///< N, largest change of the contact force from frame to frame
  double iterations = 0;   ///< mean
  int iterations_max = 0;
  double rows = 0;  ///< mean
  Pose pose;
  Wrench coupling;
};

[[nodiscard]] inline Hand hand_at(const Insertion& task, double t) {
  constexpr double kDegree = 3.14159265358979323846 / 180;
  const Vector3d beside(std::cos(20 * kDegree), std::sin(20 * kDegree), 0);
  const bool engaged = task.start == Start::engaged_10mm;
  const double wait = engaged ? 0.5 : 0;
  const double fade = engaged ? std::min(1.0, t / 0.5) : 1;
  const double top = kBlockHeight / 2 + (engaged ? -0.01 : 0.01);
  const double end = -kBlockHeight / 2 - 0.02;
  const double z = std::max(end, top - 0.05 * std::max(0.0, t - wait));
  Hand hand;
  hand.rotation = rotation_from_vector(fade * 0.5 * kDegree * Vector3d::UnitZ().cross(beside));
  hand.position = fade * 1e-3 * beside + Vector3d(0, 0, z) + hand.rotation * Vector3d(0, 0, kPinLength / 2);
  hand.velocity = {0, 0, z > end && t > wait ? -0.05 : 0};
  return hand;
}

[[nodiscard]] inline int steps_of(const Insertion& task) {
  const double way = kBlockHeight + 0.02 + (task.start == Start::engaged_10mm ? -0.01 : 0.01);
  const double seconds = (task.start == Start::engaged_10mm ? 0.5 : 0) + way / 0.05 + 0.5;
  return static_cast<int>(std::lround(seconds / 0.001));
}

[[nodiscard]] inline HeldPin pin_for(const Insertion& task) {
  HeldPin pin(task.clearance, task.chamfer, task.spacing, task.load, task.options, task.thresholds);
  pin.force_max = task.force_max;
  pin.torque_max = task.torque_max;
  pin.stiffness *= task.push;
  const Hand hand = hand_at(task, 0);
  pin.X_WB = {hand.position, hand.rotation};
  return pin;
}

/// Runs it; `each(pin, frame)` is called after every step.
template <typename Each>
[[nodiscard]] Outcome run(const Insertion& task, Each&& each) {
  HeldPin pin = pin_for(task);
  Outcome outcome;
  const int steps = steps_of(task);
  Vector3d force_before = Vector3d::Zero();
  for (int i = 0; i < steps; ++i) {
    pin.step(hand_at(task, i * pin.dt));
    outcome.force_max = std::max(outcome.force_max, pin.contact_force.norm());
    outcome.jump_max = std::max(outcome.jump_max, (pin.contact_force - force_before).norm());
    force_before = pin.contact_force;
    if (i % 5 == 0 || task.clearance < 1e-4) outcome.overlap_max = std::max(outcome.overlap_max, pin.overlap());
    outcome.iterations += pin.iterations;
    outcome.iterations_max = std::max(outcome.iterations_max, pin.iterations);
    outcome.rows += static_cast<double>(pin.link.rows().rows().size());
    each(pin, i);
  }
  outcome.iterations /= steps;
  outcome.rows /= steps;
  outcome.bottom = pin.X_WB.position.z() - pin.X_WB.rotation.toRotationMatrix()(2, 2) * kPinLength / 2;
  outcome.pose = pin.X_WB;
  outcome.coupling = pin.coupling;
  return outcome;
}
[[nodiscard]] inline Outcome run(const Insertion& task) {
  return run(task, [](const HeldPin&, int) {});
}

}  // namespace verisim::exact::test
