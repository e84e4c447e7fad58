// Plants for tests: with what would hide a closed form taken away.
#pragma once

#include <array>
#include <cstdint>

#include "engine/robot/plant.hpp"

namespace verisim::robot::plants {

using Duties = std::array<std::int16_t, kWheels>;

inline constexpr Duties kOff = {0, 0, 0, 0};

/// A supply, bridges and gears without losses.
[[nodiscard]] inline PlantParameters without_losses() {
  PlantParameters p;
  p.bridge = {0, 0};
  p.supply.resistance = 0;
  p.gear.efficiency = p.gear.efficiency_driven = 1;
  p.gear.backlash = 0;
  return p;
}

/// Motors alone: wheels in the air and next to weightless.
[[nodiscard]] inline PlantParameters on_a_stand() {
  PlantParameters p = without_losses();
  p.gravity = 0;
  p.wheel.inertia = 1e-9;
  return p;
}

inline void drive(Plant& plant, const Duties& duty, int milliseconds, const Reaction& reaction = {}) {
  for (int i = 0; i < milliseconds; ++i) plant.advance(duty, reaction);
}

/// Slowly up to the push, so that it acts alone and not with the speed that it gave, and on with it.
inline void lean(Plant& plant, const Reaction& reaction, int milliseconds) {
  constexpr int kRamp = 1000;
  for (int i = 0; i < kRamp; ++i) {
    const double part = static_cast<double>(i) / kRamp;
    plant.advance(kOff, {part * reaction.force, part * reaction.torque, reaction.point});
  }
  drive(plant, kOff, milliseconds, reaction);
}

/// Slowly up to the duties, so that no wheel slips, and on with them.
inline void start(Plant& plant, const Duties& duty, int milliseconds) {
  constexpr int kRamp = 1000;
  for (int i = 0; i < kRamp; ++i) {
    Duties part;
    for (std::size_t w = 0; w < kWheels; ++w) part[w] = static_cast<std::int16_t>(duty[w] * i / kRamp);
    plant.advance(part, {});
  }
  drive(plant, duty, milliseconds);
}

inline void block_all(Plant& plant) {
  for (std::size_t i = 0; i < kWheels; ++i) plant.set_blocked(i, true);
}

}  // namespace verisim::robot::plants
