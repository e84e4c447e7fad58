// Reports of a Wii Remote one after another, from a trace or from a virtual remote.
#pragma once

#include <memory>
#include <string>

#include "engine/cli/wii_trace.hpp"

namespace verisim::cli {

class WiiSource {
 public:
  virtual ~WiiSource() = default;
  WiiSource() = default;
  WiiSource(const WiiSource&) = delete;
  WiiSource& operator=(const WiiSource&) = delete;

  /// The next report; false at the end. Times grow from 0.
  virtual bool next(WiiSample& sample) = 0;
  /// What a tracker of these reports may know.
  [[nodiscard]] virtual const wii::TrackerSettings& settings() const = 0;
};

/// Error(input) as read_wii_recording.
[[nodiscard]] std::unique_ptr<WiiSource> recorded_source(const std::string& file, const TraceLimits& limits);
/// A trajectory of `wii validate`, without end, seen by one of its sensors. Error(input) for an unknown name.
[[nodiscard]] std::unique_ptr<WiiSource> virtual_source(const std::string& trajectory, const std::string& sensor,
                                                        const wii::LedLayout& leds, std::uint64_t seed);

}  // namespace verisim::cli
