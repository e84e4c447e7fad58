// Forces on the robot: energy and momentum, grip, gaps, loads, and what a haptic device's reaction does.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"
#include "tests/robot/plants.hpp"

namespace verisim::robot::plant_forces_test {
namespace {

using plants::block_all;
using plants::drive;
using plants::kOff;
using plants::without_losses;

Reaction push(double x, double y, double height = 0) {
  return {{x, y, 0}, Vector3d::Zero(), {0, 0, height}};
}

// Both sums close to rounding: some 1e5 terms that add up to 100 J, each computed from its own force, current or speed.
TEST(PlantEnergy, IsWhatTheSupplyAndThePushGaveLessHeat) {
  Plant plant(PlantParameters{});
  for (int i = 0; i < 3000; ++i) {
    const auto d = static_cast<std::int16_t>(i < 1000 ? 220 : i < 1500 ? -180 : i < 2000 ? 0 : 90);
    plant.advance({d, static_cast<std::int16_t>(-d / 2), d, d}, {{10, 25, -30}, {0, 0, 2}, {0.3, 0.1, 0.9}});
  }
  const ElectricalBook& e = plant.electrical_book();
  const MechanicalBook& m = plant.mechanics().book();
  EXPECT_GT(e.source, 20);
  EXPECT_NEAR(e.battery + e.bridges + e.windings + m.motors + plant.coil_energy(), e.source, 1e-6 * e.source);
  EXPECT_NEAR(m.friction + m.gears + m.floor + plant.mechanics().kinetic_energy() + plant.mechanics().stored_energy(),
              m.motors + m.outside, 1e-9 * e.source);
  for (const double heat : {e.battery, e.bridges, e.windings, m.friction, m.gears, m.floor}) EXPECT_GT(heat, 0);
}

TEST(PlantEnergy, NeverGrowsByItself) {
  Plant plant(PlantParameters{});
  drive(plant, {255, 200, 150, 255}, 700);
  double before = plant.mechanics().kinetic_energy() + plant.mechanics().stored_energy();
  for (int i = 0; i < 1500; ++i) {
    plant.advance(kOff, {});
    const double now = plant.mechanics().kinetic_energy() + plant.mechanics().stored_energy();
    ASSERT_LE(now, before * (1 + 1e-12));
    before = now;
  }
  EXPECT_LT(before, 1e-3);
  EXPECT_NEAR(plant.state().twist.vx, 0, 1e-9);
}

// Whatever is asked of it: books that close, heat that does not cool, and next to no step that did not settle (4 in
// 4.8 million were seen; their forces act as they were found).
TEST(PlantEnergy, ClosesUnderRandomDutiesPushesAndFaults) {
  std::uint64_t unsettled = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(seed);
    const RandomStream random(seed, "errand");
    std::uint64_t draws = 0;
    const auto draw = [&](double range) { return range * (2 * random.uniform(draws++) - 1); };
    PlantParameters p;
    p.body.centre_of_mass = {draw(0.03), draw(0.03)};
    Plant plant(p);
    plants::Duties duty = kOff;
    Reaction reaction;
    for (int i = 0; i < 2000; ++i) {
      if (i % 97 == 0) {
        for (auto& d : duty) d = static_cast<std::int16_t>(draw(255));
        reaction = {{draw(20), draw(20), draw(20)}, {0, 0, draw(4)}, {0.4, 0.1, 1}};
        plant.set_blocked(static_cast<std::size_t>(i) % kWheels, draw(1) > 0.8);
        plant.set_supplied(draw(1) > -0.9);
      }
      plant.advance(duty, reaction);
    }
    const MechanicalBook& m = plant.mechanics().book();
    const ElectricalBook& e = plant.electrical_book();
    EXPECT_NEAR(m.friction + m.gears + m.floor + plant.mechanics().kinetic_energy() + plant.mechanics().stored_energy(),
                m.motors + m.outside, 1e-9 * e.source);
    EXPECT_NEAR(e.battery + e.bridges + e.windings + m.motors + plant.coil_energy(), e.source, 1e-4 * e.source);
    for (const double heat : {e.battery, e.bridges, e.windings, m.friction, m.gears, m.floor}) EXPECT_GT(heat, 0);
    unsettled += plant.unsettled();
  }
  EXPECT_LE(unsettled, 5u);  // of 480,000
}

// Nothing but the push: its impulse is the momentum; then the centre of mass goes straight and the base spins evenly.
TEST(PlantMomentum, IsKeptOnAFrictionlessFloor) {
  PlantParameters p;
  p.wheel.friction = p.wheel.roller_resistance = 0;
  p.body.centre_of_mass = {0.05, 0.02};
  Plant plant(p);
  drive(plant, kOff, 1, {{0, 200, 0}, Vector3d::Zero(), {0.05, 0.02, 0}});
  EXPECT_NEAR(plant.mechanics().velocity().y(), 200 * 1e-3 / 28, 1e-15);  // through the centre: no spin
  EXPECT_NEAR(plant.state().twist.omega, 0, 1e-15);
  drive(plant, kOff, 1, {Vector3d::Zero(), {0, 0, 700}, Vector3d::Zero()});
  EXPECT_NEAR(plant.state().twist.omega, 700 * 1e-3 / 0.7, 1e-12);
  const auto centre = [&] {
    const PlanarPose X = plant.state().pose;
    return Vector3d(X.x + std::cos(X.theta) * 0.05 - std::sin(X.theta) * 0.02,
                    X.y + std::sin(X.theta) * 0.05 + std::cos(X.theta) * 0.02, X.theta);
  };
  const Vector3d before = centre();
  drive(plant, kOff, 5000);
  const Vector3d way = (centre() - before) / 5;
  // 40000 rotations of the coordinates by 1.25e-4 rad each miss by (1.25e-4)^3 / 12 each.
  EXPECT_NEAR(way.x(), 0, 1e-10);
  EXPECT_NEAR(way.y(), 200 * 1e-3 / 28, 1e-10);
  EXPECT_NEAR(way.z(), 1, 1e-12);
}

// Held wheels push along their rollers' axles with mu N at most, across them with c N: along x, (mu + c) m g / sqrt 2.
// That is what mecanum wheels lack: rubber alone would hold mu m g.
TEST(PlantGrip, HoldsAPushUpToItsFrictionAndNotAbove) {
  const PlantParameters p = without_losses();
  const double grip = (p.wheel.friction + p.wheel.roller_resistance) * p.body.mass * p.gravity / std::sqrt(2.0);
  for (const bool sideways : {false, true}) {
    Plant held(p), pushed(p);
    block_all(held);
    block_all(pushed);
    const auto along = [&](double f) { return sideways ? push(0, f) : push(f, 0); };
    plants::lean(held, along(0.999 * grip), 1000);
    EXPECT_NEAR(std::hypot(held.state().twist.vx, held.state().twist.vy), 0, 1e-9);
    EXPECT_LT(std::hypot(held.state().pose.x, held.state().pose.y), 0.2e-3);  // what the rubber gives
    plants::lean(pushed, along(1.01 * grip), 2000);
    const double speed = sideways ? pushed.state().twist.vy : pushed.state().twist.vx;
    // It accelerates by what is left over, also in the last 1 % of the ramp, and a little late.
    EXPECT_NEAR(speed, 2 * 0.01 * grip / p.body.mass, 0.01 * speed);
    EXPECT_EQ(pushed.state().counts[0], 0);  // its encoders see nothing of it
  }
}

// mu N at a lever of (l + w) / sqrt 2 each; rollers do not turn where l = w. Section 5.5: torques turn the base, unseen
// by its encoders, and the device's 35 N at 0.45 m with its 3.1 N m are such a torque.
TEST(PlantGrip, IsTurnedByTheTorqueOfAPowerfulCollision) {
  const PlantParameters p = without_losses();
  const double grip = p.wheel.friction * p.body.mass * p.gravity * 0.3 / std::sqrt(2.0);
  EXPECT_NEAR(grip, 17.5, 0.05);
  EXPECT_GT(35 * 0.45 + 3.1, grip);
  for (const double torque : {0.999 * grip, 35 * 0.45 + 3.1}) {
    Plant plant(p);
    block_all(plant);
    plants::lean(plant, {Vector3d::Zero(), {0, 0, torque}, Vector3d::Zero()}, 500);
    if (torque < grip) {
      EXPECT_LT(plant.state().pose.theta, 1e-3);
    } else {
      const double omega = plant.state().twist.omega;
      EXPECT_NEAR(omega, 0.5 * (torque - grip) / p.body.inertia, 0.1 * omega);
      EXPECT_GT(plant.state().slip[1], 0.05);
      EXPECT_EQ(plant.state().counts[1], 0);
    }
  }
}

// The wheels turn by the gap while the motors stand: r * backlash from flank to flank.
TEST(PlantGear, GivesByItsBacklash) {
  PlantParameters p = without_losses();
  p.gear.backlash = 0.0175;
  p.wheel.rolling_resistance = p.wheel.roller_resistance = 0;
  Plant plant(p);
  block_all(plant);
  const auto rests_at = [&](double force) {
    drive(plant, kOff, 1500, push(force, 0));
    EXPECT_NEAR(plant.state().twist.vx, 0, 1e-9);
    return plant.state().pose.x;
  };
  const double force = 0.5;  // the base meets a flank at 4 mm/s: no wheel slips
  const double front = rests_at(force), back = rests_at(-force);
  EXPECT_NEAR(front - back, p.geometry.wheel_radius * p.gear.backlash, 2 * force / (2 * p.wheel.stiffness) + 1e-6);
  EXPECT_NEAR(front, p.geometry.wheel_radius * p.gear.backlash / 2, force / (2 * p.wheel.stiffness) + 1e-6);
}

// A gear that is driven from the wheel turns the motor when T eta' / ratio exceeds its friction: 4 f r on the floor.
TEST(PlantGear, IsDrivenBackwardsAboveTheMotorsFriction) {
  PlantParameters p;
  p.wheel.rolling_resistance = 0;
  const double torque = dry_friction(p.motor) * p.gear.ratio / p.gear.efficiency_driven;
  const double force = 4 * torque / p.geometry.wheel_radius;
  Plant held(p), moved(p);
  plants::lean(held, push(0.99 * force, 0), 1000);
  plants::lean(moved, push(1.01 * force, 0), 1000);
  EXPECT_NEAR(held.state().twist.vx, 0, 1e-9);
  EXPECT_GT(moved.state().twist.vx, 1e-3);
}

TEST(PlantLoads, CarryTheWeightAndTheMomentsOfAReaction) {
  const PlantParameters p = without_losses();
  const double weight = p.body.mass * p.gravity;
  Plant plant(p);
  block_all(plant);
  // Pulled up by 20 N at the right front wheel, pushed back by 15 N at a height of 0.8 m.
  drive(plant, kOff, 1000, {{-15, 0, 20}, Vector3d::Zero(), {0.15, -0.15, 0.8}});
  const PerWheel N = plant.state().load;
  const double total = N[0] + N[1] + N[2] + N[3];
  EXPECT_NEAR(total, weight - 20, 1e-9);
  // About the wheels' middle: x: -0.15 * 20 - 15 * 0.8, y: 0.15 * 20.
  EXPECT_NEAR(0.15 * (N[0] + N[1] - N[2] - N[3]), -0.15 * 20 - 15 * 0.8, 1e-6);
  EXPECT_NEAR(0.15 * (N[0] + N[2] - N[1] - N[3]), 0.15 * 20, 1e-6);
  EXPECT_EQ(plant.tipping(), 0u);
}

TEST(PlantLoads, LiftAWheelAndSaySo) {
  const PlantParameters p = without_losses();
  Plant plant(p);
  block_all(plant);
  drive(plant, kOff, 10, {Vector3d::Zero(), {50, 0, 0}, Vector3d::Zero()});  // m g w = 41 N m tips it
  const PerWheel N = plant.state().load;
  EXPECT_EQ(N[kFrontLeft], 0);
  EXPECT_GT(plant.tipping(), 0u);
  EXPECT_NEAR(N[0] + N[1] + N[2] + N[3], p.body.mass * p.gravity, 1e-9);
}

TEST(PlantFaults, OneBlockedMotorDrawsItsStallCurrentAndTheRobotGoesOn) {
  Plant plant(PlantParameters{});
  plant.set_blocked(kFrontLeft, true);
  drive(plant, {200, 200, 200, 200}, 2000);
  const PlantState& s = plant.state();
  EXPECT_EQ(s.motor_speed[kFrontLeft], 0);
  EXPECT_NEAR(s.current[kFrontLeft], (200.0 / 255 * s.supply_voltage - 1.4) / (1.9 + 1.15), 1e-6);
  EXPECT_GT(std::abs(s.motor_speed[kRearLeft]), 10);
  EXPECT_GT(std::abs(s.slip[kFrontLeft]) + std::abs(s.slip[kRearRight]), 0);
  EXPECT_EQ(plant.unsettled(), 0u);
}

TEST(PlantFaults, StopsWithoutSupplyAndGoesOnWithIt) {
  Plant plant(PlantParameters{});
  drive(plant, {200, 200, 200, 200}, 1000);
  plant.set_supplied(false);
  drive(plant, {200, 200, 200, 200}, 1000);
  EXPECT_NEAR(plant.state().twist.vx, 0, 1e-9);
  plant.set_supplied(true);
  plant.set_supply_voltage(6);
  drive(plant, {200, 200, 200, 200}, 1000);
  EXPECT_GT(plant.state().twist.vx, 0.1);
  EXPECT_LT(plant.state().twist.vx, 0.2);
}

TEST(PlantFaults, OneEncoderIsDeadAndOneCountsBackwardsWhileTheRobotDrivesOn) {
  Plant whole(PlantParameters{}), faulty(PlantParameters{});
  faulty.set_encoder_fault(kFrontRight, EncoderFault::dead);
  faulty.set_encoder_fault(kRearLeft, EncoderFault::reversed);
  drive(whole, {200, 200, 200, 200}, 1000);
  drive(faulty, {200, 200, 200, 200}, 1000);
  EXPECT_GT(whole.state().counts[kRearLeft], 1000);
  EXPECT_EQ(faulty.state().counts[kFrontRight], 0);
  EXPECT_EQ(faulty.state().counts[kRearLeft], -whole.state().counts[kRearLeft]);
  EXPECT_EQ(faulty.state().counts[kFrontLeft], whole.state().counts[kFrontLeft]);
  EXPECT_EQ(faulty.state().pose.x, whole.state().pose.x);
}

TEST(PlantParametersCheck, NamesWhatIsOutOfRange) {
  PlantParameters p;
  p.body.mass = -1;
  try {
    Plant plant(p);
    FAIL();
  } catch (const Error& e) {
    EXPECT_STREQ(e.what(), "robot: mass is -1 but must be above 0");
  }
  p = {};
  p.substeps = 7;
  EXPECT_THROW(Plant{p}, Error);
  p = {};
  p.gear.efficiency = 1.2;
  EXPECT_THROW(Plant{p}, Error);
}

}  // namespace
}  // namespace verisim::robot::plant_forces_test
