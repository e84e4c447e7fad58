#include "engine/wii/clutter.hpp"

#include <algorithm>
#include <limits>

#include "engine/base/error.hpp"

namespace verisim::wii {
namespace {

double square_between(const Blob& a, const Blob& b) {
  return (a.u - b.u) * (a.u - b.u) + (a.v - b.v) * (a.v - b.v);
}

}  // namespace

void Clutter::learn(const Reading& reading, std::span<const int> leds) {
  count_ = 0;
  for (int b = 0; b < reading.blob_count; ++b)
    if (std::find(leds.begin(), leds.end(), b) == leds.end())
      places_[static_cast<std::size_t>(count_++)] = reading.blobs[static_cast<std::size_t>(b)];
}

void Clutter::follow(const Reading& reading) {
  for (Blob& place : std::span(places_).first(static_cast<std::size_t>(count_))) {
    const auto seen = std::span(reading.blobs).first(static_cast<std::size_t>(reading.blob_count));
    const auto nearest = std::min_element(seen.begin(), seen.end(), [&](const Blob& a, const Blob& b) {
      return square_between(a, place) < square_between(b, place);
    });
    if (nearest != seen.end() && square_between(*nearest, place) < radius_ * radius_) place = *nearest;
  }
}

double Clutter::distance_square(const Blob& blob) const {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Blob& place : std::span(places_).first(static_cast<std::size_t>(count_)))
    nearest = std::min(nearest, square_between(blob, place));
  return nearest;
}

Reading Clutter::removed_from(const Reading& reading) const {
  Reading rest = reading;
  rest.blob_count = 0;
  for (int b = 0; b < reading.blob_count; ++b) {
    const Blob& blob = reading.blobs[static_cast<std::size_t>(b)];
    if (!holds(blob)) rest.blobs[static_cast<std::size_t>(rest.blob_count++)] = blob;
  }
  return rest;
}

}  // namespace verisim::wii
