// A tracker of the user's own against the truth, by the measures of validate.hpp: what it reported, wherever it ran, is
// laid beside the reports that it was fed and the true poses.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/wii/validate.hpp"

namespace verisim::wii {

/// How the tracker's coordinates are brought onto the truth's, by least squares over the positions.
enum class Alignment {
  none,
  yaw,  ///< a turn about +y and a shift: what a levelled tracker cannot know
  se3,  ///< any turn and a shift
};

/// What is added to the tracker's times.
struct TimeOffset {
  enum class Kind { given, start, found };
  Kind kind = Kind::given;
  double seconds = 0;  ///< of given; start: the first report is put onto the first sample; found: what fits best
};

struct JudgeOptions {
  std::string name = "tracker";  ///< of the row, beside its trajectory and sensor
  std::string trajectory, sensor;
  Alignment alignment = Alignment::none;
  TimeOffset time_offset;
};

struct Judgement {
  ValidationRow row;
  std::vector<ErrorSample> history;
  Pose X_TE;                            ///< from the tracker's coordinates to the truth's, as applied
  double offset = 0;                    ///< s, as added to the tracker's times
  std::optional<double> offset_better;  ///< s, beyond that: where positions fit best; none: the head hardly moves
  int outside = 0;  ///< reports that no truth stands beside: before, after, or in a gap of over 0.1 s
  int unanswered =
      0;  ///< samples to which the tracker reported nothing within half a period (of the slower): not valid
};

/// `reports` in the order of their times, a covariance that was not stated NaN. A report between two samples is laid
/// beside the truth between theirs (linear, slerp). Reports and samples at equal times give the row of validate_one.
/// Error(input) for no sample or no valid report, times that do not grow, no report within the samples' time, an
/// alignment of a head that hardly moves.
/// Cost: a pass over both, and 150 passes to find the offset.
[[nodiscard]] Judgement judge(std::span<const SensedReport> samples, std::span<const Report> reports,
                              const JudgeOptions& options);

/// Which LEDs a recorded report shows, where nobody wrote it down: as many of the first as there are blobs.
[[nodiscard]] unsigned leds_by_count(const Channels& channels);

}  // namespace verisim::wii
