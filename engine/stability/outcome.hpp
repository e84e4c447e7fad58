// What a motion comes to: it dies away, goes on for ever, or grows.
//
// A motion is judged by its swing: the largest distance from where it should rest, within a block of frames. The first
// block has `frames_first` frames, each block is twice as long as the one before. `scale` is the size of the
// disturbance with which the motion began. What comes to rest elsewhere is not stable.
//
//   diverged     the swing is beyond 1000 scales, or the engine ended the run because a value was not finite
//   stable       the swing is below scale / 1000, or at the end of patience decays exponentially: of the last four
//                blocks each is smaller than the one before, by a ratio that becomes smaller from block to block
//                (exp(-rate * block), and blocks double)
//   limit-cycle  bounded and never decaying: the swings of the last four blocks are equal to 1e-4; or after
//                `blocks_max` blocks none of the above
//
// A swing that still grows exponentially after `blocks_max` blocks has diverged. A decay is taken for a cycle only if
// it is slower than 1e-4 in a block: it depends on how long one looks by that much and no more.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace verisim::stability {

enum class Outcome : std::uint8_t { stable, limit_cycle, diverged, refused };
/// The words of INTERFACES section 5. Refused: the engine declined the input with an error.
inline constexpr std::array<std::string_view, 4> kOutcomeNames = {"stable", "limit-cycle", "diverged", "refused"};
[[nodiscard]] constexpr std::string_view name_of(Outcome outcome) {
  return kOutcomeNames[static_cast<std::size_t>(outcome)];
}
/// The definition above in one line each, for outputs.
[[nodiscard]] std::vector<std::string_view> definitions();

struct Patience {
  std::uint64_t frames_first = 128;
  unsigned blocks_max = 12;
  /// A linear motion: what decays or grows exponentially over any four blocks goes on so, and is judged at once. Else
  /// only the last four of `blocks_max` tell: a swing may decay to a cycle, or grow to one.
  bool is_linear = false;
};

/// Takes one coordinate after the other and says as soon as it knows.
class SwingJudge {
 public:
  static constexpr double kGrown = 1e3, kRest = 1e-3, kSame = 1e-4;
  /// @pre scale > 0, finite; patience.frames_first > 1; patience.blocks_max > 4
  SwingJudge(double scale, const Patience& patience);
  /// Takes the distance from rest, of either sign, after one more frame. @pre nothing was said so far
  [[nodiscard]] std::optional<Outcome> take(double x);
  [[nodiscard]] std::uint64_t frames() const { return frames_; }
  /// Of the last block that is over; of the one that is going on before that.
  [[nodiscard]] double swing() const;

 private:
  [[nodiscard]] std::optional<Outcome> end_block();

  double scale_;
  Patience patience_;
  std::vector<double> swings_;
  double largest_ = 0;
  std::uint64_t frames_ = 0, block_ends_;
};

}  // namespace verisim::stability
