#include "engine/wii/report_source.hpp"

#include <algorithm>

#include "engine/base/error.hpp"
#include "engine/wii/validate.hpp"

namespace verisim::wii {
namespace {

Pose unknown_pose() {
  Pose pose;
  pose.position.setConstant(std::numeric_limits<double>::quiet_NaN());
  pose.rotation.coeffs().setConstant(std::numeric_limits<double>::quiet_NaN());
  return pose;
}

class RecordedSource final : public ReportSource {
 public:
  explicit RecordedSource(Recording recording) : recording_(std::move(recording)) {}

  bool next(SensedReport& report) override {
    if (next_ == recording_.t.size()) return false;
    report.t = recording_.t[next_] - recording_.t.front();
    report.channels = recording_.channels[next_];
    report.X_LH = recording_.truth.empty() ? unknown_pose() : recording_.truth[next_];
    report.led_in_view = 0;
    ++next_;
    return true;
  }
  [[nodiscard]] const TrackerSettings& settings() const override { return recording_.settings; }
  [[nodiscard]] double duration() const override {
    return recording_.t.empty() ? 0 : recording_.t.back() - recording_.t.front();
  }

 private:
  Recording recording_;
  std::size_t next_ = 0;
};

class VirtualSource final : public ReportSource {
 public:
  VirtualSource(const VirtualSourceOptions& options, const Trajectory& path, const SetUp& set_up)
      : path_(placed(path, set_up)),
        latency_(set_up.latency.value_or(0)),
        remote_(remote_settings(sensor_case(options.sensor).settings, path, set_up.leds.value_or(options.leds), set_up),
                options.seed, options.name) {
    settings_.leds = set_up.leds.value_or(options.leds);
    settings_.fov = remote_.settings().fov;
  }

  bool next(SensedReport& report) override {
    while (remote_.lost(k_)) ++k_;
    const double t = remote_.report_time(k_);
    report = remote_.sense(k_, path_.at(std::max(0.0, t - latency_)));
    if (latency_ > 0) report.X_LH = levelled_pose(path_.at(t));
    ++k_;
    return true;
  }
  [[nodiscard]] const TrackerSettings& settings() const override { return settings_; }
  [[nodiscard]] double duration() const override { return 0; }

 private:
  Trajectory path_;
  double latency_;  ///< s
  VirtualRemote remote_;
  TrackerSettings settings_;
  std::uint64_t k_ = 0;
};

}  // namespace

std::unique_ptr<ReportSource> make_recorded_source(Recording recording) {
  VERISIM_ASSERT(recording.channels.size() == recording.t.size());
  VERISIM_ASSERT(recording.truth.empty() || recording.truth.size() == recording.t.size());
  return std::make_unique<RecordedSource>(std::move(recording));
}

std::unique_ptr<ReportSource> make_virtual_source(const VirtualSourceOptions& options) {
  const Trajectory& path = options.motion ? *options.motion : trajectory(options.trajectory);
  return std::make_unique<VirtualSource>(options, path, first_of(options.set_up, path.own));
}

}  // namespace verisim::wii
