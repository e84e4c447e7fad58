// The assignment of blobs to LEDs, which trackers of several targets call data association. The remote puts a blob into
// any slot and may exchange slots at will, so that only the image counts and never the slot's number. A blob that is no
// LED, such as a lamp's, is clutter.
#pragma once

#include <array>

#include "engine/wii/clutter.hpp"
#include "engine/wii/tracker.hpp"
#include "engine/wii/two_point.hpp"

namespace verisim::wii {

/// Blob index of each LED, -1 where it is not seen.
using Assignment = std::array<int, kLedsMax>;

/// The assignment of least cost: global nearest neighbour with gating. The cost is the sum of squared pixel distances
/// between blobs and the `expected` pixels of the LEDs. No blob further than `gate` pixels from an LED is assigned to
/// it; an LED without a blob costs gate^2. All injective assignments are compared: at most 209.
/// @pre expected holds the pixels of at most kLedsMax LEDs; gate is finite and not negative
[[nodiscard]] Assignment nearest_assignment(const Reading& reading, std::span<const Eigen::Vector2d> expected,
                                            double gate);

/// Follows the blobs of the first two LEDs from image to image through slot swaps, clutter and short losses. Fixed
/// size, no allocation.
class PairFollower {
 public:
  /// @pre the layout has two LEDs or more
  PairFollower(const LedLayout& leds, const Pinhole& pinhole, const Thresholds& thresholds = {});

  struct Match {
    TwoPointPose pose;
    std::array<int, 2> blob = {-1, -1};
    [[nodiscard]] bool found() const { return pose.found; }
  };
  /// The two blobs of this image. While the followed pair is younger than 0.25 s: those nearest to it, within a gate
  /// and nearer to it than to clutter. Else the pair of least cost, if that is low enough, as an upright head
  /// (half_turn.hpp tells whether it is). The cost adds up the squared deviations, each over its scale, of
  ///   - the head's roll from upright,
  ///   - one blob's size from the other's, and their mean from the size learned for that distance,
  ///   - the blob nearest to each further LED from where the pair says that the LED must be.
  /// A pair of least cost has no blob within clutter_radius of clutter in the image that was followed last.
  [[nodiscard]] Match match(double t, const Reading& reading, const Matrix3d& C_LR);
  /// The same two blobs, the other way round.
  [[nodiscard]] Match exchanged(const Reading& reading, const Match& match, const Matrix3d& C_LR) const {
    return solve(reading, match.blob[1], match.blob[0], C_LR);
  }
  /// `current` (its pose may be missing), or another pair of this image, once in five images in a row another pair has
  /// cost clearly less: an LED whose place a lamp took while it was dark is back. Nothing is computed for images with
  /// fewer than three blobs.
  [[nodiscard]] Match reconsidered(const Reading& reading, const Match& current, const Matrix3d& C_LR);
  /// Follow these two from now on; all other blobs of this image are clutter.
  /// @pre t is finite; the match's blobs are two of the reading's
  void follow(double t, const Reading& reading, const Match& match);
  void forget() {
    followed_ = false;
    clutter_.forget();
    confirmations_ = 0;
    size_at_1m_ = 0;
  }

 private:
  [[nodiscard]] Match solve(const Reading& reading, int first, int second, const Matrix3d& C_LR) const;
  [[nodiscard]] Match continue_pair(double age, const Reading& reading, const Matrix3d& C_LR) const;
  [[nodiscard]] Match acquire(const Reading& reading, const Matrix3d& C_LR) const;
  /// The pair of least cost, if that is below `cost`, which becomes it.
  [[nodiscard]] Match least_cost_pair(const Reading& reading, const Matrix3d& C_LR, bool clutter_too,
                                      double& cost) const;
  [[nodiscard]] double cost_of(const Reading& reading, const Match& match, const Matrix3d& C_LR) const;

  LedLayout leds_;
  Pinhole pinhole_;
  LedPair pair_;
  Thresholds thresholds_;
  bool followed_ = false;
  double t_ = 0;
  std::array<Blob, 2> last_;
  Clutter clutter_;        ///< the other blobs of that image
  int confirmations_ = 0;  ///< images in a row in which another pair cost less
  double size_at_1m_ = 0;  ///< of the LEDs' blobs, learned; 0: not known
};

}  // namespace verisim::wii
