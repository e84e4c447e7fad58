// The boards by the names that scenes use.
#pragma once

#include <memory>
#include <string>

#include "firmware_sim/board.hpp"

namespace verisim::robot {

/// "host": the firmware as plain functions; "avr": its machine code on a simulated ATmega328P, in the program
/// verisim-avr (own_program). Error(input) that says what is missing. @pre the name is one of them
[[nodiscard]] std::unique_ptr<firmware::Board> make_board(const std::string& name);

}  // namespace verisim::robot
