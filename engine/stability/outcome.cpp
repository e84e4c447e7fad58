#include "engine/stability/outcome.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"

namespace verisim::stability {
namespace {

/// Four swings, the oldest first: do they change as an exponential does, `sign` = -1 down or 1 up? The first ratio is
/// beyond what counts as equal.
bool is_exponential(const double* swing, double sign) {
  double before = SwingJudge::kSame;
  for (int i = 1; i < 4; ++i) {
    const double change = sign * pinned::log(swing[i] / swing[i - 1]);
    if (!(change > before)) return false;
    before = change;
  }
  return true;
}

bool are_equal(const double* swing) {
  const auto [least, most] = std::minmax_element(swing, swing + 4);
  return *most - *least <= SwingJudge::kSame * *most;
}

}  // namespace

std::vector<std::string_view> definitions() {
  return {"stable: the swing falls below a thousandth of the disturbance, or decays exponentially",
          "limit-cycle: bounded and never decaying",
          "diverged: the swing grows beyond a thousand disturbances or exponentially, or a value is not finite",
          "refused: the engine declined the input and said why",
          "swing: the largest distance from rest in a block of frames; each block is twice as long as the one before"};
}

SwingJudge::SwingJudge(double scale, const Patience& patience)
    : scale_(scale), patience_(patience), block_ends_(patience.frames_first) {
  VERISIM_ASSERT(is_positive(scale));
  VERISIM_ASSERT(patience.frames_first > 1);
  VERISIM_ASSERT(patience.blocks_max > 4);
}

double SwingJudge::swing() const {
  return swings_.empty() ? largest_ : swings_.back();
}

std::optional<Outcome> SwingJudge::take(double x) {
  ++frames_;
  if (!std::isfinite(x)) return Outcome::diverged;
  largest_ = std::max(largest_, std::abs(x));
  if (largest_ > kGrown * scale_) {
    swings_.push_back(largest_);
    return Outcome::diverged;
  }
  return frames_ == block_ends_ ? end_block() : std::nullopt;
}

std::optional<Outcome> SwingJudge::end_block() {
  swings_.push_back(largest_);
  largest_ = 0;
  block_ends_ += patience_.frames_first << swings_.size();
  if (swings_.back() < kRest * scale_) return Outcome::stable;
  if (swings_.size() < 4) return std::nullopt;
  const double* last = swings_.data() + swings_.size() - 4;
  if (are_equal(last)) return Outcome::limit_cycle;
  const bool is_last = swings_.size() >= patience_.blocks_max;
  if (is_last || patience_.is_linear) {
    if (is_exponential(last, -1)) return Outcome::stable;
    if (is_exponential(last, 1)) return Outcome::diverged;
  }
  return is_last ? std::optional(Outcome::limit_cycle) : std::nullopt;
}

}  // namespace verisim::stability
