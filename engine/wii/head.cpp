#include "engine/wii/head.hpp"

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"

namespace verisim::wii {
namespace {

/// A report of time k / 100 is due in the frame that ends at k / 100, however both were rounded.
constexpr double kSameTime = 1e-9;  // s

std::unique_ptr<ReportSource> there(std::unique_ptr<ReportSource> source) {
  VERISIM_ASSERT(source != nullptr);
  return source;
}

}  // namespace

Head::Head(std::string name, std::unique_ptr<ReportSource> source, const std::string& tracker, const Pose& X_WL)
    : name_(std::move(name)),
      source_(there(std::move(source))),
      tracker_(make_tracker(tracker, source_->settings())),
      X_WL_(X_WL),
      estimate_(tracker_->heartbeat(0)) {
  VERISIM_ASSERT(is_placement(X_WL));
  sensed_.t = std::numeric_limits<double>::quiet_NaN();
  sensed_.channels.fill(-1);
  waits_ = source_->next(waiting_);
}

void Head::follow(double t) {
  VERISIM_ASSERT(std::isfinite(t));
  taken_ = 0;
  for (; waits_ && waiting_.t <= t + kSameTime; waits_ = source_->next(waiting_)) {
    sensed_ = waiting_;
    estimate_ = tracker_->update(sensed_.t, sensed_.channels);
    ++taken_;
  }
  if (taken_ == 0 && estimate_.valid) estimate_ = tracker_->heartbeat(t);
}

}  // namespace verisim::wii
