// One row of the validation by name, without timing.
#pragma once

#include <string>

#include "engine/wii/validate.hpp"

namespace verisim::wii {

inline ValidationRow row_of(const std::string& tracker, const std::string& path, const std::string& sensor = "ideal") {
  ValidationOptions options;
  options.trackers = {tracker};
  options.trajectories = {path};
  options.sensors = {sensor};
  options.measure_time = false;
  return validate(options).front();
}

}  // namespace verisim::wii
