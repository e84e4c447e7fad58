// Quadrature edges against the line that they divide.
#include "engine/robot/encoder.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "engine/base/pinned_math.hpp"

namespace verisim::robot::encoder_test {
namespace {

constexpr double kCount = pinned::kFullTurn / kCountsPerTurn;  // rad

/// What a decoder makes of levels: +1 forward, -1 backward, of one signal at a time.
int decoded(int before, int after) {
  constexpr int kForward[] = {0b01, 0b11, 0b00, 0b10};  // what follows 00, 01, 10, 11
  return kForward[before] == after ? 1 : kForward[after] == before ? -1 : 0;
}

TEST(Encoder, GivesFortyEightCountsATurnAndBack) {
  Encoder encoder(2);
  Edges edges;
  encoder.turn(pinned::kFullTurn, 0, 16000, edges);
  EXPECT_EQ(encoder.counts(), 48);
  ASSERT_EQ(edges.all().size(), 48u);
  encoder.turn(-pinned::kFullTurn, 0, 16000, edges);
  EXPECT_EQ(encoder.counts(), 0);
}

// It begins half a count before an edge: edges lie at 0.5, 1.5, 2.5 ... counts.
TEST(Encoder, SetsEdgesAtTheirCycles) {
  Encoder encoder(1);
  Edges edges;
  encoder.turn(4 * kCount, 1000, 4000, edges);
  ASSERT_EQ(edges.all().size(), 4u);
  const std::uint8_t levels[] = {0b01, 0b11, 0b10, 0b00};  // A leads B
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(edges.all()[i].cycle, 1500.0 + 1000.0 * static_cast<double>(i), 1);  // whole cycles, rounded down
    EXPECT_EQ(edges.all()[i].levels, levels[i]);
    EXPECT_EQ(edges.all()[i].wheel, 1);
  }
}

TEST(Encoder, DoesNotCountATrembleWithinACount) {
  Encoder encoder(0);
  Edges edges;
  for (int i = 0; i < 1000; ++i) encoder.turn(i % 2 == 0 ? 0.4 * kCount : -0.4 * kCount, 0, 2000, edges);
  EXPECT_TRUE(edges.all().empty());
}

TEST(Encoder, LosesNothingInAMillionSmallTurns) {
  Encoder encoder(0);
  Edges edges;
  for (int i = 0; i < 1000000; ++i) {
    encoder.turn(0.125 * kCount, 0, 2000, edges);
    edges.clear();
  }
  EXPECT_EQ(encoder.counts(), 125000);
}

TEST(Encoder, ReversedCountsBackwardsAndDeadNotAtAll) {
  for (const EncoderFault fault : {EncoderFault::none, EncoderFault::reversed, EncoderFault::dead}) {
    Encoder encoder(0);
    encoder.set_fault(fault);
    Edges edges;
    int levels = encoder.levels(), count = 0;
    encoder.turn(7 * kCount, 0, 2000, edges);
    for (const Edge& edge : edges.all()) {
      count += decoded(levels, edge.levels);
      levels = edge.levels;
    }
    EXPECT_EQ(count, encoder.counts());
    EXPECT_EQ(count, fault == EncoderFault::none ? 7 : fault == EncoderFault::dead ? 0 : -7);
  }
}

TEST(Edges, AreSortedByCycleAndCountedWhenTheyDoNotFit) {
  Edges edges;
  for (std::uint32_t i = 0; i < 300; ++i) edges.add({(i * 7919) % 16000, 0, 0});
  EXPECT_EQ(edges.all().size(), 256u);
  EXPECT_EQ(edges.dropped(), 44u);
  for (std::size_t i = 1; i < edges.all().size(); ++i) EXPECT_LE(edges.all()[i - 1].cycle, edges.all()[i].cycle);
}

}  // namespace
}  // namespace verisim::robot::encoder_test
