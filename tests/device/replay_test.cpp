#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "engine/device/sources.hpp"
#include "tests/support/random_inputs.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::replay_test {
namespace {

using test::expect_refused;
using test::tolerance;

/// Three samples at 0, 0.1 and 0.3 s; pressed at the second only.
HapticSamples three() {
  HapticSamples s;
  s.t = {0, 0.1, 0.3};
  s.pose = {{{0, 0, 0}, Quaterniond::Identity()},
            {{1, 2, 3}, rotation_from_vector({0, 0, 1})},
            {{1, 2, 7}, rotation_from_vector({0, 0, -1})}};
  s.button = {0, 1, 0};
  return s;
}

DeviceReading at(Device& device, double t) {
  device.sample({0, t, 1e-3});
  return device.reading();
}

TEST(Replay, GivesEverySampleExactlyAtItsInstant) {
  const HapticSamples s = three();
  const auto replay = make_replay("omni", s);
  for (std::size_t i = 0; i < s.t.size(); ++i) {
    const DeviceReading r = at(*replay, s.t[i]);
    EXPECT_EQ(r.handle.position, s.pose[i].position);
    EXPECT_EQ(r.handle.rotation.coeffs(), s.pose[i].rotation.coeffs());
    EXPECT_EQ(r.raw.position, r.handle.position);
    EXPECT_EQ(r.button, s.button[i] != 0);
  }
}

// A trace of 1 kHz with its times as decimal text, simulated at 1 kHz: frame * 0.001 differs from the number read in
// the last bit for many frames, and still each frame is its sample, button included.
TEST(Replay, OfATraceAtTheSimulationsRateIsTheTrace) {
  HapticSamples s;
  int differ = 0;
  for (int i = 0; i < 5000; ++i) {
    s.t.push_back(std::stod(std::to_string(i / 1000) + "." + std::to_string(1000 + i % 1000).substr(1)));
    s.pose.push_back(test::Inputs(static_cast<std::uint64_t>(i)).pose(1));
    s.button.push_back(static_cast<std::uint8_t>(i % 2));
    if (i * 0.001 != s.t.back()) ++differ;
  }
  ASSERT_GT(differ, 0) << "all times agree: this test would prove nothing";
  const auto replay = make_replay("omni", s);
  for (std::size_t i = 0; i < s.t.size(); ++i) {
    const DeviceReading r = at(*replay, static_cast<double>(i) * 0.001);
    ASSERT_EQ(r.handle.position, s.pose[i].position) << i;
    ASSERT_EQ(r.handle.rotation.coeffs(), s.pose[i].rotation.coeffs()) << i;
    ASSERT_EQ(r.button, s.button[i] != 0) << i;
  }
}

// Position linear, rotation at constant rate (from 1 to -1 rad about z: through 0 halfway), button held.
TEST(Replay, InterpolatesByTheStatedRules) {
  const auto replay = make_replay("omni", three());
  const DeviceReading first = at(*replay, 0.025);
  EXPECT_LE((first.handle.position - Vector3d(0.25, 0.5, 0.75)).norm(), tolerance(4 * 0x1p-52));
  EXPECT_LE((vector_from_rotation(first.handle.rotation) - Vector3d(0, 0, 0.25)).norm(), tolerance(8 * 0x1p-53));
  EXPECT_FALSE(first.button);
  const DeviceReading second = at(*replay, 0.2);
  EXPECT_LE((second.handle.position - Vector3d(1, 2, 5)).norm(), tolerance(8 * 0x1p-51));
  EXPECT_LE(vector_from_rotation(second.handle.rotation).norm(), tolerance(8 * 0x1p-52));
  EXPECT_TRUE(second.button);
}

TEST(Replay, HoldsTheNearestSampleOutsideTheTrace) {
  HapticSamples s = three();
  for (double& t : s.t) t += 1;
  const auto replay = make_replay("omni", s);
  EXPECT_EQ(replay->reading().handle.position, s.pose[0].position) << "before the first frame";
  EXPECT_EQ(at(*replay, 0.5).handle.position, s.pose[0].position);
  EXPECT_FALSE(at(*replay, 0.5).button);
  EXPECT_EQ(at(*replay, 99).handle.position, s.pose[2].position);
  EXPECT_FALSE(at(*replay, 99).button);
}

TEST(Replay, WithoutAButtonHoldsThroughout) {
  HapticSamples s = three();
  s.button.clear();
  const auto replay = make_replay("omni", s);
  for (const double t : {0.0, 0.05, 0.2, 5.0}) EXPECT_TRUE(at(*replay, t).button);
}

TEST(Replay, KnowsItsLengthItsReachAndWhatItWasToldToRender) {
  const auto replay = make_replay("omni", three());
  EXPECT_EQ(replay->name(), "omni");
  EXPECT_EQ(replay->duration(), 0.3);
  EXPECT_LE(std::abs(replay->travel() - std::sqrt(1 + 4 + 49)), tolerance(4 * 0x1p-51));
  EXPECT_TRUE(replay->driven());
  replay->render({{1, 2, 3}, {4, 5, 6}}, {0, 0, 1e-3});
  EXPECT_EQ(replay->rendered().torque, Vector3d(4, 5, 6));
}

TEST(Replay, RefusesATraceThatIsNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect_refused([] { return make_replay("omni", {}); }, "'omni': its trace has no samples");
  const auto with = [](auto change) {
    return [change] {
      HapticSamples s = three();
      change(s);
      return make_replay("omni", s);
    };
  };
  expect_refused(with([](auto& s) { s.t[1] = 0; }), "do not grow at sample 1");
  expect_refused(with([](auto& s) { s.t[2] = 0.05; }), "do not grow at sample 2");
  expect_refused(with([=](auto& s) { s.t[0] = nan; }), "at sample 0");
  expect_refused(with([=](auto& s) { s.t[2] = std::numeric_limits<double>::infinity(); }), "at sample 2");
  expect_refused(with([=](auto& s) { s.pose[1].position.y() = nan; }), "sample 1");
  expect_refused(with([=](auto& s) { s.pose[1].rotation.w() = nan; }), "sample 1");
  expect_refused(with([](auto& s) { s.pose[2].rotation.coeffs().setZero(); }), "sample 2");
}

TEST(ReplayDeathTest, NeedsAPoseAndAButtonForEverySample) {
  HapticSamples s = three();
  s.pose.pop_back();
  EXPECT_DEATH((void)make_replay("omni", s), "broken promise");
  s = three();
  s.button.pop_back();
  EXPECT_DEATH((void)make_replay("omni", s), "broken promise");
}

std::vector<std::string> said_by(Device& device, std::uint64_t frames) {
  std::vector<std::string> said;
  for (std::uint64_t frame = 0; frame < frames; ++frame) {
    device.sample({frame, 1e-3 * static_cast<double>(frame), 1e-3});
    device.render({}, {frame, 1e-3 * static_cast<double>(frame), 1e-3});
    DeviceNotes notes;
    device.report(notes);
    for (const auto& note : notes) said.push_back(fmt::format("{} {}", frame, note.kind));
  }
  return said;
}

// 10 m, or half a turn, between two samples 1 ms apart; the same way in 2 s is no jump.
TEST(Replay, SaysThatItsTraceJumpsAndThatItEnds) {
  const Pose far{{10, 0, 0}, Quaterniond::Identity()}, turned{Vector3d::Zero(), rotation_from_vector({0, 0, 3.14})};
  for (const Pose& pose : {far, turned}) {
    const auto jumps = make_replay("trace", {{0, 0.010, 0.011, 0.02}, {{}, {}, pose, pose}, {}});
    EXPECT_EQ(said_by(*jumps, 30), (std::vector<std::string>{"11 speed", "21 trace"}));
    const auto goes = make_replay("trace", {{0, 2}, {{}, pose}, {}});
    EXPECT_EQ(said_by(*goes, 2000), std::vector<std::string>{});
  }
}

TEST(Replay, SaysThatItsButtonIsStuck) {
  const auto with = [](std::vector<std::uint8_t> button) {
    return make_replay("trace", {{0, 1, 2}, {{}, {}, {}}, std::move(button)});
  };
  for (const std::uint8_t down : {0, 1})
    EXPECT_EQ(said_by(*with({down, down, down}), 1000), std::vector<std::string>{"0 button"});
  EXPECT_EQ(said_by(*with({0, 0, 1}), 1000), std::vector<std::string>{});
  EXPECT_EQ(said_by(*with({}), 1000), std::vector<std::string>{}) << "no button was recorded: it holds throughout";
}

}  // namespace
}  // namespace verisim::replay_test
