#include "engine/robot/boards.hpp"

#include <filesystem>
#include <stdexcept>

#include "engine/base/error.hpp"
#include "engine/base/own_file.hpp"

namespace verisim::robot {

std::unique_ptr<firmware::Board> make_board(const std::string& name) {
  VERISIM_ASSERT(name == "host" || name == "avr");
  if (name == "host") return firmware::make_host_board();
  std::string program = own_program("verisim-avr");
  if (program.empty()) program = std::filesystem::path(own_file()).parent_path() / "verisim-avr";  // for the error
  try {
    return firmware::make_avr_board(program);
  } catch (const std::runtime_error& error) {
    fail(ErrorKind::input, "board \"avr\": {}; board \"host\" runs the same firmware as plain functions", error.what());
  }
}

}  // namespace verisim::robot
