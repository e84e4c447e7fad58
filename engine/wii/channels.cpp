#include "engine/wii/channels.hpp"

#include <cmath>

namespace verisim::wii {
namespace {

constexpr double kForceMin = 0.05;     // g
constexpr double kForceMax = 8;        // g
constexpr double kDistinctPixels = 2;  // two LEDs 0.15 m apart are this close only beyond 90 m

bool plausible(const Blob& b) {
  // Written so that a NaN fails every comparison. Half a pixel of margin lets ideal, unrounded traces through.
  const bool inside = b.u >= -0.5 && b.u < kWidth && b.v >= -0.5 && b.v < kHeight && b.size >= 0 && b.size <= 15;
  return inside && (b.u != 0 || b.v != 0 || b.size != 0);
}

bool coincides(const Reading& reading, const Blob& b) {
  for (int i = 0; i < reading.blob_count; ++i)
    if (std::abs(reading.blobs[i].u - b.u) < kDistinctPixels && std::abs(reading.blobs[i].v - b.v) < kDistinctPixels)
      return true;
  return false;
}

}  // namespace

bool read_channels(std::span<const double> channels, Reading& reading) {
  if (channels.size() < kChannelsMin) return false;
  reading.blob_count = 0;
  for (std::size_t slot = 0; 6 + 3 * slot < channels.size() && slot < kSlots; ++slot) {
    const Blob b{channels[4 + 3 * slot], channels[5 + 3 * slot], channels[6 + 3 * slot]};
    if (plausible(b) && !coincides(reading, b)) reading.blobs[reading.blob_count++] = b;
  }
  reading.force_R = remote_from_accelerometer({channels[1], channels[2], channels[3]});
  const double square = reading.force_R.squaredNorm();
  reading.force_known = square >= kForceMin * kForceMin && square <= kForceMax * kForceMax;
  return true;
}

}  // namespace verisim::wii
