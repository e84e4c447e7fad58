// verisim-avr [FIRMWARE.elf]: runs the robot's firmware on a simulated ATmega328P for an AVR board, which starts it and
// talks to it over stdin and stdout (wire.hpp). A program of its own because simavr is under GPL-3.0. Ends when stdin
// does.
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <vector>

#include "firmware_sim/avr/chip.hpp"

namespace verisim::firmware {
namespace {

/// False at the end of the input.
bool read_all(void* to, std::size_t size) {
  for (std::size_t have = 0; have < size;) {
    const ssize_t n = read(STDIN_FILENO, static_cast<char*>(to) + have, size - have);
    if (n == 0 || (n < 0 && errno != EINTR)) return false;
    if (n > 0) have += static_cast<std::size_t>(n);
  }
  return true;
}

bool write_all(const void* from, std::size_t size) {
  for (std::size_t done = 0; done < size;) {
    const ssize_t n = write(STDOUT_FILENO, static_cast<const char*>(from) + done, size - done);
    if (n < 0 && errno != EINTR) return false;
    if (n > 0) done += static_cast<std::size_t>(n);
  }
  return true;
}

void answer(Chip& chip, const Request& request, std::vector<EncoderEdge>& edges, std::vector<TimedByte>& bytes) {
  switch (request.ask) {
    case Ask::advance:
      chip.advance({edges.data(), request.edges}, {bytes.data(), request.bytes});
      break;
    case Ask::reset:
      chip.reset();
      break;
    case Ask::power_on:
      chip.set_powered(true);
      break;
    case Ask::power_off:
      chip.set_powered(false);
      break;
  }
}

void serve(const std::string& elf) {
  Chip chip(elf);
  std::vector<EncoderEdge> edges(kEventsMax);
  std::vector<TimedByte> bytes(kEventsMax);
  Request request{};
  while (write_all(&chip.state(), sizeof(Reply)) && read_all(&request, sizeof request)) {
    if (request.edges > kEventsMax || request.bytes > kEventsMax)
      throw std::runtime_error("a request beyond its bounds");
    if (!read_all(edges.data(), request.edges * sizeof(EncoderEdge))) return;
    if (!read_all(bytes.data(), request.bytes * sizeof(TimedByte))) return;
    answer(chip, request, edges, bytes);
  }
}

}  // namespace
}  // namespace verisim::firmware

int main(int count, char** arguments) try {
  namespace fs = std::filesystem;
  const fs::path beside = fs::read_symlink("/proc/self/exe").parent_path() / "verisim-firmware.elf";
  if (isatty(STDIN_FILENO) != 0)
    throw std::runtime_error("an AVR board starts this program; it is of no use by itself");
  verisim::firmware::serve(count > 1 ? arguments[1] : beside.string());
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "verisim-avr: %s\n", error.what());
  return 1;
}
