#include <unistd.h>

#include <bit>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <system_error>

#include "engine/base/error.hpp"
#include "engine/base/json.hpp"
#include "engine/base/text.hpp"
#include "engine/cli/commands.hpp"
#include "firmware_sim/protocol/frame.hpp"

namespace verisim::cli {
namespace {

const std::vector<std::string>& robot_collections() {
  static const std::vector<std::string> names{protocol::ComputerToRobot::name(), protocol::RobotToComputer::name(),
                                              protocol::BlueToGreen::name(), protocol::GreenToBlue::name()};
  return names;
}

/// Calls `use` with the collection of this name as its template argument. @pre it is one of robot_collections()
template <typename Use>
void with_robot_collection(const std::string& name, Use&& use) {
  if (name == protocol::ComputerToRobot::name()) return use.template operator()<protocol::ComputerToRobot>();
  if (name == protocol::RobotToComputer::name()) return use.template operator()<protocol::RobotToComputer>();
  if (name == protocol::BlueToGreen::name()) return use.template operator()<protocol::BlueToGreen>();
  VERISIM_ASSERT(name == protocol::GreenToBlue::name());
  use.template operator()<protocol::GreenToBlue>();
}

/// The fields of a message as JSON. What is no number in JSON is null, and its bits tell what it is.
struct FieldsAsJson {
  Json args = Json::array(), bits = Json::array();
  void operator()(const std::int16_t& field) { args.push_back(field); }
  void operator()(const float& field) {
    args.push_back(std::isfinite(field) ? Json(static_cast<double>(field)) : Json(nullptr));
    bits.push_back(fmt::format("{:08x}", std::bit_cast<std::uint32_t>(field)));
  }
};

template <typename Named>
struct PrintMessage {
  template <typename Message>
  void operator()(const Message& message) {
    FieldsAsJson fields;
    Message::visit(message, fields);
    Json line{{"message", Message::name()}, {"id", protocol::id_of<Named, Message>()}, {"args", fields.args}};
    if (!fields.bits.empty()) line["bits"] = fields.bits;
    std::printf("%s\n", json_text(line).c_str());
  }
};

template <typename Named>
void decode_stdin() {
  protocol::Receiver<Named> receiver;
  std::uint8_t bytes[4096];
  for (;;) {
    const ssize_t n = read(STDIN_FILENO, bytes, sizeof bytes);
    if (n == 0) break;
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail(ErrorKind::io, "stdin: {}; pipe the bytes in", std::generic_category().message(errno));
    receiver.feed(bytes, static_cast<std::uint32_t>(n), PrintMessage<Named>{});
    std::fflush(stdout);  // who listens to a robot does not wait for its end; finish_streams says if it fails
  }
  const protocol::Received& received = receiver.received();
  std::fprintf(stderr,
               "note: %u messages; bytes discarded: %u, of which %u began no valid frame; left at the end: %d\n",
               received.accepted, received.discarded + received.rejected, received.rejected, receiver.buffered());
}

/// One field after the other, from the words of the command line.
struct FieldsFromWords {
  const std::string& message;
  const std::vector<std::string>& words;
  std::size_t next = 0;

  void operator()(std::int16_t& field) {
    const std::string& word = take();
    char* end = nullptr;
    errno = 0;
    const long value = std::strtol(word.c_str(), &end, 10);
    if (word.empty() || *end != '\0' || errno != 0 || value < INT16_MIN || value > INT16_MAX)
      fail(ErrorKind::usage, "{}: '{}' is no int16; write a whole number from -32768 to 32767", message, shown(word));
    field = static_cast<std::int16_t>(value);
  }

  void operator()(float& field) {
    const std::string& word = take();
    char* end = nullptr;
    if (word.size() == 10 && word.starts_with("0x")) {
      const unsigned long bits = std::strtoul(word.c_str() + 2, &end, 16);
      if (*end == '\0') {
        field = std::bit_cast<float>(static_cast<std::uint32_t>(bits));
        return;
      }
    }
    field = std::strtof(word.c_str(), &end);
    const bool overflows = std::isinf(field) && word.find_first_of("iI") == std::string::npos;
    if (word.empty() || *end != '\0' || overflows)
      fail(ErrorKind::usage, "{}: '{}' is no float32; write a number up to 3.4e38, inf, nan, or its bits as 0x7fc00000",
           message, shown(word));
  }

  const std::string& take() {
    if (next == words.size())
      fail(ErrorKind::usage, "{}: {} fields are not enough; give one for each", message, words.size());
    return words[next++];
  }
};

template <typename Named>
struct EncodeMessage {
  const std::string& wanted;
  const std::vector<std::string>& words;
  std::vector<std::string> known = {};
  std::uint8_t frame[protocol::longest_frame<Named>()] = {};
  std::uint8_t length = 0;

  template <typename Message>
  bool operator()(std::uint8_t /*id*/, const Message& /*message*/) {
    known.emplace_back(Message::name());
    if (wanted != Message::name()) return false;
    Message message{};
    FieldsFromWords fields{wanted, words};
    Message::visit(message, fields);
    if (fields.next != words.size())
      fail(ErrorKind::usage, "{} has {} fields, not {}; leave out the rest", wanted, fields.next, words.size());
    length = protocol::encode<Named>(message, frame);
    return true;
  }
};

template <typename Named>
void encode_to_stdout(const std::string& message, const std::vector<std::string>& words) {
  EncodeMessage<Named> ask{message, words};
  if (!protocol::find_message<Named>(ask))
    fail(ErrorKind::usage, "{} has no message '{}'; it has {}", Named::name(), shown(message),
         fmt::join(ask.known, ", "));
  (void)std::fwrite(ask.frame, 1, ask.length, stdout);  // finish_streams says whether it arrived
}

void add_decode(CLI::App& robot, int& exit_code) {
  auto* command = robot.add_subcommand("decode", "Raw protocol bytes on stdin to one JSON line per accepted message");
  auto collection = std::make_shared<std::string>();
  command->add_option("COLLECTION", *collection, "Whose messages they are")
      ->required()
      ->check(CLI::IsMember(robot_collections()));
  command->footer("Example: verisim robot encode ComputerToRobot StartControl | verisim robot decode ComputerToRobot");
  command->callback([=, &exit_code] {
    with_robot_collection(*collection, []<typename Named>() { decode_stdin<Named>(); });
    exit_code = 0;
  });
}

void add_encode(CLI::App& robot, int& exit_code) {
  struct Options {
    std::string collection, message;
    std::vector<std::string> words;
  };
  auto* command = robot.add_subcommand("encode", "A message to raw protocol bytes on stdout");
  auto o = std::make_shared<Options>();
  command->add_option("COLLECTION", o->collection, "Whose message it is")
      ->required()
      ->check(CLI::IsMember(robot_collections()));
  command->add_option("MESSAGE", o->message, "Its name")->required();
  command->add_option("ARGS", o->words,
                      "Its fields: whole numbers, or floats (a number, inf, nan, or bits 0x7fc00000)");
  command->footer("Example: verisim robot encode ComputerToRobot XYIntVelocities 300 -50 > bytes");
  command->callback([=, &exit_code] {
    with_robot_collection(o->collection, [&o]<typename Named>() { encode_to_stdout<Named>(o->message, o->words); });
    exit_code = 0;
  });
}

}  // namespace

void add_robot(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("robot", "Speaks the serial protocol of the mobile robot");
  command->require_subcommand(1);
  add_decode(*command, exit_code);
  add_encode(*command, exit_code);
}

}  // namespace verisim::cli
