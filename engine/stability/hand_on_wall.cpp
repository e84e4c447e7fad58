#include "engine/stability/hand_on_wall.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"
#include "engine/device/hand.hpp"
#include "engine/device/hardware.hpp"
#include "engine/device/sources.hpp"
#include "engine/stability/parts.hpp"

namespace verisim::stability {
namespace {

constexpr double kWallMass = 1e9;     // kg
constexpr double kHandSpring = 1e-6;  // of the wall's: pushes, and is too weak to matter
constexpr double kTeleport = 1e12;    // m/s

Scene scene_of(const HandOnWall& h, std::shared_ptr<Device> source) {
  VERISIM_ASSERT(is_positive(h.stiffness));
  VERISIM_ASSERT(is_positive(h.period));
  VERISIM_ASSERT(h.frames > 0 && h.frames % 2 == 0);
  Scene scene;
  SimulationParameters& p = scene.parameters;
  p.timestep = h.period / h.frames;
  p.hybrid = hybrid::off;
  p.stability_rule = false;
  p.max_stiffness = h.stiffness;
  p.coupling_damping_ratio = h.wall_damping / h.frames / (2 * std::sqrt(h.stiffness * kWallMass));
  scene.bodies = {box_body("wall", {0.1, 0.1, 0.1}, kWallMass, 0.01)};
  HardwareDescription hardware;
  hardware.name = "device";
  hardware.resolution = h.resolution;
  hardware.rate = 1 / h.period;
  hardware.delay = 0.5 * h.periods_late * h.period;
  hardware.load.friction = h.friction;
  scene.devices = {make_hardware(hardware, std::move(source))};
  scene.grasps = {{0, 0}};
  return scene;
}

/// A triangle about `about`, a straight line in each period.
std::shared_ptr<Device> to_and_fro(const HandOnWall& h, double way, double about, unsigned periods) {
  HapticSamples samples;
  for (unsigned i = 0; i <= periods; ++i) {
    samples.t.push_back(i * h.period);
    samples.pose.push_back({{about + (i % 2 == 0 ? -way / 2 : way / 2), 0, 0}, Quaterniond::Identity()});
  }
  return make_replay("hand", std::move(samples));
}

}  // namespace

double stable_stiffness(const HandOnWall& h) {
  return (h.damping + h.wall_damping) / (h.period * (0.5 + h.periods_late));
}

double passive_stiffness(const HandOnWall& h) {
  const double damped = 2 * (h.damping - h.wall_damping) / h.period;
  return h.resolution > 0 ? std::min(damped, 2 * h.friction / h.resolution) : damped;
}

Verdict hold(const HandOnWall& h, unsigned blocks_max) {
  VERISIM_ASSERT(is_positive(h.mass));
  VERISIM_ASSERT(is_positive(h.push));
  HandDescription hand;
  hand.mass = h.mass;
  hand.damping = h.damping;
  hand.stiffness = kHandSpring * h.stiffness;
  const double target = h.push / kHandSpring;
  hand.path = {{Pose{}, kTeleport, 0}, {Pose{{target, 0, 0}, Quaterniond::Identity()}, kTeleport, 0}};
  const std::shared_ptr<Device> source = make_hand(hand);
  Simulation simulation(scene_of(h, source), {});
  const double rest = h.push / (1 + kHandSpring);
  const bool may_stick = h.resolution > 0 || h.friction > 0;  // then it rests somewhere near: its speed tells
  const double way_by_speed = std::sqrt(h.mass / h.stiffness);
  double before = 0;
  const auto distance = [&] {
    const double x = source->reading().handle.position.x();
    const double v = (x - std::exchange(before, x)) / simulation.dt();
    return may_stick ? way_by_speed * v : x - rest;
  };
  const double swing_s = 2 * pinned::kPi * std::sqrt(h.mass / h.stiffness);
  const auto frames_first = static_cast<std::uint64_t>(std::ceil(2 * swing_s / h.period)) * h.frames;
  return watch(simulation, distance, h.push, {frames_first, blocks_max, !may_stick});
}

std::optional<double> bound_of(HandOnWall h) {
  return last_stable(50, 5e4, 2e-3, [&](double stiffness) {
    h.stiffness = stiffness;
    return hold(h).outcome == Outcome::stable;
  });
}

double energy_taken(const HandOnWall& h, double way, double about, unsigned cycles) {
  VERISIM_ASSERT(is_positive(way));
  const unsigned settling = 2 * h.periods_late + 2;  // periods, until the force is that of the motion alone
  const std::shared_ptr<Device> source = to_and_fro(h, way, about, settling + 2 * cycles + 2);
  const Scene scene = scene_of(h, source);
  const std::shared_ptr<Device> device = scene.devices[0];
  Simulation simulation(scene, {});
  double taken = 0, x_before = 0, force_before = 0;
  for (unsigned i = 0; i <= h.frames * (settling + 2 * cycles); ++i) {
    simulation.step();
    const double x = source->reading().handle.position.x();
    const double moved = x - x_before;
    const double v = moved / simulation.dt();
    // What is rendered in a frame acts until the next.
    if (i > h.frames * settling) taken += h.damping * v * moved + h.friction * std::abs(moved) - force_before * moved;
    x_before = x;
    force_before = device->rendered().force.x();
  }
  return taken;
}

std::optional<double> passive_bound_of(HandOnWall h, const std::vector<double>& ways) {
  return last_stable(1, 1e7, 1e-3, [&](double stiffness) {
    h.stiffness = stiffness;
    for (const double way : ways)
      for (const double about : {0.0, 0.5 * h.resolution})
        if (energy_taken(h, way, about) < 0) return false;
    return true;
  });
}

}  // namespace verisim::stability
