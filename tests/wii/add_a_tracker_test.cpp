// "To add a tracker" (engine/wii/README.md), followed here: a tracker that needs two remotes and three LEDs.
#include <gtest/gtest.h>

#include <vector>

#include "engine/wii/tracker_base.hpp"
#include "tests/support/refusal.hpp"
#include "tests/wii/validation_runs.hpp"

namespace verisim::wii::add_a_tracker_test {
namespace {

using test::expect_refused;

// Step 1: one class (in the engine: a file of its own). It takes the head to be a metre away in the direction of the
// blobs' middle, as long as the second remote has seen three of them too.
class OneMetre final : public TrackerBase {
 public:
  using TrackerBase::TrackerBase;
  [[nodiscard]] std::string_view name() const override { return "one-metre"; }

 private:
  void estimate(double /*t*/, double /*dt*/, const Reading& reading, int remote, Estimate& result) override {
    const bool all_seen = reading.blob_count == 3;
    if (remote == 1) second_sees_ = all_seen;
    if (remote == 1 || !all_seen || !second_sees_) return;
    Vector3d rays = Vector3d::Zero();
    for (const Blob& blob : std::span(reading.blobs).first(3)) rays += pinhole().ray(blob.u, blob.v);
    result.pose.position = gravity(0).C_LR() * rays.normalized();
    result.covariance = Matrix6d::Identity();
    result.known = result.usable = true;
  }
  void admitted(double /*t*/, bool /*valid*/) override {}
  void restart() override { second_sees_ = false; }

  bool second_sees_ = false;
};

// Step 2: its row, here in a table of its own.
std::vector<TrackerEntry> extended() {
  std::vector<TrackerEntry> table(trackers().begin(), trackers().end());
  table.push_back({.name = "one-metre",
                   .make = [](const TrackerSettings& settings) -> std::unique_ptr<Tracker> {
                     return std::make_unique<OneMetre>(settings);
                   },
                   .remotes = 2,
                   .leds_min = 3,
                   .leds = LedLayout::triangle()});
  return table;
}

// Step 3: its test. A head that rests 1.2 m away is found 0.2 m too near: the second remote and the third LED are
// there.
TEST(AddingATracker, IsJudgedOverTheRemotesAndLedsThatItNeeds) {
  const std::vector<TrackerEntry> table = extended();
  ValidationOptions options;
  options.known = table;
  options.trackers = {"one-metre"};
  options.trajectories = {"static"};
  options.sensors = {"ideal"};
  options.measure_time = false;
  const std::vector<ValidationRow> rows = validate(options);
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_GT(rows[0].availability, 0.99);
  EXPECT_NEAR(rows[0].position.rms, 0.04 / 3, 0.002);
}

TEST(AddingATracker, IsRefusedWithoutTheRemotesAndLedsThatItNeeds) {
  const std::vector<TrackerEntry> table = extended();
  TrackerSettings settings;
  settings.leds = LedLayout::triangle();
  expect_refused(
      [&] { return make_tracker("one-metre", settings, table); },
      "tracker one-metre: one remote is described but it needs two; say where a second one stands, or choose "
      "one of geometric, vrpn-compatible, three-led, scaat");
  settings.leds = {};
  settings.X_R1R2 = Pose();
  expect_refused([&] { return make_tracker("one-metre", settings, table); },
                 "tracker one-metre: 2 LEDs are described but it needs three; add to '# leds:', or choose one of "
                 "geometric, vrpn-compatible, scaat, stereo");
}

TEST(AddingATracker, IsNotKnownWithoutItsRow) {
  expect_refused([] { return make_tracker("one-metre", {}); }, "tracker 'one-metre' is not known");
  EXPECT_EQ(tracker_names(extended()).size(), tracker_names().size() + 1);
}

}  // namespace
}  // namespace verisim::wii::add_a_tracker_test
