#include "engine/robot/plant_parameters.hpp"

#include <cmath>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/robot/encoder.hpp"

namespace verisim::robot {
namespace {

void positive(const char* name, double value) {
  if (!is_positive(value)) fail(ErrorKind::usage, "robot: {} is {} but must be above 0", name, value);
}

void not_negative(const char* name, double value) {
  if (!is_not_negative(value)) fail(ErrorKind::usage, "robot: {} is {} but must not be negative", name, value);
}

void efficiency(const char* name, double value) {
  if (!(value > 0) || value > 1)
    fail(ErrorKind::usage, "robot: {} is {} but must be above 0 and at most 1", name, value);
}

}  // namespace

void check(const PlantParameters& p) {
  positive("half_base", p.geometry.half_base);
  positive("half_track", p.geometry.half_track);
  positive("wheel_radius", p.geometry.wheel_radius);
  positive("torque_constant", p.motor.torque_constant);
  positive("resistance of the motor", p.motor.resistance);
  positive("inductance", p.motor.inductance);
  positive("inertia of the motor", p.motor.inertia);
  not_negative("dry friction that follows from no_load_speed", dry_friction(p.motor));
  not_negative("drop", p.bridge.drop);
  not_negative("drop_per_ampere", p.bridge.drop_per_ampere);
  positive("gear ratio", p.gear.ratio);
  not_negative("backlash", p.gear.backlash);
  efficiency("gear efficiency", p.gear.efficiency);
  efficiency("gear efficiency_driven", p.gear.efficiency_driven);
  positive("inertia of a wheel", p.wheel.inertia);
  not_negative("friction of a roller", p.wheel.friction);
  not_negative("roller_resistance", p.wheel.roller_resistance);
  not_negative("rolling_resistance", p.wheel.rolling_resistance);
  positive("stiffness of a roller", p.wheel.stiffness);
  not_negative("damping of a roller", p.wheel.damping);
  positive("mass", p.body.mass);
  positive("inertia of the base", p.body.inertia);
  for (const double c : p.body.centre_of_mass)
    if (!std::isfinite(c)) fail(ErrorKind::usage, "robot: centre_of_mass is not finite");
  not_negative("height of the centre of mass", p.body.height);
  not_negative("voltage of the supply", p.supply.voltage);
  not_negative("resistance of the supply", p.supply.resistance);
  not_negative("gravity", p.gravity);
  if (p.substeps < 1 || kCyclesPerMillisecond % static_cast<std::uint32_t>(p.substeps) != 0)
    fail(ErrorKind::usage, "robot: substeps is {} but must divide {}; 8 is usual", p.substeps, kCyclesPerMillisecond);
}

}  // namespace verisim::robot
