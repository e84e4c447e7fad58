// The validation as pictures: SVG text, without fonts, scripts or times in it, so that equal figures give equal files.
#pragma once

#include <string>
#include <vector>

#include "engine/wii/validate.hpp"

namespace verisim::wii {

/// Position error of every tracker on every trajectory, one panel per sensor: a dot at the rms, a line to the maximum,
/// logarithmic, cm. Trackers that were never valid on a trajectory have no dot there.
[[nodiscard]] std::string overview_plot(const std::vector<ValidationRow>& rows);

/// One tracker's position error over time.
struct ErrorHistory {
  std::string tracker;
  std::vector<ErrorSample> samples;
};
/// Position error over time, logarithmic, cm: the worst in each of 400 steps as a line, interrupted where nothing was
/// valid, and pale the 95 % bound that the tracker gave itself.
[[nodiscard]] std::string history_plot(const std::string& title, const std::vector<ErrorHistory>& histories);

}  // namespace verisim::wii
