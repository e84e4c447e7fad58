// Which blob is which LED. The remote hands its slots out as blobs come and go, and exchanges them at will; a lamp may
// hold one. Only the picture counts, never the slot number.
#pragma once

#include <array>

#include "engine/wii/tracker.hpp"
#include "engine/wii/two_point.hpp"

namespace verisim::wii {

/// Blob index of each LED, -1 where it is not seen.
using Assignment = std::array<int, kLedsMax>;

/// The assignment whose blobs lie nearest to where the LEDs are expected (sum of squared pixel distances, none beyond
/// `gate` pixels; an LED left out costs gate^2). All injective assignments are compared: at most 209.
/// @pre expected holds a pixel for each of at most kLedsMax LEDs; gate is finite and not negative
[[nodiscard]] Assignment nearest_assignment(const Reading& reading, std::span<const Eigen::Vector2d> expected,
                                            double gate);

/// Follows the first two LEDs through swaps, ghosts and short losses. Fixed size, no allocation.
class PairFollower {
 public:
  /// @pre the layout has two LEDs or more
  PairFollower(const LedLayout& leds, const Pinhole& pinhole, const Thresholds& thresholds = {});

  struct Match {
    TwoPointPose pose;
    std::array<int, 2> blob = {-1, -1};
    [[nodiscard]] bool found() const { return pose.found; }
  };
  /// The pair nearest to the followed one while that is younger than 0.25 s; else, or when that one stands on its head,
  /// the pair that looks most like a head, and enough: upright in L, equally large and as large as at its distance
  /// before, further LEDs where they must be, and none of them a blob that stood beside the head before (a lamp).
  [[nodiscard]] Match match(double t, const Reading& reading, const Matrix3d& C_LR);
  /// `current` (its pose may be missing), or another pair of this image that has looked much more like a head in five
  /// images in a row: an LED that was dark when a lamp came is back. Only images with three blobs or more cost
  /// anything.
  [[nodiscard]] Match reconsidered(const Reading& reading, const Match& current, const Matrix3d& C_LR);
  /// Whether a blob is nearer to one that stood beside the followed pair than, by this much, to an LED's place.
  [[nodiscard]] bool is_stranger(const Blob& blob, double distance_square_to_led) const;
  /// Follow these two from now on. @pre t is finite; the match's blobs are two of the reading's
  void follow(double t, const Reading& reading, const Match& match);
  void forget() {
    followed_ = false;
    stranger_count_ = 0;
    doubts_ = 0;
    size_at_1m_ = 0;
  }

 private:
  [[nodiscard]] Match solve(const Reading& reading, int first, int second, const Matrix3d& C_LR) const;
  [[nodiscard]] Match continue_pair(double age, const Reading& reading, const Matrix3d& C_LR) const;
  [[nodiscard]] Match acquire(const Reading& reading, const Matrix3d& C_LR) const;
  /// The likeliest pair below `cost`, which becomes its unlikeliness.
  [[nodiscard]] Match likeliest(const Reading& reading, const Matrix3d& C_LR, bool strangers_too, double& cost) const;
  [[nodiscard]] double distance_square_to_stranger(const Blob& blob) const;
  [[nodiscard]] double unlikeliness(const Reading& reading, const Match& match, const Matrix3d& C_LR) const;

  LedLayout leds_;
  Pinhole pinhole_;
  LedPair pair_;
  Thresholds thresholds_;
  bool followed_ = false;
  double t_ = 0;
  std::array<Blob, 2> last_;
  std::array<Blob, kSlots> strangers_;  ///< what else was in the image then
  int stranger_count_ = 0;
  int doubts_ = 0;         ///< images in a row in which another pair was likelier
  double size_at_1m_ = 0;  ///< of the LEDs' blobs, learned; 0: not known
};

}  // namespace verisim::wii
