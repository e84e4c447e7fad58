#include "engine/simulation/clocks.hpp"

#include <cmath>

#include "engine/base/error.hpp"

namespace verisim {

namespace {
__extension__ using Wide = unsigned __int128;
}  // namespace

Clocks::Clocks(double dt) : dt_ns_(static_cast<std::uint64_t>(std::llround(dt * 1e9))) {
  VERISIM_ASSERT(dt_ns_ > 0);
}

void Clocks::add(double rate_hz, std::function<void(double)> f) {
  if (!(rate_hz >= 0.001 && rate_hz <= 1e6))
    fail(ErrorKind::input, "a clock of {} Hz was asked for; rates go from 0.001 to 1000000 Hz", rate_hz);
  VERISIM_ASSERT(f != nullptr);
  clocks_.push_back({static_cast<std::uint64_t>(std::llround(rate_hz * 1000)), 1, std::move(f)});
}

void Clocks::run_due(std::uint64_t frames, double t) {
  // By index: a clock's function may add clocks.
  for (std::size_t i = 0; i < clocks_.size(); ++i) {
    // frames * dt >= next / rate, in 1e-12 of a period; 128 bits: 3e20 years at 1 kHz.
    const auto reached = static_cast<Wide>(frames) * dt_ns_ * clocks_[i].rate_mhz;
    while (static_cast<Wide>(clocks_[i].next) * 1'000'000'000'000ULL <= reached) {
      ++clocks_[i].next;
      clocks_[i].f(t);
    }
  }
}

}  // namespace verisim
