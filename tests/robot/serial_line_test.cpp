// A serial line: when bytes arrive, what is lost, and what a UART reads that runs at another rate than the sender.
#include "engine/robot/serial_line.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/random_inputs.hpp"
#include "tests/support/refusal.hpp"

namespace verisim::robot::serial_line_test {
namespace {

using Bytes = std::vector<std::uint8_t>;

struct Arrival {
  std::uint64_t cycle;  ///< since the line was made
  std::uint8_t value;
};

/// Everything that arrives within so many milliseconds.
std::vector<Arrival> arrivals(SerialLine& line, std::uint64_t milliseconds) {
  std::vector<Arrival> all;
  for (std::uint64_t ms = 0; ms < milliseconds; ++ms)
    for (const TimedByte& byte : line.advance()) all.push_back({ms * firmware::kCyclesPerMs + byte.cycle, byte.value});
  return all;
}

Bytes values(const std::vector<Arrival>& all) {
  Bytes bytes;
  for (const Arrival& arrival : all) bytes.push_back(arrival.value);
  return bytes;
}

// 115,200 baud: a bit is 16e6 / 115200 = 138.89 cycles. The stop bit is sampled in its middle, 9.5 bits after the
// start: 1319.4 cycles. The next byte follows 10 bits later, 2708.3.
TEST(SerialLine, ByteArrivesInTheMiddleOfItsStopBit) {
  SerialLine line({.latency = 0}, 1, "up");
  line.send(Bytes{0x41, 0x42});
  const auto all = arrivals(line, 1);
  ASSERT_EQ(values(all), (Bytes{0x41, 0x42}));
  EXPECT_EQ(all[0].cycle, 1319U);
  EXPECT_EQ(all[1].cycle, 2708U);
}

TEST(SerialLine, LatencyComesOnTop) {
  SerialLine line({.latency = 0.0035}, 1, "up");
  line.send(Bytes{0x41});
  EXPECT_EQ(arrivals(line, 10).at(0).cycle, 1319U + 3 * 16'000U + 8'000U);
}

// A board hands bytes over at its own times; the wire is free at each of them.
TEST(SerialLine, ByteOfABoardStartsAtItsCycle) {
  SerialLine line({.latency = 0}, 1, "down");
  line.send(std::vector<TimedByte>{{100, 1}, {9'000, 2}});
  const auto all = arrivals(line, 1);
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].cycle, 100U + 1319U);
  EXPECT_EQ(all[1].cycle, 9'000U + 1319U);
}

// Ten bits a byte: 115,200 baud carries 11.52 bytes a millisecond, 11,520 a second and no more.
TEST(SerialLine, CarriesATenthOfItsBaudRate) {
  SerialLine line({.latency = 0, .buffer = 65'536}, 1, "up");
  line.send(Bytes(20'000, 0x55));
  EXPECT_EQ(arrivals(line, 1000).size(), 11'520U);
}

TEST(SerialLine, EveryStreamComesThroughAsItWasSent) {
  for (const std::uint64_t seed : test::seeds(50)) {
    SCOPED_TRACE(seed);
    test::Inputs inputs(seed);
    const auto baud = static_cast<std::uint32_t>(inputs.between(1200, 1'000'000));
    SerialLine line({.baud = baud, .receiver_baud = baud, .latency = inputs.between(0, 0.02), .buffer = 65'536}, seed,
                    "up");
    Bytes sent, got;
    for (int ms = 0; ms < 200; ++ms) {
      Bytes piece;
      for (int i = static_cast<int>(inputs.between(0, 4)); i > 0; --i)
        piece.push_back(static_cast<std::uint8_t>(inputs.between(0, 256)));
      line.send(piece);
      sent.insert(sent.end(), piece.begin(), piece.end());
      for (const TimedByte& byte : line.advance()) got.push_back(byte.value);
    }
    for (int ms = 0; ms < 5000; ++ms)
      for (const TimedByte& byte : line.advance()) got.push_back(byte.value);
    EXPECT_EQ(got, sent);
    EXPECT_EQ(line.counts().framing_errors, 0U);
  }
}

TEST(SerialLine, CountsWhatDoesNotFit) {
  SerialLine line({.latency = 0, .buffer = 8}, 1, "up");
  line.send(Bytes(20, 0x33));
  EXPECT_EQ(arrivals(line, 5).size(), 8U);
  EXPECT_EQ(line.counts().overflowed, 12U);
}

// 1 of 10 lost: of 20,000, 2000 +- 42 (one standard deviation); five of them.
TEST(SerialLine, LosesTheFractionThatItIsTold) {
  SerialLine line({.latency = 0, .loss = 0.1, .buffer = 65'536}, 7, "up");
  line.send(Bytes(20'000, 0x55));
  (void)arrivals(line, 2000);
  EXPECT_NEAR(static_cast<double>(line.counts().lost), 2000, 5 * 42.4);
  EXPECT_EQ(line.counts().received + line.counts().lost, 20'000U);
}

// A byte is spared with probability (1 - p)^10. A stop bit that is low for good is a framing error; what follows a
// false start is read shifted, so that bytes can be wrong although the sender's were whole, and others are not seen.
TEST(SerialLine, InvertsBitsAndTheReceiverStaysInStep) {
  SerialLine line({.latency = 0, .corruption = 0.01}, 7, "up");
  std::uint64_t wrong = 0, got = 0;
  constexpr int kSent = 10'000;
  for (int i = 0; i < kSent; ++i) {  // one a millisecond: the line is idle between them
    line.send(Bytes{0x5a});
    for (const TimedByte& byte : line.advance()) {
      ++got;
      wrong += byte.value != 0x5a ? 1 : 0;
    }
  }
  const double spared = std::pow(0.99, 10);
  EXPECT_NEAR(static_cast<double>(line.counts().damaged), kSent * (1 - spared), 5 * std::sqrt(kSent * spared * 0.0956));
  EXPECT_GT(line.counts().framing_errors, 50U);
  EXPECT_GT(wrong, 500U);
  EXPECT_EQ(got - wrong, kSent - line.counts().damaged) << "a whole byte was spoilt, or a damaged one came out whole";
}

// The sender's bits 0 1 0 0 0 0 0 1 0 1 (0x41 = 'A', least first) at half the receiver's rate: it sees each bit twice.
// Start, then 0 1 1 0 0 0 0 0 of which the first is the start bit again: 0x06, and its stop bit is the ninth half bit
// after the start: 0, a framing error. Nothing of 'A' comes out as 'A'.
TEST(SerialLine, ReceiverAtTwiceTheRateSeesEachBitTwice) {
  SerialLine line({.baud = 57'600, .receiver_baud = 115'200, .latency = 0}, 1, "up");
  line.send(Bytes{0x41});
  for (const Arrival& arrival : arrivals(line, 3)) EXPECT_NE(arrival.value, 0x41);
  EXPECT_GE(line.counts().framing_errors, 1U);
}

// UARTs tolerate half a bit in 9.5: 5 % in all, whichever side is fast (data sheet: +-4.5 % with its three samples).
TEST(SerialLine, UartTakesFourPercentAndNotSeven) {
  for (const double off : {-0.07, -0.04, 0.04, 0.07}) {
    SCOPED_TRACE(off);
    SerialLine line({.receiver_baud = static_cast<std::uint32_t>(115'200 * (1 + off)), .latency = 0}, 1, "up");
    Bytes sent, got;
    for (int i = 0; i < 256; ++i) {
      sent.push_back(static_cast<std::uint8_t>(i));
      line.send(Bytes{sent.back()});
      for (const TimedByte& byte : line.advance()) got.push_back(byte.value);
      for (const TimedByte& byte : line.advance()) got.push_back(byte.value);
    }
    EXPECT_EQ(got == sent, std::abs(off) < 0.05);
  }
}

TEST(SerialLine, AnyTwoRatesGiveBytesOrCountedErrorsAndNoEnd) {
  for (const std::uint64_t seed : test::seeds(40)) {
    SCOPED_TRACE(seed);
    test::Inputs inputs(seed);
    SerialLine line({.baud = static_cast<std::uint32_t>(inputs.between(1200, 500'000)),
                     .receiver_baud = static_cast<std::uint32_t>(inputs.between(1200, 500'000)),
                     .latency = inputs.between(0, 0.05),
                     .corruption = inputs.between(0, 0.6)},
                    seed, "up");
    for (int ms = 0; ms < 500; ++ms) {
      Bytes piece;
      for (int i = 0; i < 20; ++i) piece.push_back(static_cast<std::uint8_t>(inputs.between(0, 256)));
      line.send(piece);
      std::uint32_t before = 0;
      for (const TimedByte& byte : line.advance()) {
        ASSERT_GE(byte.cycle, before);
        ASSERT_LT(byte.cycle, firmware::kCyclesPerMs);
        before = byte.cycle;
      }
    }
    EXPECT_GT(line.counts().framing_errors + line.counts().received, 0U);
  }
}

TEST(SerialLine, UnpluggedIsSilentAndSaysSo) {
  SerialLine line({.latency = 0}, 1, "up");
  RobotNotes notes;
  line.plug(false);
  line.send(Bytes{1, 2, 3});
  EXPECT_TRUE(arrivals(line, 1).empty());
  line.report(notes);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_STREQ(notes.begin()->text, "loses bytes");
  line.plug(true);
  line.send(Bytes{4});
  EXPECT_EQ(values(arrivals(line, 1100)), Bytes{4});
  line.report(notes);
  EXPECT_EQ(notes.size(), 2U);
  EXPECT_EQ(line.counts().lost, 3U);
}

TEST(SerialLine, SameSeedAndNameGiveTheSameBytesAndOthersDoNot) {
  const auto heard = [](std::uint64_t seed, const char* name) {
    SerialLine line({.latency = 0, .loss = 0.2, .corruption = 0.02, .buffer = 4096}, seed, name);
    line.send(Bytes(1000, 0x5a));
    return values(arrivals(line, 200));
  };
  EXPECT_EQ(heard(1, "up"), heard(1, "up"));
  EXPECT_NE(heard(1, "up"), heard(2, "up"));
  EXPECT_NE(heard(1, "up"), heard(1, "down"));
}

TEST(SerialLine, RefusesWhatNoLineHas) {
  const auto made = [](const SerialLineSettings& settings) {
    return [settings] { return SerialLine(settings, 1, "up").counts().sent; };
  };
  test::expect_refused(made({.baud = 0}), "serial line 'up': baud is 0 but must be from 1200 to 2000000");
  test::expect_refused(made({.receiver_baud = 3'000'000}), "baud is 3000000");
  test::expect_refused(made({.latency = -1}), "latency is -1");
  test::expect_refused(made({.loss = 1.5}), "loss is 1.5");
  test::expect_refused(made({.corruption = std::nan("")}), "corruption is nan");
  test::expect_refused(made({.buffer = 0}), "buffer is 0");
}

}  // namespace
}  // namespace verisim::robot::serial_line_test
