// Coding without recordings: what is refused, and that nothing breaks it.
#include "engine/vrpn/message.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

#include "engine/base/random.hpp"
#include "engine/vrpn/payload.hpp"
#include "tests/length.hpp"

namespace verisim::vrpn::message_test {
namespace {

Bytes bytes_of(std::string_view text) {
  return {text.begin(), text.end()};
}

// The worked example of reference/vrpn_wire: "description of sender 1, Tracker0, length 37, 3 bytes of padding".
TEST(Message, IsWrittenAsInTheWorkedExample) {
  Bytes bytes;
  put_message(bytes, {{0x6b015990, 0x000c698f}, 1, kSenderDescription, 6, encode_name("Tracker0")});
  const Bytes expected = {0,    0,    0,    0x25, 0x6b, 0x01, 0x59, 0x90, 0, 0x0c, 0x69, 0x8f, 0, 0,
                          0,    1,    0xff, 0xff, 0xff, 0xff, 0,    0,    0, 6,    0,    0,    0, 9,
                          0x54, 0x72, 0x61, 0x63, 0x6b, 0x65, 0x72, 0x30, 0, 0,    0,    0};
  EXPECT_EQ(bytes, expected);
}

TEST(Message, NumbersReadAsTheyWereWritten) {
  Bytes bytes;
  put_uint32(bytes, 0xdeadbeef);
  put_int32(bytes, -2);
  put_float64(bytes, -0.1);
  Reader reader(bytes);
  EXPECT_EQ(reader.uint32(), 0xdeadbeefU);
  EXPECT_EQ(reader.int32(), -2);
  EXPECT_EQ(reader.float64(), -0.1);
  EXPECT_TRUE(reader.ok());
  EXPECT_EQ(reader.float64(), 0);
  EXPECT_FALSE(reader.ok());
}

TEST(Message, EveryBeginningIsIncompleteAndNothingElse) {
  Bytes bytes;
  put_message(bytes, {{1, 2}, 3, 4, 5, encode_analog(std::array{1.0, 2.0})});
  for (std::size_t n = 0; n < bytes.size(); ++n)
    EXPECT_EQ(first_message(View(bytes).first(n)).state, ParsedMessage::State::incomplete) << n;
  EXPECT_EQ(first_message(bytes).state, ParsedMessage::State::whole);
}

TEST(Message, RefusesALengthBelowTheHeaderAndAboveTheLimit) {
  for (const std::uint32_t length : {0U, 1U, 23U, 24U + 64009U, 0x7fffffffU, 0xffffffffU}) {
    Bytes bytes;
    put_uint32(bytes, length);
    EXPECT_EQ(first_message(bytes).state, ParsedMessage::State::malformed) << length;
  }
  for (const std::uint32_t length : {24U, 24U + 64008U}) {
    Bytes bytes;
    put_uint32(bytes, length);
    EXPECT_EQ(first_message(bytes).state, ParsedMessage::State::incomplete) << length;
  }
}

TEST(Cookie, IsComparedUpToTheMinorVersion) {
  const auto good = [](std::string text) {
    text.resize(kCookieBytes);
    return cookie_is_good(bytes_of(text));
  };
  EXPECT_TRUE(good("vrpn: ver. 07.38  0"));
  EXPECT_TRUE(good("vrpn: ver. 07.35  3"));
  EXPECT_FALSE(good("vrpn: ver. 08.38  0"));
  EXPECT_FALSE(good("vrpn: ver. 07.38  4"));
  EXPECT_FALSE(good("GET / HTTP/1.1\r\nHost: a"));
}

TEST(Payload, DecodersRefuseWhatIsNotExactlyRight) {
  const Bytes name = encode_name("Tracker0");
  EXPECT_FALSE(decode_name(View(name).first(name.size() - 1)));
  EXPECT_FALSE(decode_name({}));
  Bytes inner_nul = name;
  inner_nul[6] = 0;
  EXPECT_FALSE(decode_name(inner_nul));
  Bytes long_name;
  put_uint32(long_name, 97);
  put_text(long_name, std::string(96, 'x'));
  EXPECT_FALSE(decode_name(long_name));

  const Bytes analog = encode_analog(std::array{1.0, 2.0});
  EXPECT_FALSE(decode_analog(View(analog).first(16)));
  for (const double count : {-1.0, 1.5, 129.0, 1e300, std::numeric_limits<double>::quiet_NaN()}) {
    Bytes bad;
    put_float64(bad, count);
    bad.resize(2000);
    EXPECT_FALSE(decode_analog(bad)) << count;
  }
  EXPECT_FALSE(decode_text(bytes_of("1234567")));
}

TEST(Payload, ATextFromOutsideIsPrintable) {
  Bytes payload;
  put_uint32(payload, 1);
  put_uint32(payload, 0);
  put_text(payload, "\x1b[2Jhello\n");
  EXPECT_EQ(decode_text(payload)->text, "?[2Jhello?");
}

TEST(Payload, RequestsAreReadAsStockReadsThem) {
  const auto read = [](std::string_view text) { return decode_request(bytes_of(text)); };
  EXPECT_EQ(read("127.0.0.1 38833")->port, 38833);
  EXPECT_EQ(read(std::string_view("somewhere.org \t 2000 and more\0", 31))->host, "somewhere.org");
  for (const char* bad : {"", "127.0.0.1", "127.0.0.1 ", " 2000", "127.0.0.1 1023", "127.0.0.1 65536",
                          "127.0.0.1 99999999999", "a;b 2000", "a_b 2000", "host port"})
    EXPECT_FALSE(read(bad)) << bad;
  EXPECT_FALSE(read(std::string(300, 'a') + " 2000"));
}

/// Random bytes, or a good message of some kind with a few bytes changed.
Bytes any_bytes(const RandomStream& random, std::uint64_t k) {
  const std::uint64_t dice = random.bits(100 * k);
  Bytes bytes;
  if (dice % 4 != 0) {
    const std::array payloads = {encode_name("vrpn_Tracker Pos_Quat"), encode(SensorPose{}),
                                 encode_analog(std::array{1.0, 2.0, 3.0}), Bytes{}};
    const auto type = static_cast<std::int32_t>(dice >> 8U & 7U) - 5;
    put_message(bytes, {{1, 2}, static_cast<std::int32_t>(dice >> 16U & 3U), type, 0, payloads[dice >> 24U & 3U]});
  }
  if (dice % 4 < 2) bytes.resize(bytes.size() + (dice >> 32U & 63U));
  const std::uint64_t changes = dice % 4 == 0 ? bytes.size() : dice >> 40U & 3U;
  for (std::uint64_t i = 0; i < changes && !bytes.empty(); ++i) {
    const std::uint64_t r = random.bits(100 * k + 1 + i);
    bytes[dice % 4 == 0 ? i : (r >> 8U) % bytes.size()] = static_cast<std::uint8_t>(r);
  }
  return bytes;
}

// 10^6 inputs; 10^7 with VERISIM_LONG_TESTS=1. What is accepted must be worth accepting; nothing may read outside.
TEST(Fuzz, NoBytesBreakTheDecoders) {
  const RandomStream random(11, "wire fuzz");
  const std::uint64_t count = test::by_length<std::uint64_t>(200'000, 1'000'000, 10'000'000);
  std::uint64_t whole = 0;
  std::uint64_t understood = 0;
  for (std::uint64_t k = 0; k < count; ++k) {
    const Bytes bytes = any_bytes(random, k);
    const ParsedMessage parsed = first_message(bytes);
    (void)decode_request(bytes);
    if (parsed.state != ParsedMessage::State::whole) continue;
    ++whole;
    ASSERT_LE(parsed.bytes, bytes.size());
    const View payload = parsed.message.payload;
    ASSERT_LE(kHeaderBytes + payload.size(), parsed.bytes);
    const auto name = decode_name(payload);
    const auto analog = decode_analog(payload);
    const auto text = decode_text(payload);
    understood += name || analog ? 1 : 0;
    if (name) {
      ASSERT_LE(name->size(), kNameMax);
    }
    if (analog) {
      ASSERT_LE(analog->count, kChannelsMax);
    }
    if (text) {
      ASSERT_LE(text->text.size(), kTextMax);
    }
  }
  EXPECT_GT(whole, count / 4);
  EXPECT_GT(understood, count / 8) << "hardly anything was accepted: this test would prove little";
}

}  // namespace
}  // namespace verisim::vrpn::message_test
