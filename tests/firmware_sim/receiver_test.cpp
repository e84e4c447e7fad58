// The receiver over noise: what it calls does not depend on how the stream is cut, and nothing goes uncounted.
#include <gtest/gtest.h>

#include <vector>

#include "engine/base/random.hpp"
#include "firmware_sim/protocol/frame.hpp"
#include "tests/length.hpp"

namespace verisim::protocol {
namespace receiver_test {

using Bytes = std::vector<std::uint8_t>;

/// Frames as they were accepted, sent again.
template <typename Named>
struct Echo {
  Bytes bytes;
  template <typename Message>
  void operator()(const Message& message) {
    std::uint8_t frame[longest_frame<Named>()];
    bytes.insert(bytes.end(), frame, frame + encode<Named>(message, frame));
  }
};

/// Good frames, frames with one byte changed or cut short, and bytes 0 to 5.
template <typename Named>
struct Noise {
  RandomStream random;
  std::uint64_t drawn = 0;
  Bytes bytes;

  explicit Noise(std::uint64_t seed) : random(seed, "receiver_test") {
    for (int piece = 0; piece < 40; ++piece) {
      if (below(3) == 0)
        for (std::uint64_t i = below(8); i > 0; --i) bytes.push_back(static_cast<std::uint8_t>(below(6)));
      else
        (void)find_message<Named>(*this);
    }
  }

  std::uint64_t below(std::uint64_t bound) { return random.bits(drawn++) % bound; }
  void operator()(std::int16_t& field) { field = static_cast<std::int16_t>(below(below(2) == 0 ? 6 : 65536)); }
  void operator()(float& field) { field = static_cast<float>(below(1000)) - 500; }

  template <typename Message>
  bool operator()(std::uint8_t id, const Message& /*message*/) {
    if (id + 1 < Named::count && below(Named::count) != 0) return false;
    Message message{};
    Message::visit(message, *this);
    std::uint8_t frame[longest_frame<Named>()];
    std::uint8_t length = encode<Named>(message, frame);
    const std::uint64_t damage = below(6);
    if (damage == 0) frame[below(length)] = static_cast<std::uint8_t>(below(256));
    if (damage == 1) length = static_cast<std::uint8_t>(below(length));
    bytes.insert(bytes.end(), frame, frame + length);
    return true;
  }
};

template <typename Named>
struct Outcome {
  Bytes accepted;
  Received received;
  int buffered;
};

template <typename Named, typename Cut>
Outcome<Named> receive(const Bytes& bytes, Cut&& cut) {
  Receiver<Named> receiver;
  Echo<Named> echo;
  for (std::size_t at = 0; at < bytes.size();) {
    const std::size_t piece = std::min<std::size_t>(cut(), bytes.size() - at);
    receiver.feed(bytes.data() + at, static_cast<std::uint32_t>(piece), echo);
    at += piece;
  }
  return {echo.bytes, receiver.received(), receiver.buffered()};
}

/// The published rule as it is written, over a buffer that takes everything.
template <typename Named>
Bytes receive_plainly(Bytes buffer) {
  Bytes accepted;
  for (;;) {
    while (!buffer.empty() && buffer.front() != kSoh) buffer.erase(buffer.begin());
    if (buffer.size() < 2) return accepted;
    const std::size_t length = frame_length_of<Named>(buffer[1]);
    bool is_good = length != 0;
    if (is_good && buffer.size() < 3) return accepted;
    is_good = is_good && buffer[2] == kStx;
    if (is_good && buffer.size() < length) return accepted;
    const std::size_t sum_length = Named::envelope == Envelope::basic_checksum ? 1 : 0;
    is_good = is_good && buffer[length - 2 - sum_length] == kEtx && buffer[length - 1] == kEot;
    if (is_good && sum_length == 1) {
      int sum = 0;
      for (std::size_t i = 0; i < length - 2; ++i) sum += buffer[i];
      is_good = (sum & 255) == buffer[length - 2];
    }
    const auto end = buffer.begin() + static_cast<std::ptrdiff_t>(is_good ? length : 1);
    if (is_good) accepted.insert(accepted.end(), buffer.begin(), end);
    buffer.erase(buffer.begin(), end);
  }
}

template <typename Named>
class Receivers : public testing::Test {};
using Collections = testing::Types<ComputerToRobot, RobotToComputer, BlueToGreen, GreenToBlue>;
TYPED_TEST_SUITE(Receivers, Collections);

TYPED_TEST(Receivers, CallTheSameHoweverTheStreamIsCut) {
  std::uint64_t accepted = 0, rejected = 0;
  for (std::uint64_t seed = 0; seed < (test::is_long() ? 20'000U : 500U); ++seed) {
    SCOPED_TRACE(seed);
    Noise<TypeParam> noise(seed);
    const auto whole = receive<TypeParam>(noise.bytes, [] { return std::size_t{100'000}; });
    const auto single = receive<TypeParam>(noise.bytes, [] { return std::size_t{1}; });
    const auto mixed = receive<TypeParam>(noise.bytes, [&noise] { return 1 + noise.below(70); });
    ASSERT_EQ(whole.accepted, receive_plainly<TypeParam>(noise.bytes));
    ASSERT_EQ(whole.accepted, single.accepted);
    ASSERT_EQ(whole.accepted, mixed.accepted);
    ASSERT_EQ(whole.buffered, single.buffered);
    accepted += whole.received.accepted;
    rejected += whole.received.rejected;
  }
  EXPECT_GT(accepted, 5000);  // else this has proven nothing
  EXPECT_GT(rejected, 500);
}

// A rejection takes one byte, the SOH; what is accepted, skipped or waits is the rest.
TYPED_TEST(Receivers, CountEachByteOfTheStreamOnce) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    Noise<TypeParam> noise(seed);
    const auto o = receive<TypeParam>(noise.bytes, [&noise] { return 1 + noise.below(40); });
    EXPECT_EQ(o.accepted.size() + o.received.rejected + o.received.discarded + static_cast<std::size_t>(o.buffered),
              noise.bytes.size());
  }
}

TYPED_TEST(Receivers, TakeNoMoreThanFits) {
  Receiver<TypeParam> receiver;
  const Bytes zeros(255);
  EXPECT_EQ(receiver.append(zeros.data(), 255), Receiver<TypeParam>::kCapacity);
  EXPECT_EQ(receiver.append(zeros.data(), 1), 0);
}

}  // namespace receiver_test
}  // namespace verisim::protocol
