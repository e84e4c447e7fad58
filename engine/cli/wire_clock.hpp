// The wall clock for programs on a network.
#pragma once

#include <cstdint>

#include "engine/vrpn/message.hpp"

namespace verisim::cli {

/// Time since 1970, as message headers hold it.
[[nodiscard]] vrpn::Timestamp wire_time();
/// `begin` plus a number of microseconds. @pre that is not before 1970
[[nodiscard]] vrpn::Timestamp later(const vrpn::Timestamp& begin, std::int64_t microseconds);

}  // namespace verisim::cli
