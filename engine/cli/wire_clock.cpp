#include "engine/cli/wire_clock.hpp"

#include <chrono>

#include "engine/base/error.hpp"

namespace verisim::cli {
namespace {

constexpr std::int64_t kMicro = 1'000'000;

std::int64_t total(const vrpn::Timestamp& t) {
  return std::int64_t{t.seconds} * kMicro + t.microseconds;
}

vrpn::Timestamp timestamp(std::int64_t microseconds) {
  VERISIM_ASSERT(microseconds >= 0);
  return {static_cast<std::uint32_t>(microseconds / kMicro), static_cast<std::uint32_t>(microseconds % kMicro)};
}

}  // namespace

vrpn::Timestamp wire_time() {
  const auto since = std::chrono::system_clock::now().time_since_epoch();
  return timestamp(std::chrono::duration_cast<std::chrono::microseconds>(since).count());
}

vrpn::Timestamp later(const vrpn::Timestamp& begin, std::int64_t microseconds) {
  return timestamp(total(begin) + microseconds);
}

}  // namespace verisim::cli
