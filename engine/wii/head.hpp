// WiiHead{ … } of a scene: a head that a tracker follows beside the loop, at the times of its remote's own reports.
// Nothing that the loop computes depends on it.
#pragma once

#include <memory>
#include <string>

#include "engine/wii/report_source.hpp"

namespace verisim::wii {

class Head {
 public:
  /// Error(input) as make_tracker, for the source's settings.
  /// @pre source is not null; X_WL is finite, its rotation unit
  Head(std::string name, std::unique_ptr<ReportSource> source, const std::string& tracker, const Pose& X_WL);

  /// @pre t is finite
  /// Takes every report that is due at simulated time t [s] or before. Called once a frame; costs a comparison unless
  /// one is. No allocation.
  void follow(double t);

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] unsigned taken() const { return taken_; }                   ///< reports taken in the last frame
  [[nodiscard]] const SensedReport& sensed() const { return sensed_; }      ///< the last of them; the truth with it
  [[nodiscard]] const Report& estimate() const { return estimate_; }        ///< what the tracker says now, in L
  [[nodiscard]] Pose world_pose() const { return X_WL_ * estimate_.pose; }  ///< NaN before the first estimate
  [[nodiscard]] double duration() const { return source_->duration(); }     ///< s; 0: without end

 private:
  std::string name_;
  std::unique_ptr<ReportSource> source_;
  std::unique_ptr<Tracker> tracker_;
  Pose X_WL_;  ///< the levelled coordinates in the world
  SensedReport waiting_;
  bool waits_ = false;  ///< waiting_ is the next report
  unsigned taken_ = 0;
  SensedReport sensed_;
  Report estimate_;
};

}  // namespace verisim::wii
