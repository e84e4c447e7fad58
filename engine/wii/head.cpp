#include "engine/wii/head.hpp"

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"

namespace verisim::wii {
namespace {

/// A report of time k / 100 is due in the frame that ends at k / 100, however both were rounded.
constexpr double kSameTime = 1e-9;  // s: rounding of times, no heuristic

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

void Head::advance(double t) {
  VERISIM_ASSERT(std::isfinite(t));
  taken_ = 0;
  for (; waits_ && waiting_.t <= t + kSameTime; waits_ = source_->next(waiting_)) {
    sensed_ = waiting_;
    estimate_ = tracker_->update(sensed_.t, sensed_.channels);
    ++taken_;
  }
  if (taken_ == 0 && estimate_.valid) estimate_ = tracker_->heartbeat(t);
}

void Head::declare(Columns& columns) const {
  const std::string state = "/state/wii/" + name_;
  const std::string reports = "/cost/wii/" + name_ + "/reports";
  const auto at_reports = [&](const char* fact, const char* units, const char* description, auto get) -> Column& {
    return columns.add(state + fact, units, description, get, {}, reports);
  };
  at_reports("/time", "s", "when the remote took the report", [this] { return sensed_.t; });
  at_reports("/channels", "1, g, pixel", "battery, acceleration x y z, four times u v size (-1: nothing seen)",
             [this] { return sensed_.channels; });
  at_reports("/truth_pose", "m, 1", "true head in levelled coordinates; NaN if not known", [this] {
    return sensed_.X_LH;
  }).may_be_nan = true;
  at_reports("/estimate_pose", "m, 1", "what the tracker says, in levelled coordinates",
             [this] { return estimate_.pose; });
  at_reports("/valid", "1", "1: the tracker stands by it", [this] { return estimate_.valid; });
  columns.add(reports, "1", "reports tracked", [this] { return std::uint32_t{taken_}; });
}

}  // namespace verisim::wii
