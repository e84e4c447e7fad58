#include "engine/base/hash.hpp"

#include <gtest/gtest.h>
#include <xxhash.h>

#include <vector>

namespace verisim::hash_test {
namespace {

// FIPS 180-4 examples and the digest of nothing.
TEST(Sha256, GivesThePublishedDigests) {
  EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(sha256(std::string(1000000, 'a')), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

// XXH3-64 of nothing is published with the algorithm; the other guards against a library that changes.
TEST(HashBytes, GivesTheKnownValues) {
  EXPECT_EQ(hash_bytes("", 0, 0), 0x2d06800538d394c2u);
  EXPECT_EQ(hash_bytes("verisim", 7, 0), 0x15b1770396e85418u);
}

TEST(HashBytes, DependsOnSeedLengthAndEveryBit) {
  std::vector<unsigned char> data(300, 0);
  const std::uint64_t plain = hash_bytes(data.data(), data.size(), 0);
  EXPECT_NE(hash_bytes(data.data(), data.size(), 1), plain);
  EXPECT_NE(hash_bytes(data.data(), data.size() - 1, 0), plain);
  for (std::size_t bit = 0; bit < data.size() * 8; ++bit) {
    data[bit / 8] ^= static_cast<unsigned char>(1u << (bit % 8));
    EXPECT_NE(hash_bytes(data.data(), data.size(), 0), plain) << "bit " << bit;
    data[bit / 8] ^= static_cast<unsigned char>(1u << (bit % 8));
  }
}

// The library's plain function, without a choice of vectors, on both sides of where wider ones take over.
TEST(HashBytes, OfKilobytesAreThoseOfTheLibrarysPlainFunction) {
  std::vector<unsigned char> data(40000);
  for (std::size_t i = 0; i < data.size(); ++i) data[i] = static_cast<unsigned char>(i * i + 7 * i / 3);
  for (std::size_t size = 3000; size <= data.size(); size += 137)
    for (const std::uint64_t seed : {std::uint64_t{0}, std::uint64_t{0x9e3779b97f4a7c15}})
      EXPECT_EQ(hash_bytes(data.data(), size, seed), XXH3_64bits_withSeed(data.data(), size, seed)) << size;
}

TEST(ToHex, WritesSixteenLowerCaseDigits) {
  EXPECT_EQ(to_hex(0), "0000000000000000");
  EXPECT_EQ(to_hex(0xfedcba9876543210u), "fedcba9876543210");
}

}  // namespace
}  // namespace verisim::hash_test
