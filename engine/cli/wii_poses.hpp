// Files of poses that a tracker left behind.
#pragma once

#include <string>
#include <vector>

#include "engine/base/user_file.hpp"
#include "engine/wii/tracker.hpp"

namespace verisim::cli {

/// The reports in a file, by its form:
///   - `wii track`'s CSV, short or with --full;
///   - TUM: lines of `t x y z qx qy qz qw` between blanks, '#' begins a comment;
///   - any CSV with column names. It has `t` and `px … qw`, or `columns` says what they are called there: "t=time
///     px=x …", optionally `valid` (0: no pose) and the variances.
/// Rows that are not valid may have any pose; in the others quaternions of length 0.5 to 2 are normalised. A
/// covariance that is not stated is NaN. Error(input) with file and line. Adds to `opened` which file it is.
[[nodiscard]] std::vector<wii::Report> read_poses(const std::string& file, const std::string& columns,
                                                  std::vector<FileIdentity>& opened);

/// One line `t,valid,px,…,qw` with what may follow it, as a program answers. Error(input) beginning with `where`.
[[nodiscard]] wii::Report parse_pose_line(const std::string& where, const std::string& line);

}  // namespace verisim::cli
