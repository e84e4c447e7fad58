// Collects one run's errors and turns them into a row of the table.
#pragma once

#include <vector>

#include "engine/wii/validate.hpp"

namespace verisim::wii {

class ValidationFigures {
 public:
  /// A report that arrived, with the truth beside it, and what the tracker said to it.
  void add(const SensedReport& sensed, const Report& report);
  /// Everything but the names and the time.
  [[nodiscard]] ValidationRow result() const;

 private:
  void add_valid(const SensedReport& sensed, const Report& report, const Vector3d& velocity);

  ValidationRow counts_;
  std::vector<Vector3d> position_errors_;     ///< m
  std::vector<Vector3d> orientation_errors_;  ///< rad
  std::vector<double> nees_;                  ///< of the position, over 3
  std::vector<double> orientation_nees_;      ///< of the orientation, over 3
  double error_along_velocity_ = 0;
  double velocity_square_ = 0;
  int pair_in_view_ = 0;
  int valid_in_view_ = 0;
  int blind_ = 0;  ///< reports without any LED for over 0.1 s
  int valid_blind_ = 0;
  double blind_since_ = -1;
  double pair_back_ = -1;  ///< when the pair returned that no valid report has followed yet
  bool had_pair_ = false;
  bool had_truth_ = false;
  double last_t_ = 0;
  Vector3d last_truth_ = Vector3d::Zero();
};

/// One report against the truth.
[[nodiscard]] ErrorSample error_of(const SensedReport& sensed, const Report& report);

}  // namespace verisim::wii
