// The host's side of the robot allocates nothing after construction, whatever goes wrong.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/robot/pilot.hpp"
#include "tests/contact/allocations.hpp"

namespace verisim::robot::robot_host_is_quiet_test {
namespace {

TEST(RobotHost, AllocatesNothingPerMillisecond) {
  PilotSettings settings;
  settings.walls.emplace().corners = rectangle(-1, 1, -1, 1);
  settings.drive.heading.clearance = 1;
  BaseTrackerSettings tracking;
  tracking.dropout_rate = 2;
  Pilot pilot(settings);
  BaseTracker tracker(tracking, 1, "art");
  SerialLine up({.loss = 0.05, .corruption = 0.01}, 1, "up"), down({.receiver_baud = 57'600}, 1, "down");
  RobotNotes notes;
  std::size_t received = 0, said = 0;
  const std::uint64_t before = allocations;
  pilot.start();
  for (int ms = 0; ms < 10'000; ++ms) {
    if (ms == 3000) pilot.kill();
    if (ms == 3500) pilot.start();
    const double x = ms % 1000 == 0 ? std::nan("") : 0.002 * (ms % 1700) - 1;
    const TrackedBase& tracked = tracker.advance({0.0001 * ms, 0, 0.001 * ms});
    up.send(pilot.advance({x, 0.2}, std::array{-1.0, 0.3}, tracked));
    const auto arrived = up.advance();
    received += arrived.size();
    down.send(arrived);  // an echo is what a robot may send, too
    pilot.receive(down.advance());
    pilot.report(notes);
    up.report(notes);
    said += notes.size();
    notes.clear();
  }
  EXPECT_EQ(allocations, before);
  EXPECT_GT(received, 1000U) << "this test would prove little";
  EXPECT_GT(said, 5U);
}

}  // namespace
}  // namespace verisim::robot::robot_host_is_quiet_test
