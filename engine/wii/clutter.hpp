// Lights that are no LEDs: lamps, their reflections, the sun. They stand still while heads move, unless the remote is
// moved; where they stood when the whole head was seen, they still are when it is lost.
#pragma once

#include <array>
#include <span>

#include "engine/wii/channels.hpp"
#include "engine/wii/thresholds.hpp"

namespace verisim::wii {

/// The clutter of one remote's image. Fixed size, no allocation.
class Clutter {
 public:
  explicit Clutter(const Thresholds& thresholds = {}) : radius_(thresholds.clutter_radius) {}

  /// All blobs of the image but those of the LEDs, now that every LED is seen. `leds` are indices of blobs.
  void learn(const Reading& reading, std::span<const int> leds);
  /// Where it stands in an image of which not all LEDs are known: on the nearest blob, if one is near.
  void follow(const Reading& reading);
  void forget() { count_ = 0; }

  [[nodiscard]] double distance_square(const Blob& blob) const;  ///< to the nearest [pixel^2]; infinite without any
  /// Whether a blob stands within clutter_radius of clutter.
  [[nodiscard]] bool holds(const Blob& blob) const { return distance_square(blob) < radius_ * radius_; }
  /// The image without the blobs that it holds.
  [[nodiscard]] Reading removed_from(const Reading& reading) const;

 private:
  double radius_;
  std::array<Blob, kSlots> places_{};
  int count_ = 0;
};

}  // namespace verisim::wii
