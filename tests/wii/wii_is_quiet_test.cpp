// No tracker allocates in update or heartbeat (tracker.hpp).
#include <gtest/gtest.h>

#include <cstdlib>
#include <new>

#include "engine/wii/trajectories.hpp"

namespace {
std::size_t allocations = 0;
}  // namespace

void* operator new(std::size_t size) {
  ++allocations;
  if (void* p = std::malloc(size)) return p;
  throw std::bad_alloc();
}
void operator delete(void* p) noexcept {
  std::free(p);
}
void operator delete(void* p, std::size_t) noexcept {
  std::free(p);
}

namespace verisim::wii::wii_is_quiet_test {
namespace {

TEST(Trackers, AllocateNothingPerUpdate) {
  const Trajectory& path = trajectory("dropout-both");
  for (const TrackerEntry& entry : trackers()) {
    TrackerSettings settings;
    settings.leds = entry.leds;
    if (entry.remotes == 2) settings.X_R1R2 = Pose();
    RemoteSettings remote_settings;
    if (entry.leds.count > 2) remote_settings.leds.push_back(Led{settings.leds.p_H[2]});
    remote_settings.outages = path.outages;
    VirtualRemote remote(remote_settings, 1, "r");
    const std::unique_ptr<Tracker> tracker = make_tracker(entry.name, settings);
    int valid = 0;
    for (std::uint64_t k = 0; k < 400; ++k) {
      const SensedReport sensed = remote.sense(k, path.at(remote.report_time(k)));
      const std::size_t before = allocations;
      (void)tracker->update(sensed.t, sensed.channels, 1);
      valid += tracker->update(sensed.t, sensed.channels, 0).valid ? 1 : 0;
      (void)tracker->heartbeat(sensed.t + 0.005);
      ASSERT_EQ(allocations, before) << entry.name << ", report " << k;
    }
    EXPECT_GT(valid, 200) << entry.name << " hardly worked: this test would prove little";
  }
}

}  // namespace
}  // namespace verisim::wii::wii_is_quiet_test
