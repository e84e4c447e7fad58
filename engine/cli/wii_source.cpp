#include "engine/cli/wii_source.hpp"

#include <algorithm>

#include "engine/base/error.hpp"
#include "engine/wii/validate.hpp"

namespace verisim::cli {
namespace {

class RecordedSource final : public WiiSource {
 public:
  explicit RecordedSource(WiiRecording recording) : recording_(std::move(recording)) {}
  bool next(WiiSample& sample) override {
    if (next_ == recording_.samples.size()) return false;
    sample = recording_.samples[next_++];
    sample.t -= recording_.samples.front().t;
    return true;
  }
  [[nodiscard]] const wii::TrackerSettings& settings() const override { return recording_.settings; }

 private:
  WiiRecording recording_;
  std::size_t next_ = 0;
};

wii::RemoteSettings remote_settings(const std::string& sensor, const wii::Trajectory& path,
                                    const wii::LedLayout& leds) {
  const auto& cases = wii::sensor_cases();
  const auto found = std::find_if(cases.begin(), cases.end(), [&](const auto& c) { return c.name == sensor; });
  if (found == cases.end()) fail(ErrorKind::input, "sensor '{}' is not known; see verisim wii validate --help", sensor);
  wii::RemoteSettings settings = found->settings;
  settings.leds.clear();
  for (int i = 0; i < leds.count; ++i) settings.leds.push_back({.p_H = leds.p_H[static_cast<std::size_t>(i)]});
  settings.outages = path.outages;
  settings.exchanges = path.exchanges;
  return settings;
}

class VirtualSource final : public WiiSource {
 public:
  VirtualSource(const wii::Trajectory& path, const std::string& sensor, const wii::LedLayout& leds, std::uint64_t seed)
      : path_(path), remote_(remote_settings(sensor, path, leds), seed, path.name) {
    settings_.leds = leds;
    settings_.fov = remote_.settings().fov;
  }
  bool next(WiiSample& sample) override {
    while (remote_.lost(k_)) ++k_;
    const wii::SensedReport report = remote_.sense(k_, path_.at(remote_.report_time(k_)));
    ++k_;
    sample = {report.t, report.channels};
    return true;
  }
  [[nodiscard]] const wii::TrackerSettings& settings() const override { return settings_; }

 private:
  const wii::Trajectory& path_;
  wii::VirtualRemote remote_;
  wii::TrackerSettings settings_;
  std::uint64_t k_ = 0;
};

}  // namespace

std::unique_ptr<WiiSource> recorded_source(const std::string& file, const TraceLimits& limits) {
  return std::make_unique<RecordedSource>(read_wii_recording(file, limits));
}

std::unique_ptr<WiiSource> virtual_source(const std::string& trajectory, const std::string& sensor,
                                          const wii::LedLayout& leds, std::uint64_t seed) {
  return std::make_unique<VirtualSource>(wii::trajectory(trajectory), sensor, leds, seed);
}

}  // namespace verisim::cli
