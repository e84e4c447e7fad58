// The bytes that the published libraries sent and accepted (reference/robot_protocol/golden.json): all of them.
#include <gtest/gtest.h>

#include <bit>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <vector>

#include "firmware_sim/protocol/frame.hpp"
#include "tests/support/paths.hpp"

namespace verisim::protocol {
namespace golden_test {

using nlohmann::json;
using Bytes = std::vector<std::uint8_t>;

Bytes from_hex(const std::string& hex) {
  Bytes bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    bytes.push_back(static_cast<std::uint8_t>(std::stoul(hex.substr(i, 2), nullptr, 16)));
  return bytes;
}

/// The fields of a message as words: the bits of a float, an integer as it is.
struct ToWords {
  std::vector<std::int64_t> words;
  void operator()(const float& field) { words.push_back(std::bit_cast<std::uint32_t>(field)); }
  void operator()(const std::int16_t& field) { words.push_back(field); }
};

struct FromWords {
  std::vector<std::int64_t> words;
  std::size_t next = 0;
  void operator()(float& field) { field = std::bit_cast<float>(static_cast<std::uint32_t>(words.at(next++))); }
  void operator()(std::int16_t& field) { field = static_cast<std::int16_t>(words.at(next++)); }
};

std::vector<std::int64_t> words_of(const json& entry) {
  std::vector<std::int64_t> words;
  if (entry.contains("bits"))
    for (const json& bits : entry["bits"])
      words.push_back(static_cast<std::int64_t>(std::stoul(bits.get<std::string>(), nullptr, 16)));
  else
    for (const json& value : entry["args"]) words.push_back(value.get<std::int64_t>());
  return words;
}

struct Call {
  std::string message;
  std::vector<std::int64_t> words;
  bool operator==(const Call&) const = default;
};

struct Record {
  std::vector<Call> calls;
  template <typename Message>
  void operator()(const Message& message) {
    ToWords to;
    Message::visit(message, to);
    calls.push_back({Message::name(), to.words});
  }
};

template <typename Named>
struct Encode {
  const json& entry;
  Bytes bytes;
  template <typename Message>
  bool operator()(std::uint8_t id, const Message& /*message*/) {
    if (entry["message"] != Message::name()) return false;
    EXPECT_EQ(entry["id"], id);
    Message message{};
    FromWords from{words_of(entry)};
    Message::visit(message, from);
    bytes.resize(longest_frame<Named>());
    bytes.resize(encode<Named>(message, bytes.data()));
    return true;
  }
};

/// Calls `use` with the collection of this name as its template argument.
template <typename Use>
void with_collection(const std::string& name, Use&& use) {
  if (name == ComputerToRobot::name()) return use.template operator()<ComputerToRobot>();
  if (name == RobotToComputer::name()) return use.template operator()<RobotToComputer>();
  if (name == BlueToGreen::name()) return use.template operator()<BlueToGreen>();
  if (name == GreenToBlue::name()) return use.template operator()<GreenToBlue>();
  FAIL() << "no collection " << name;
}

class Golden : public testing::Test {
 protected:
  void SetUp() override {
    const std::string file = paths::in_shared_reference("robot_protocol/golden.json");
    if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is absent";
    golden = json::parse(std::ifstream(file));
  }
  json golden;
};

TEST_F(Golden, FramesHaveTheirPublishedLengthsAndCapacities) {
  for (const auto& [name, format] : golden["format"]["collections"].items())
    with_collection(name, [&format = format]<typename Named>() {
      EXPECT_EQ(format["messages"].size(), Named::count);
      EXPECT_EQ(format["capacity"], Receiver<Named>::kCapacity);
      for (const json& message : format["messages"])
        EXPECT_EQ(message["frame_bytes"], frame_length_of<Named>(message["id"].get<std::uint8_t>())) << message;
    });
}

TEST_F(Golden, EachOf118MessagesIsSentByteForByte) {
  EXPECT_EQ(golden["encode"].size(), 118);
  for (const json& entry : golden["encode"]) {
    SCOPED_TRACE(entry["name"]);
    with_collection(entry["collection"], [&entry]<typename Named>() {
      Encode<Named> ask{entry, {}};
      ASSERT_TRUE(find_message<Named>(ask));
      EXPECT_EQ(ask.bytes, from_hex(entry["bytes"]));
    });
  }
}

TEST_F(Golden, EachOf118FramesIsReceivedBitForBit) {
  for (const json& entry : golden["encode"]) {
    SCOPED_TRACE(entry["name"]);
    with_collection(entry["collection"], [&entry]<typename Named>() {
      const Bytes bytes = from_hex(entry["bytes"]);
      Receiver<Named> receiver;
      Record record;
      receiver.feed(bytes.data(), static_cast<std::uint32_t>(bytes.size()), record);
      EXPECT_EQ(record.calls, (std::vector<Call>{{entry["message"], words_of(entry)}}));
      EXPECT_EQ(receiver.buffered(), 0);
    });
  }
}

TEST_F(Golden, EachOf84SequencesGivesTheRecordedCalls) {
  EXPECT_EQ(golden["receive"].size(), 84);
  for (const json& entry : golden["receive"]) {
    SCOPED_TRACE(entry["name"]);
    with_collection(entry["collection"], [&entry]<typename Named>() {
      Receiver<Named> receiver;
      for (const json& step : entry["steps"]) {
        const Bytes bytes = from_hex(step["bytes"]);
        ASSERT_EQ(receiver.append(bytes.data(), static_cast<std::uint8_t>(bytes.size())), bytes.size());
        Record record;
        const std::uint8_t accepted = receiver.process(record);
        std::vector<Call> expected;
        for (const json& call : step["calls"]) expected.push_back({call["message"], words_of(call)});
        EXPECT_EQ(record.calls, expected);
        EXPECT_EQ(accepted, expected.size());
        EXPECT_EQ(receiver.buffered(), step["buffered"]);
      }
    });
  }
}

}  // namespace golden_test
}  // namespace verisim::protocol
