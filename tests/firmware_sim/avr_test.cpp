// The firmware's machine code on a simulated ATmega328P, against the host board and against its promises.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "engine/base/random.hpp"
#include "tests/firmware_sim/bench_robot.hpp"
#include "tests/length.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/paths.hpp"

namespace verisim::firmware {
namespace avr_test {

using bench::Bench;
using bench::Heard;

const std::string kProgram = paths::in_build("verisim-avr");

class Avr : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kProgram))
      GTEST_SKIP() << kProgram << " is not built: gcc-avr, avr-libc, libsimavr-dev or libelf-dev is missing";
  }
};

/// Encoders that all turn at one rate, each edge moved by up to a quarter of an interval: a phase-locked rate hides
/// losses.
class Edges {
 public:
  explicit Edges(double edges_per_s) : interval_(kClockHz * 4.0 / edges_per_s) {
    for (std::size_t wheel = 0; wheel < 4; ++wheel)
      next_[wheel] = interval_ * (0.3 + 0.21 * static_cast<double>(wheel));
  }

  std::span<const EncoderEdge> millisecond() {
    edges_.clear();
    for (std::uint8_t wheel = 0; wheel < 4; ++wheel) {
      for (double at = jittered(wheel); at < kCyclesPerMs; at = jittered(wheel)) {
        edges_.push_back({static_cast<std::uint32_t>(std::max(at, 0.0)), wheel, bench::levels_of(++count_[wheel])});
        next_[wheel] += interval_;
      }
      next_[wheel] -= kCyclesPerMs;
    }
    std::stable_sort(edges_.begin(), edges_.end(), [](const auto& a, const auto& b) { return a.cycle < b.cycle; });
    return edges_;
  }

 private:
  double jittered(std::uint8_t wheel) {
    const auto number = static_cast<std::uint64_t>(count_[wheel]) * 4 + wheel;
    return next_[wheel] + interval_ * 0.5 * (random_.uniform(number) - 0.5);
  }

  double interval_;
  RandomStream random_{1, "avr_test"};
  std::array<double, 4> next_{};
  std::array<std::int64_t, 4> count_{};
  std::vector<EncoderEdge> edges_;
};

void run(Board& board, Edges& edges, bench::Line& line, int ms) {
  for (int i = 0; i < ms; ++i) {
    if (i % 20 == 0) line.send(protocol::XYIntVelocities{570, 0});
    board.advance(edges.millisecond(), line.next());
    line.hear(board.sent());
  }
}

TEST_F(Avr, At22400EdgesPerSecondLosesNoneAndHasTimeLeft) {
  const std::unique_ptr<Board> board = make_avr_board(kProgram);
  Edges edges(22'400);
  bench::Line line;
  line.send(protocol::StartControl{});
  const int ms = test::by_length(500, 3000, 60'000);
  const auto begin = std::chrono::steady_clock::now();
  run(*board, edges, line, ms);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  const BoardLoad& load = board->load();
  const double busy = static_cast<double>(load.busy_cycles) / static_cast<double>(load.cycles);
  const double shortest = load.control_period_min / 80'000.0, longest = load.control_period_max / 80'000.0;
  std::printf(
      "22,400 edges/s, jittered: %llu seen, %llu lost, %.1f %% of the cycles (interrupts %.1f %%), control period "
      "%.2f to %.2f %%, %.2f x real time\n",
      static_cast<unsigned long long>(load.edges_seen), static_cast<unsigned long long>(load.edges_lost), 100 * busy,
      100 * static_cast<double>(load.interrupt_cycles) / static_cast<double>(load.cycles), 100 * shortest,
      100 * longest, ms * 1e-3 / took.count());
  EXPECT_NEAR(static_cast<double>(load.edges_seen), 22.4 * ms, 10);
  EXPECT_EQ(load.edges_lost, 0U);
  EXPECT_EQ(load.bytes_lost, 0U);
  EXPECT_LT(busy, 0.70);
  EXPECT_GT(shortest, 0.95);
  EXPECT_LT(longest, 1.05);
  // The edges that begin and end a sample's 27 or more intervals are each a quarter of one off: 1.9 %.
  for (const std::int16_t velocity : line.heard.velocities) EXPECT_NEAR(velocity, 7000, 130);
  EXPECT_EQ(line.receiver.received().rejected, 0U);
}

// Reported, not promised: where the promise ends.
TEST_F(Avr, LosesItsFirstEdgeFarAboveTheFastestDrive) {
  double rate = 22'400;
  for (std::uint64_t lost = 0; lost == 0 && rate < 1e6; rate *= 1.1) {
    const std::unique_ptr<Board> board = make_avr_board(kProgram);
    Edges edges(rate);
    bench::Line line;
    run(*board, edges, line, test::by_length(50, 200, 1000));
    lost = board->load().edges_lost;
    if (lost != 0)
      std::printf("first lost edge: at %.0f edges/s, %llu of %llu\n", rate, static_cast<unsigned long long>(lost),
                  static_cast<unsigned long long>(board->load().edges_seen));
  }
  EXPECT_GT(rate, 2 * 22'400);
}

/// The largest differences of two robots' reports, frame by frame.
struct Differences {
  int setpoint = 0, velocity = 0, pwm = 0;
  std::int64_t frames = 0, velocities_differ = 0, pwm_differ = 0;

  void compare(const Heard& a, const Heard& b) {
    for (std::size_t wheel = 0; wheel < 4; ++wheel) {
      const auto apart = [wheel](const auto& x, const auto& y) { return std::abs(x[wheel] - y[wheel]); };
      setpoint = std::max(setpoint, apart(a.setpoints, b.setpoints));
      velocity = std::max(velocity, apart(a.velocities, b.velocities));
      pwm = std::max(pwm, apart(a.pwm, b.pwm));
      velocities_differ += apart(a.velocities, b.velocities) != 0 ? 1 : 0;
      pwm_differ += apart(a.pwm, b.pwm) != 0 ? 1 : 0;
    }
    ++frames;
  }
};

/// What a board reports, one report after the other.
struct Reports {
  std::vector<Heard> all;
  Heard now;
  template <typename Message>
  void operator()(const Message& message) {
    now(message);
    if (Message::name() == protocol::CurrentPWMOutput::name()) all.push_back(now);  // the last of three
  }
};

struct Driven {
  Reports host, avr;
  std::size_t bytes_host = 0, bytes_avr = 0;
};

/// Random commands, the host board in the loop; the AVR board gets the same bytes and edges.
Driven drive_both(int ms) {
  const std::unique_ptr<Board> avr = make_avr_board(kProgram);
  Bench b(make_host_board());
  for (bench::Motor& motor : b.robot.motors) motor.tau_s = 0.06;
  RandomStream random(11, "avr_test");
  Driven driven;
  protocol::Receiver<protocol::RobotToComputer> from_host, from_avr;
  protocol::XYRotationIntVelocities command{0, 0, 0};
  b.line.send(protocol::StartControl{});
  for (int i = 0; i < ms; ++i) {
    if (i % 300 == 0) {
      const auto draw = [&](int field) {
        return static_cast<std::int16_t>(700 * random.uniform(static_cast<std::uint64_t>(3 * i + field)) - 350);
      };
      command = {draw(0), draw(1), draw(2)};
    }
    if (i % 33 == 0) b.line.send(command);
    const std::span<const EncoderEdge> edges = b.robot.advance(b.board->duty());
    const std::span<const TimedByte> bytes = b.line.next();
    b.board->advance(edges, bytes);
    avr->advance(edges, bytes);
    for (const TimedByte& byte : b.board->sent()) from_host.feed(&byte.value, 1, driven.host);
    for (const TimedByte& byte : avr->sent()) from_avr.feed(&byte.value, 1, driven.avr);
    driven.bytes_host += b.board->sent().size();
    driven.bytes_avr += avr->sent().size();
  }
  return driven;
}

// Both boards compute with integers. What differs is when an interrupt notes an edge: at once on the host, after some
// 60 cycles on the AVR, and up to 330 more if it waits for the longest other one. That is up to 6 ticks of 4 us in the
// 1200 or more between the first and the last edge of a sample: 0.5 % of a velocity, 35 RPM at most. An edge within
// these cycles of a sample's begin counts in the next one, and its time with it. Setpoints depend on bytes alone and
// are equal. A PWM differs by Kp times the velocity's (2), its rounding (1), what the integral has of the last ones
// (2), and by the 24 that overcome the bridge in the one sample in which one board already lets go.
TEST_F(Avr, ReportsWhatTheHostReportsToTheLatencyOfAnInterrupt) {
  const Driven driven = drive_both(test::by_length(2000, 6000, 60'000));
  ASSERT_NEAR(static_cast<double>(driven.bytes_host), static_cast<double>(driven.bytes_avr), 12);
  const std::size_t count = std::min(driven.host.all.size(), driven.avr.all.size());
  ASSERT_GT(count, 90U);
  Differences d;
  for (std::size_t i = 0; i < count; ++i) d.compare(driven.host.all[i], driven.avr.all[i]);
  std::printf(
      "%lld reports: largest difference setpoint %d, velocity %d RPM (%.1f %% differ), PWM %d (%.1f %% differ)\n",
      static_cast<long long>(d.frames), d.setpoint, d.velocity,
      25.0 * static_cast<double>(d.velocities_differ) / static_cast<double>(d.frames), d.pwm,
      25.0 * static_cast<double>(d.pwm_differ) / static_cast<double>(d.frames));
  EXPECT_EQ(d.setpoint, 0);
  EXPECT_LE(d.velocity, 35);
  EXPECT_LE(d.pwm, 2 + 1 + 2 + 24);
}

TEST_F(Avr, TheSameInputGivesTheSameBytesAndCycles) {
  const auto once = [] {
    const std::unique_ptr<Board> board = make_avr_board(kProgram);
    Edges edges(9000);
    bench::Line line;
    line.send(protocol::StartControl{});
    std::vector<std::uint32_t> seen;
    for (int i = 0; i < 500; ++i) {
      run(*board, edges, line, 1);
      for (const TimedByte& byte : board->sent()) seen.insert(seen.end(), {byte.cycle, byte.value});
      for (const std::int16_t duty : board->duty()) seen.push_back(static_cast<std::uint32_t>(duty + 255));
    }
    seen.push_back(static_cast<std::uint32_t>(board->load().busy_cycles));
    return seen;
  };
  EXPECT_EQ(once(), once());
}

TEST_F(Avr, DrivesTheBenchAndStopsInSilence) {
  Bench b(make_avr_board(kProgram));
  for (bench::Motor& motor : b.robot.motors) motor.tau_s = 0.06;
  b.line.send(protocol::StartControl{});
  b.drive(protocol::XYIntVelocities{300, 0}, 600);
  for (const bench::Motor& motor : b.robot.motors) EXPECT_NEAR(motor.rpm, 3667, 120);
  b.run(900);
  EXPECT_EQ(b.board->duty(), (std::array<std::int16_t, 4>{}));
  EXPECT_EQ(b.line.heard.setpoints, (std::array<std::int16_t, 4>{}));
  EXPECT_EQ(b.board->load().edges_lost, 0U);
}

TEST_F(Avr, AResetOrLossOfPowerInMidDriveForgetsEverything) {
  for (const bool by_power : {false, true}) {
    Bench b(make_avr_board(kProgram));
    b.line.send(protocol::StartControl{});
    b.drive(protocol::XYIntVelocities{300, 0}, 200);
    EXPECT_NE(b.board->duty()[0], 0);
    if (by_power) {
      b.board->set_powered(false);
      b.drive(protocol::XYIntVelocities{300, 0}, 50);
      EXPECT_TRUE(b.board->sent().empty());
      b.board->set_powered(true);
    } else {
      b.board->reset();
    }
    EXPECT_EQ(b.board->duty()[0], 0);
    b.drive(protocol::XYIntVelocities{300, 0}, 200);
    EXPECT_EQ(b.board->duty()[0], 0);
    EXPECT_EQ(b.line.heard.setpoints[0], 0);
    b.line.send(protocol::StartControl{});
    b.drive(protocol::XYIntVelocities{300, 0}, 200);
    EXPECT_NEAR(b.robot.motors[0].rpm, 3667, 200);
    EXPECT_EQ(b.board->load().edges_lost, 0U);
  }
}

TEST_F(Avr, AFloodBeyondAnyLineLosesBytesAndSaysSo) {
  Bench b(make_avr_board(kProgram));
  b.line.send(protocol::StartControl{});
  b.run(20);
  const std::vector<TimedByte> flood(1000, TimedByte{100, 1});
  b.board->advance({}, flood);
  EXPECT_GT(b.board->load().bytes_lost, 900U);
  b.run(100);
  b.drive(protocol::XYIntVelocities{300, 0}, 300);
  EXPECT_NE(b.board->duty()[0], 0);
}

// Its input ends after some milliseconds, so it ends: as when it crashes, the board has lost it.
TEST_F(Avr, AProgramThatEndsInMidRunIsAnErrorNotAHang) {
  const test::Folder folder;
  const std::string program = folder.file("short-lived");
  std::ofstream(program) << "#!/bin/sh\ndd bs=1 count=120 2>/dev/null | " << kProgram << "\n";
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  const std::unique_ptr<Board> board = make_avr_board(program);
  EXPECT_THROW(
      {
        for (int i = 0; i < 1000; ++i) board->advance({}, {});
      },
      std::runtime_error);
}

TEST(AvrMissing, SaysWhatItNeeds) {
  try {
    (void)make_avr_board("/nowhere/verisim-avr");
    FAIL();
  } catch (const std::exception& error) {
    EXPECT_NE(std::string(error.what()).find("libsimavr-dev"), std::string::npos) << error.what();
  }
}

TEST(AvrMissing, AProgramThatEndsIsAnErrorNotAHang) {
  try {
    (void)make_avr_board("/bin/true");
    FAIL();
  } catch (const std::exception& error) {
    EXPECT_NE(std::string(error.what()).find("has ended"), std::string::npos) << error.what();
  }
}

}  // namespace avr_test
}  // namespace verisim::firmware
