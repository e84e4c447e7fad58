// WiiHead{ … } of a scene: a head that a tracker follows beside the loop, at the times of its remote's own reports.
// Nothing that the loop computes depends on it.
#pragma once

#include <memory>
#include <string>

#include "engine/base/companion.hpp"
#include "engine/wii/report_source.hpp"

namespace verisim::wii {

class Head : public Companion {
 public:
  /// Error(input) as make_tracker, for the source's settings.
  /// @pre source is not null; X_WL is finite, its rotation unit
  Head(std::string name, std::unique_ptr<ReportSource> source, const std::string& tracker, const Pose& X_WL);

  [[nodiscard]] const std::string& name() const override { return name_; }
  /// Takes every report that is due at simulated time t [s] or before. Costs a comparison unless one is.
  /// @pre t is finite
  void advance(double t) override;
  [[nodiscard]] double duration() const override { return source_->duration(); }
  /// /state/wii/NAME and /cost/wii/NAME. A frame that took reports adds a row: the last of them.
  void declare(Columns& columns) const override;

  [[nodiscard]] unsigned taken() const { return taken_; }                   ///< reports taken in the last frame
  [[nodiscard]] const SensedReport& sensed() const { return sensed_; }      ///< the last of them; the truth with it
  [[nodiscard]] const Report& estimate() const { return estimate_; }        ///< what the tracker says now, in L
  [[nodiscard]] Pose world_pose() const { return X_WL_ * estimate_.pose; }  ///< NaN before the first estimate

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
