// An exact body as bytes and back, for what is prepared once and kept (engine/record/prepared_store.hpp). Round trip is
// exact to the bit. For the same build alone.
#pragma once

#include <string>
#include <string_view>

#include "engine/exact/exact_body.hpp"

namespace verisim::exact {

[[nodiscard]] std::string to_bytes(const ExactBody& body);
/// Error(input) if the bytes end too early or go on. @pre to_bytes of the same build made them
[[nodiscard]] ExactBody exact_body_from(std::string_view bytes);

}  // namespace verisim::exact
