// Messages that the published VRPN library sent (reference/vrpn_wire, golden.json), decoded here and encoded again.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "engine/vrpn/connection.hpp"
#include "engine/vrpn/payload.hpp"
#include "tests/support/paths.hpp"

namespace verisim::vrpn::golden_bytes_test {
namespace {

using nlohmann::json;

Bytes from_hex(const std::string& hex) {
  Bytes bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    bytes.push_back(static_cast<std::uint8_t>(std::stoul(hex.substr(i, 2), nullptr, 16)));
  return bytes;
}

/// A sensor's pose, which the engine only sends.
SensorPose pose_of(View payload) {
  Reader reader(payload);
  SensorPose pose;
  pose.sensor = reader.int32();
  static_cast<void>(reader.int32());
  for (double& x : pose.placement.position) x = reader.float64();
  for (double& x : pose.placement.rotation) x = reader.float64();
  EXPECT_TRUE(reader.ok());
  EXPECT_TRUE(reader.rest().empty());
  return pose;
}

class GoldenBytes : public testing::Test {
 protected:
  void SetUp() override {
    std::ifstream file(paths::in_shared_reference("vrpn_wire/golden.json"));
    if (!file)
      GTEST_SKIP() << "no recordings at " << paths::in_shared_reference("vrpn_wire") << ": nothing was compared";
    const json golden = json::parse(file);
    sessions_ = golden.at("sessions");
    for (const json& session : sessions_)
      for (const json& event : session.at("events")) events_.push_back(event);
    for (const json& message : golden.at("messages")) events_.push_back(message);
  }

  /// Every event that is a message, with its bytes and what they say.
  template <typename Check>
  void for_each_message(const Check& check) {
    int count = 0;
    for (const json& event : events_) {
      if (!event.contains("header")) continue;
      SCOPED_TRACE(event.dump());
      const Bytes bytes = from_hex(event.at("bytes"));
      const ParsedMessage parsed = first_message(bytes);
      ASSERT_EQ(parsed.state, ParsedMessage::State::whole);
      check(event, bytes, parsed);
      ++count;
    }
    EXPECT_GT(count, 150);
  }

  json sessions_;
  std::vector<json> events_;
};

TEST_F(GoldenBytes, HeadersReadAndWriteAsRecorded) {
  for_each_message([](const json& event, const Bytes& bytes, const ParsedMessage& parsed) {
    const json& header = event.at("header");
    const Message& m = parsed.message;
    EXPECT_EQ(kHeaderBytes + m.payload.size(), header.at("length"));
    EXPECT_EQ(m.time.seconds, header.at("sec"));
    EXPECT_EQ(m.time.microseconds, header.at("usec"));
    EXPECT_EQ(m.sender, header.at("sender"));
    EXPECT_EQ(m.type, header.at("type"));
    EXPECT_EQ(m.sequence, header.at("sequence"));
    EXPECT_EQ(parsed.bytes, bytes.size());
    Bytes again;
    put_message(again, m);
    ASSERT_EQ(again.size(), bytes.size());
    again.resize(bytes.size() - event.value("padding_bytes", std::size_t{0}));  // the rest is undefined
    EXPECT_TRUE(std::equal(again.begin(), again.end(), bytes.begin()));
  });
}

TEST_F(GoldenBytes, PayloadsReadAndWriteAsRecorded) {
  std::map<std::string, int> seen;
  for_each_message([&](const json& event, const Bytes&, const ParsedMessage& parsed) {
    const View payload = parsed.message.payload;
    const Bytes recorded(payload.begin(), payload.end());
    const std::string kind = event.at("kind");
    const std::string type = event.value("type_name", "");
    const json decoded = event.value("decoded", json());
    ++seen[kind == "message" ? type : kind];
    if (kind == "sender_description" || kind == "type_description") {
      const auto name = decode_name(payload);
      ASSERT_TRUE(name);
      EXPECT_EQ(*name, decoded.at("name").get<std::string>());
      EXPECT_EQ(encode_name(*name), recorded);
    } else if (type == kPose) {
      const SensorPose pose = pose_of(payload);
      EXPECT_EQ(pose.sensor, decoded.at("sensor"));
      EXPECT_EQ(json(pose.placement.position), decoded.at("pos"));
      EXPECT_EQ(json(pose.placement.rotation), decoded.at("quat_xyzw"));
      const Bytes again = encode(pose);
      EXPECT_TRUE(std::equal(again.begin() + 8, again.end(), recorded.begin() + 8)) << "bytes 4 to 7 are undefined";
    } else if (type == kAnalog) {
      const auto analog = decode_analog(payload);
      ASSERT_TRUE(analog);
      EXPECT_EQ(encode_analog(analog->channels()), recorded);
    } else if (type == kText) {
      const auto text = decode_text(payload);
      ASSERT_TRUE(text);
      EXPECT_EQ(text->text, decoded.at("text"));
      EXPECT_EQ(text->severity, decoded.at("severity"));
      EXPECT_EQ(text->level, decoded.at("level"));
    } else if (type == kToRoom) {
      EXPECT_EQ(encode(Placement{decoded.at("pos"), decoded.at("quat_xyzw")}), recorded);
    } else if (type == kUnitToSensor) {
      EXPECT_EQ(encode(SensorPose{decoded.at("sensor"), {decoded.at("pos"), decoded.at("quat_xyzw")}}), recorded);
    } else if (type == kWorkspace) {
      EXPECT_EQ(encode_box(decoded.at("min"), decoded.at("max")), recorded);
    }
  });
  for (const std::string_view type : {kPose, kAnalog, kText, kToRoom, kUnitToSensor, kWorkspace, kPing, kPong})
    EXPECT_GT(seen[std::string(type)], 0) << type << " was not in the recordings: this test would prove less";
}

TEST_F(GoldenBytes, CookiesAndRequestsReadAndWriteAsRecorded) {
  int cookies = 0;
  int requests = 0;
  for (const json& event : events_) {
    if (event.at("kind") == "cookie") {
      const Bytes bytes = from_hex(event.at("bytes"));
      EXPECT_TRUE(cookie_is_good(bytes));
      Bytes own;
      put_cookie(own);
      EXPECT_EQ(own, bytes);
      ++cookies;
    }
    if (event.at("kind") == "connection_request") {
      const Bytes bytes = from_hex(event.at("bytes"));
      const auto request = decode_request(bytes);
      ASSERT_TRUE(request);
      EXPECT_EQ(encode(*request), bytes);
      ++requests;
    }
  }
  EXPECT_GE(cookies, 4);
  EXPECT_GE(requests, 1);
}

/// All TCP bytes of one direction, joined.
Bytes stream_of(const json& session, const std::string& from) {
  Bytes stream;
  for (const json& event : session.at("events"))
    if (event.at("via") == "tcp" && event.at("from") == from && event.contains("bytes")) {
      const Bytes bytes = from_hex(event.at("bytes"));
      stream.insert(stream.end(), bytes.begin(), bytes.end());
    }
  return stream;
}

/// The names of messages that one side of a session understands, fed in pieces of `piece` bytes.
std::vector<std::string> heard(const json& session, const std::string& from, std::size_t piece) {
  const Bytes stream = stream_of(session, from);
  const Names names;
  Connection connection(names);
  std::vector<std::string> all;
  const Handler hear = [&](const Received& m) { all.push_back(std::string(m.sender) + " " + std::string(m.type)); };
  for (std::size_t i = 0; i < stream.size(); i += piece)
    connection.receive(View(stream).subspan(i, std::min(piece, stream.size() - i)), {}, hear);
  for (const json& event : session.at("events"))
    if (event.at("via") == "udp" && event.at("from") == from)
      connection.receive_datagram(from_hex(event.at("bytes")), hear);
  EXPECT_FALSE(connection.faulty()) << connection.fault();
  return all;
}

// Ids differ on the two sides: what counts is that every message is heard under the names its own side described.
TEST_F(GoldenBytes, WholeSessionsAreUnderstoodHoweverTheStreamIsCut) {
  for (const json& session : sessions_)
    for (const std::string from : {"client", "server"}) {
      std::vector<std::string> said;
      for (const char* via : {"tcp", "udp"})
        for (const json& event : session.at("events"))
          if (event.at("kind") == "message" && event.at("via") == via && event.at("from") == from)
            said.push_back(event.at("sender_name").get<std::string>() + " " + event.at("type_name").get<std::string>());
      ASSERT_FALSE(said.empty());
      for (const std::size_t piece : {1UL, 7UL, 100UL, 1UL << 20U})
        EXPECT_EQ(heard(session, from, piece), said) << piece;
    }
}

}  // namespace
}  // namespace verisim::vrpn::golden_bytes_test
