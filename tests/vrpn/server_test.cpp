// Server and client over real sockets on the loopback interface, on ports that the system chooses.
#include "engine/vrpn/server.hpp"

#include <gtest/gtest.h>

#include "engine/base/error.hpp"
#include "engine/vrpn/client.hpp"
#include "engine/vrpn/payload.hpp"

namespace verisim::vrpn::server_test {
namespace {

constexpr Address kLoopback{0x7f000001, 0};
constexpr int kPatience = 4000;  // turns of a millisecond

/// Simulated: each turn is given the same second unless a test lets time pass.
struct Wire : testing::Test {
  Server server{kLoopback, {"Tracker0", "WiiMote0"}, {std::string(kPose), std::string(kAnalog)}};
  Timestamp now{1000, 0};

  [[nodiscard]] std::string name(const char* prefix = "") const {
    return std::string("WiiMote0@") + prefix + server.address().text();
  }
  /// Lets both run until `done`.
  template <typename Done>
  bool run(std::span<Client* const> clients, const Handler& handler, const Done& done) {
    for (int i = 0; i < kPatience && !done(); ++i) {
      server.turn(now, clients.size() == 1 ? 0 : 1);
      for (Client* client : clients) client->turn(now, clients.size() == 1 ? 1 : 0, handler);
    }
    return done();
  }
  void run_turns(std::span<Client* const> clients, const Handler& handler, int count) {
    int turns = 0;
    run(clients, handler, [&] { return ++turns > count; });
  }
  void publish(double value) { server.publish("WiiMote0", kAnalog, now, encode_analog(std::array{value})); }
  [[nodiscard]] std::string notices() {
    std::string all;
    for (const std::string& line : server.take_notices()) all += line + "\n";
    return all;
  }
};

void ignore(const Received& /*message*/) {}

/// Connects, greets by hand, and then does what the test wants.
struct HandMade {
  Socket socket;
  explicit HandMade(const Server& server) : socket(Socket::connect_tcp(server.address())) {}
  void say(const Bytes& bytes) const { EXPECT_EQ(socket.write(bytes), static_cast<int>(bytes.size())); }
  void greet() const {
    Bytes cookie;
    put_cookie(cookie);
    say(cookie);
  }
};

class WireInEveryWay : public Wire, public testing::WithParamInterface<std::tuple<const char*, bool>> {};

TEST_P(WireInEveryWay, ReportsArriveInOrderAndOnce) {
  const auto [prefix, use_udp] = GetParam();
  Client client(parse_remote_name(name(prefix)), use_udp);
  Client* const clients[] = {&client};
  ASSERT_TRUE(run(clients, ignore, [&] { return client.connected() && server.clients() == 1; }));
  run_turns(clients, ignore, 20);  // the UDP description is under way

  std::vector<double> heard;
  const Handler hear = [&](const Received& m) {
    if (m.type == kAnalog) heard.push_back(decode_analog(m.payload)->values[0]);
  };
  for (int i = 0; i < 100; ++i) {
    publish(i);
    run_turns(clients, hear, 1);
  }
  EXPECT_TRUE(run(clients, hear, [&] { return heard.size() == 100; }));
  for (std::size_t i = 0; i < heard.size(); ++i) EXPECT_EQ(heard[i], static_cast<double>(i));
}

INSTANTIATE_TEST_SUITE_P(Ways, WireInEveryWay,
                         testing::Values(std::tuple{"", true}, std::tuple{"", false}, std::tuple{"tcp://", true}));

TEST_F(Wire, ManyClientsAllHearEverything) {
  constexpr std::size_t kCount = 60;
  std::vector<std::unique_ptr<Client>> clients;
  std::vector<Client*> pointers;
  for (std::size_t i = 0; i < kCount; ++i) {
    clients.push_back(std::make_unique<Client>(parse_remote_name(name(i % 2 == 0 ? "" : "tcp:")), i % 4 == 0));
    pointers.push_back(clients.back().get());
  }
  ASSERT_TRUE(run(pointers, ignore, [&] { return server.clients() == kCount; }));
  run_turns(pointers, ignore, 20);
  std::size_t heard = 0;
  for (int i = 0; i < 10; ++i) publish(i);
  EXPECT_TRUE(run(
      pointers, [&](const Received& m) { heard += m.type == kAnalog ? 1 : 0; }, [&] { return heard == 10 * kCount; }));
}

TEST_F(Wire, AClientThatNeverReadsIsClosedAndTheOthersHearEverything) {
  const HandMade deaf(server);
  ASSERT_TRUE(run({}, ignore, [&] { return deaf.socket.write({}) >= 0; }));
  deaf.greet();
  Client client(parse_remote_name(name("tcp:")), false);
  Client* const clients[] = {&client};
  ASSERT_TRUE(run(clients, ignore, [&] { return server.clients() == 2; }));

  int published = 0;
  int heard = 0;
  const Handler count = [&](const Received& m) { heard += m.type == kAnalog ? 1 : 0; };
  const Bytes report = encode_analog(std::array<double, 128>{});
  while (server.clients() == 2 && published < 100'000) {
    server.publish("WiiMote0", kAnalog, now, report);
    ++published;
    run_turns(clients, count, 1);
  }
  EXPECT_EQ(server.clients(), 1U);
  EXPECT_NE(notices().find("does not read"), std::string::npos);
  EXPECT_TRUE(run(clients, count, [&] { return heard == published; })) << heard << " of " << published;
}

TEST_F(Wire, MalformedClientsAreClosedOneByOneWithTheReason) {
  Client client(parse_remote_name(name("tcp:")), false);
  Client* const clients[] = {&client};
  ASSERT_TRUE(run(clients, ignore, [&] { return server.clients() == 1; }));

  const HandMade wrong_cookie(server);
  const HandMade oversized(server);
  const HandMade truncated(server);
  run_turns(clients, ignore, 20);
  wrong_cookie.say(Bytes(64, 'G'));
  oversized.greet();
  oversized.say({0x00, 0x10, 0x00, 0x00});
  truncated.greet();
  truncated.say({0, 0, 0, 32, 1, 2, 3});  // and nothing more: it is waited for, and nobody else waits
  run_turns(clients, ignore, 50);

  const std::string said = notices();
  EXPECT_NE(said.find("does not speak VRPN protocol 07"), std::string::npos) << said;
  EXPECT_NE(said.find("impossible length"), std::string::npos) << said;
  EXPECT_EQ(server.clients(), 2U);
  int heard = 0;
  publish(1);
  EXPECT_TRUE(run(
      clients, [&](const Received& m) { heard += m.type == kAnalog ? 1 : 0; }, [&] { return heard == 1; }));
}

TEST_F(Wire, WhoSendsNoCookieDoesNotStayForEver) {
  const HandMade silent(server);
  run_turns({}, ignore, 20);
  now.seconds += Server::kGreetingMax + 1;
  run_turns({}, ignore, 2);
  EXPECT_NE(notices().find("no cookie"), std::string::npos);
}

TEST_F(Wire, RequestsThatCannotBeServedAreSurvived) {
  const Socket udp = Socket::bind_udp(kLoopback);
  for (const char* text : {"", "nonsense", "127.0.0.1 80", "127.0.0.1 1025", "no.such.host.invalid 40000"}) {
    const std::string_view s = text;
    udp.send_datagram(Bytes(s.begin(), s.end()), server.address());
  }
  udp.send_datagram(Bytes(1400, 'a'), server.address());
  run_turns({}, ignore, 30);
  EXPECT_EQ(server.clients(), 0U);
}

TEST_F(Wire, PingsAreAnsweredForOwnDevicesAlone) {
  const HandMade peer(server);
  run_turns({}, ignore, 10);
  peer.greet();
  Bytes bytes;
  put_message(bytes, {{}, 5, kSenderDescription, 0, encode_name("WiiMote0")});
  put_message(bytes, {{}, 6, kSenderDescription, 0, encode_name("Nobody")});
  put_message(bytes, {{}, 9, kTypeDescription, 0, encode_name(kPing)});
  put_message(bytes, {{}, 5, 9, 0, {}});
  put_message(bytes, {{}, 6, 9, 0, {}});
  peer.say(bytes);
  const Names none;
  Connection understanding(none);
  std::vector<std::string> heard;
  Bytes buffer(4096);
  run({}, ignore, [&] {
    const int n = peer.socket.read(buffer);
    if (n > 0)
      understanding.receive(View(buffer).first(static_cast<std::size_t>(n)), {}, [&](const Received& m) {
        heard.push_back(std::string(m.sender) + " " + std::string(m.type));
      });
    return !heard.empty();
  });
  EXPECT_EQ(heard, std::vector<std::string>{"WiiMote0 vrpn_Base pong_message"});
}

TEST_F(Wire, AClientThatLosesItsServerFindsTheNextOne) {
  auto first = std::make_unique<Server>(kLoopback, std::vector<std::string>{"WiiMote0"}, std::vector<std::string>{});
  const Address at = first->address();
  Client client(parse_remote_name("WiiMote0@tcp:" + at.text()), false);
  for (int i = 0; i < kPatience && !client.connected(); ++i) {
    first->turn(now, 0);
    client.turn(now, 1, ignore);
  }
  ASSERT_TRUE(client.connected());
  first.reset();
  Server second(at, {"WiiMote0"}, {});
  for (int i = 0; i < kPatience && second.clients() == 0; ++i) {
    now.seconds += 1;
    second.turn(now, 0);
    client.turn(now, 1, ignore);
  }
  EXPECT_EQ(second.clients(), 1U);
  EXPECT_NE(client.last_loss().find("closed the connection"), std::string::npos);
}

TEST_F(Wire, APortThatIsTakenIsAnError) {
  try {
    const Server second(server.address(), {"Tracker0"}, {});
    ADD_FAILURE() << "two servers on one port";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::io);
    EXPECT_NE(std::string(error.what()).find("--port"), std::string::npos);
  }
}

TEST(RemoteName, IsReadAsStockReadsIt) {
  const auto read = [](const char* text) {
    const RemoteName n = parse_remote_name(text);
    return fmt::format("{} {} {} {}", n.device, n.host, n.port, n.direct);
  };
  EXPECT_EQ(read("Tracker0@localhost"), "Tracker0 localhost 3883 false");
  EXPECT_EQ(read("Tracker0@x-vrpn://a.b:4000"), "Tracker0 a.b 4000 false");
  EXPECT_EQ(read("Tracker0@tcp://10.0.0.1:1"), "Tracker0 10.0.0.1 1 true");
  EXPECT_EQ(read("Tracker0@tcp:host"), "Tracker0 host 3883 true");
  for (const char* bad : {"Tracker0", "@host", "Tracker0@", "Tracker0@host:", "Tracker0@host:x", "Tracker0@h:70000"})
    EXPECT_THROW((void)parse_remote_name(bad), Error) << bad;
}

}  // namespace
}  // namespace verisim::vrpn::server_test
