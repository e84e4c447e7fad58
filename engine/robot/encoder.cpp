#include "engine/robot/encoder.hpp"

#include <cmath>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"

namespace verisim::robot {
namespace {

constexpr double kCountsPerRadian = kCountsPerTurn / pinned::kFullTurn;

}  // namespace

void Edges::add(const Edge& edge) {
  if (size_ == edges_.size()) {
    ++dropped_;
    return;
  }
  std::size_t at = size_++;  // nearly sorted as it comes: few steps
  for (; at > 0 && edges_[at - 1].cycle > edge.cycle; --at) edges_[at] = edges_[at - 1];
  edges_[at] = edge;
}

std::uint8_t Encoder::levels() const {
  constexpr std::array<std::uint8_t, 4> kLevels = {0b00, 0b01, 0b11, 0b10};
  return kLevels[static_cast<std::size_t>(counts_ & 3)];
}

// A reversed encoder says B where A is: its levels are those of a count that runs backwards, and so it counts.
void Encoder::turn(double angle, std::uint32_t begin, std::uint32_t cycles, Edges& edges) {
  VERISIM_ASSERT(std::isfinite(angle));
  if (fault_ == EncoderFault::dead) return;
  const double change = angle * kCountsPerRadian;
  const double end = fraction_ + change;
  const double whole = std::floor(end);
  const auto passed = static_cast<std::int64_t>(whole);
  const std::int64_t sign = passed >= 0 ? 1 : -1;
  for (std::int64_t i = 0; i != passed; i += sign) {
    const double border = static_cast<double>(passed > 0 ? i + 1 : i);
    counts_ += fault_ == EncoderFault::reversed ? -sign : sign;
    const auto after = static_cast<std::uint32_t>((border - fraction_) / change * cycles);
    edges.add({begin + (after < cycles ? after : cycles - 1), wheel_, levels()});
  }
  fraction_ = end - whole;
  if (fraction_ >= 1) fraction_ = 0x1.fffffffffffffp-1;  // passed by less than a rounding
}

}  // namespace verisim::robot
