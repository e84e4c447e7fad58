// One side of a connection, fed by hand: what it says, understands, refuses, and survives.
#include "engine/vrpn/connection.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

#include "engine/base/random.hpp"
#include "engine/vrpn/payload.hpp"
#include "tests/length.hpp"

namespace verisim::vrpn::connection_test {
namespace {

const Names kServerNames{{"Tracker0", "WiiMote0"}, {std::string(kPose), std::string(kAnalog), std::string(kPong)}};
const Names kClientNames{{"WiiMote0"}, {std::string(kPing)}};

void ignore(const Received& /*message*/) {}

/// Carries what one side has to send to the other.
void carry(Connection& from, Connection& to, const Handler& handler = ignore) {
  const View bytes = from.unsent();
  const Bytes copy(bytes.begin(), bytes.end());
  from.sent(copy.size());
  to.receive(copy, {}, handler);
}

class Pair : public testing::Test {
 protected:
  void greet() {
    carry(client_, server_);
    carry(server_, client_);
    carry(client_, server_);
    carry(server_, client_);
  }
  /// A system message of the client, made by hand.
  void client_says(std::int32_t type, std::int32_t sender, const Bytes& payload) {
    Bytes bytes;
    put_message(bytes, {{}, sender, type, 0, payload});
    server_.receive(bytes, {}, ignore);
  }

  Connection server_{kServerNames};
  Connection client_{kClientNames, UdpEnd{"127.0.0.1", 5000}};
};

TEST_F(Pair, NothingButTheCookieIsSaidBeforeThePeersCookie) {
  EXPECT_EQ(server_.unsent().size(), kCookieBytes);
  server_.send("Tracker0", kPong, {}, {});
  EXPECT_EQ(server_.unsent().size(), kCookieBytes);
}

TEST_F(Pair, EachUnderstandsTheOtherThoughTheirIdsDiffer) {
  greet();
  ASSERT_TRUE(server_.established());
  ASSERT_TRUE(client_.established());
  EXPECT_EQ(server_.peer_udp()->port, 5000);
  EXPECT_FALSE(client_.peer_udp());

  std::vector<std::string> heard;
  client_.send("WiiMote0", kPing, {}, {});  // sender 0 here, 1 there
  carry(client_, server_,
        [&](const Received& m) { heard.push_back(std::string(m.sender) + "/" + std::string(m.type)); });
  server_.send("WiiMote0", kAnalog, {7, 8}, encode_analog(std::array{1.5}));
  carry(server_, client_, [&](const Received& m) {
    heard.push_back(std::string(m.sender) + "/" + std::string(m.type));
    EXPECT_EQ(m.time.microseconds, 8U);
    EXPECT_EQ(decode_analog(m.payload)->values[0], 1.5);
  });
  EXPECT_EQ(heard, (std::vector<std::string>{"WiiMote0/vrpn_Base ping_message", "WiiMote0/vrpn_Analog Channel"}));
}

TEST_F(Pair, DatagramsCarryReportsAndMalformedOnesAreIgnored) {
  greet();
  int heard = 0;
  const Handler count = [&](const Received&) { ++heard; };
  Bytes datagram = server_.datagram("WiiMote0", kAnalog, {}, encode_analog(std::array{1.0}));
  const Bytes second = server_.datagram("Tracker0", kPose, {}, encode(SensorPose{}));
  datagram.insert(datagram.end(), second.begin(), second.end());
  client_.receive_datagram(datagram, count);
  EXPECT_EQ(heard, 2);
  for (std::size_t n = 0; n < second.size(); ++n) client_.receive_datagram(View(second).first(n), count);
  EXPECT_EQ(heard, 2);
  EXPECT_FALSE(client_.faulty());
}

TEST_F(Pair, AWrongCookieIsAFault) {
  server_.receive(Bytes(kCookieBytes, 'x'), {}, ignore);
  EXPECT_TRUE(server_.faulty());
  EXPECT_NE(server_.fault().find("protocol 07"), std::string::npos);
}

TEST_F(Pair, WhatDropsAConnectionAtStockIsAFaultHere) {
  const std::vector<std::tuple<const char*, std::int32_t, std::int32_t, Bytes>> bad = {
      {"type -2000", -2000, 0, {}},
      {"id 2000", kSenderDescription, 2000, encode_name("a")},
      {"negative id", kTypeDescription, -1, encode_name("a")},
      {"no name", kTypeDescription, 1, {}},
      {"long name", kSenderDescription, 1, Bytes(101, 'a')},
  };
  for (const auto& [what, type, sender, payload] : bad) {
    Connection server(kServerNames);
    Bytes bytes;
    put_cookie(bytes);
    put_message(bytes, {{}, sender, type, 0, payload});
    server.receive(bytes, {}, ignore);
    EXPECT_TRUE(server.faulty()) << what;
  }
  greet();
  server_.receive(Bytes(4, 0), {}, ignore);  // a message of length 0
  EXPECT_TRUE(server_.faulty());
}

TEST_F(Pair, UndescribedNamesUnknownSystemMessagesAndHalfMessagesAreNoFault) {
  greet();
  client_says(42, 17, {});
  client_says(-7, 0, {});
  client_says(kSenderDescription, 1999, encode_name("far"));
  server_.receive(Bytes{0, 0, 0, 24, 1, 2, 3}, {}, ignore);
  EXPECT_FALSE(server_.faulty());
}

TEST_F(Pair, AnIdDescribedAgainTakesTheNewNameAndDisconnectForgets) {
  greet();
  std::string heard;
  const Handler hear = [&](const Received& m) { heard = m.sender; };
  client_says(kSenderDescription, 0, encode_name("Other"));
  client_.send("WiiMote0", kPing, {}, {});
  carry(client_, server_, hear);
  EXPECT_EQ(heard, "Other");
  client_says(kDisconnect, 0, {});
  heard.clear();
  client_.send("WiiMote0", kPing, {}, {});
  carry(client_, server_, hear);
  EXPECT_EQ(heard, "");
}

TEST_F(Pair, APeerThatNeverReadsMeetsABoundedQueue) {
  greet();
  const Bytes report = encode_analog(std::array<double, 16>{});
  for (int i = 0; i < 100'000 && !server_.faulty(); ++i) server_.send("WiiMote0", kAnalog, {}, report);
  EXPECT_TRUE(server_.faulty());
  EXPECT_NE(server_.fault().find("does not read"), std::string::npos);
  EXPECT_LE(server_.unsent().size(), Connection::kUnsentMax + 200);
}

// Streams that begin well and then change: whole conversations, 10^5 of them; 10^6 with VERISIM_LONG_TESTS=1.
TEST(Fuzz, NoStreamBreaksAConnection) {
  const RandomStream random(5, "stream fuzz");
  Bytes good;
  put_cookie(good);
  put_message(good, {{}, 5000, kUdpDescription, 0, Bytes{'h', 0}});
  put_message(good, {{}, 0, kSenderDescription, 0, encode_name("WiiMote0")});
  put_message(good, {{}, 0, kTypeDescription, 0, encode_name(kPing)});
  put_message(good, {{}, 0, 0, 0, {}});
  const std::uint64_t count = test::by_length<std::uint64_t>(20'000, 100'000, 1'000'000);
  std::uint64_t heard = 0;
  std::uint64_t faults = 0;
  for (std::uint64_t k = 0; k < count; ++k) {
    Bytes stream = good;
    const std::uint64_t dice = random.bits(10 * k);
    for (std::uint64_t i = 0; i < dice % 4; ++i) {
      const std::uint64_t r = random.bits(10 * k + 1 + i);
      stream[(r >> 8U) % stream.size()] = static_cast<std::uint8_t>(r);
    }
    Connection connection(kServerNames);
    const std::size_t cut = (dice >> 8U) % stream.size();
    const Handler hear = [&](const Received&) { ++heard; };
    connection.receive(View(stream).first(cut), {}, hear);
    connection.receive(View(stream).subspan(cut), {}, hear);
    connection.receive_datagram(stream, hear);
    faults += connection.faulty() ? 1 : 0;
    ASSERT_LT(connection.unsent().size(), 2000U);
  }
  EXPECT_GT(heard, count / 4);
  EXPECT_GT(faults, count / 100);
}

}  // namespace
}  // namespace verisim::vrpn::connection_test
