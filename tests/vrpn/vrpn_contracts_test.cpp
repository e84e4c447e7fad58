// The doors of engine/vrpn: what this side says. What a peer says is survived, whatever it is (message_test,
// connection_test).
#include <gtest/gtest.h>

#include "engine/vrpn/client.hpp"
#include "engine/vrpn/payload.hpp"
#include "engine/vrpn/server.hpp"
#include "tests/support/broken.hpp"

namespace verisim::vrpn::vrpn_contracts_test {
namespace {

constexpr Address kLoopback{0x7f000001, 0};

TEST(NameDeathTest, FitsIntoADescription) {
  EXPECT_TRUE(is_name("Tracker0"));
  for (const std::string& name : {std::string(), std::string(kNameMax + 1, 'x'), std::string("a\0b", 3)}) {
    EXPECT_FALSE(is_name(name));
    EXPECT_BROKEN(encode_name(name), "is_name(name)");
    const Names as_sender{{name}, {}};
    const Names as_type{{}, {name}};
    EXPECT_BROKEN(Connection{as_sender}, "is_name(name)");
    EXPECT_BROKEN(Connection{as_type}, "is_name(name)");
    EXPECT_BROKEN(Server(kLoopback, {name}, {}), "is_name(name)");
  }
  const Names many{std::vector<std::string>(2000, "x"), {}};
  EXPECT_BROKEN(Connection{many}, "names.senders.size() < kIdCount");
  const Names many_types{{}, std::vector<std::string>(2000, "x")};
  EXPECT_BROKEN(Connection{many_types}, "names.types.size() < kIdCount");
}

// Before, a wrong name passed as long as nobody was connected.
TEST(ConnectionDeathTest, SendsInTheNameOfItsOwn) {
  const Names names{{"Tracker0"}, {std::string(kPose)}};
  Connection connection(names);
  EXPECT_BROKEN(connection.send("Tracker1", kPose, {}, {}), "sender_id >= 0");
  EXPECT_BROKEN(connection.send("Tracker0", kAnalog, {}, {}), "type_id >= 0");
  EXPECT_BROKEN(connection.datagram("Tracker0", kPose, {}, {}), "established_");
  EXPECT_BROKEN(connection.sent(kCookieBytes + 1), "bytes <= unsent().size()");
  Bytes cookie;
  put_cookie(cookie);
  connection.receive(cookie, {}, [](const Received&) {});
  EXPECT_BROKEN(connection.datagram("Tracker1", kPose, {}, {}), "sender_id >= 0");
  EXPECT_BROKEN(connection.datagram("Tracker0", kAnalog, {}, {}), "type_id >= 0");
}

TEST(MessageDeathTest, IsDatedAndFitsItsFrame) {
  Bytes out;
  EXPECT_BROKEN(put_message(out, {.time = {0, 1'000'000}, .payload = {}}), "message.time.microseconds < 1'000'000");
  const Bytes long_payload(kPaddedPayloadMax + 1);
  EXPECT_BROKEN(put_message(out, {.time = {}, .payload = long_payload}),
                "padded(message.payload.size()) <= kPaddedPayloadMax");
  EXPECT_BROKEN(cookie_is_good({}), "cookie.size() == kCookieBytes");
}

TEST(PayloadDeathTest, SaysWhatAPeerCanRead) {
  EXPECT_BROKEN(encode(SensorPose{-1, {}}), "pose.sensor >= 0");
  EXPECT_BROKEN(encode_analog(std::vector<double>(kChannelsMax + 1)), "channels.size() <= kChannelsMax");
  EXPECT_BROKEN(encode(ConnectionRequest{"", 4000}), "!request.host.empty()");
}

TEST(TurnDeathTest, WaitsNoLongerThanItIsTold) {
  Server server(kLoopback, {"Tracker0"}, {std::string(kPose)});
  EXPECT_BROKEN(server.turn({}, -1), "wait_ms >= 0");
  Client client(parse_remote_name("Tracker0@tcp:" + server.address().text()), false);
  EXPECT_BROKEN(client.turn({}, -1, [](const Received&) {}), "wait_ms >= 0");
}

}  // namespace
}  // namespace verisim::vrpn::vrpn_contracts_test
