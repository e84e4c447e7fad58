// When a collision starts: drawn series of counts, whose true starts are known because they were drawn first.
#include "engine/device/collision_start.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/random_inputs.hpp"

namespace verisim::collision_start_test {
namespace {

using test::seeds;

TEST(ShortTermMaximum, KeepsACountForItsWindowAndHardlyLonger) {
  for (const double dt : {1e-5, 1e-4, 1e-3, 7e-3, 0.05, 0.3}) {
    ShortTermMaximum maximum(0.1);
    const double last = 20 * dt;
    for (int i = 0; i <= 20; ++i) maximum.add(i * dt, 3);
    for (int i = 21; i * dt < last + 1; ++i) {
      maximum.add(i * dt, 0);
      const double since = i * dt - last;
      if (since < 0.1) {
        EXPECT_EQ(maximum.value(), 3u) << dt << " " << since;
      }
      if (since > 0.1 * 34 / 32 + dt) {
        EXPECT_EQ(maximum.value(), 0u) << dt << " " << since;
      }
    }
  }
}

// Bodies meet for a while, apart from each other for 0.2 s and more. While they touch the count goes up and down, and
// to 0 for as long as 80 ms, as penalty contact does.
TEST(CollisionStart, IsFoundOnceForEveryMeeting) {
  for (const std::uint64_t seed : seeds(300)) {
    SCOPED_TRACE(seed);
    test::Inputs inputs(seed);
    const double dt = inputs.between(2e-4, 4e-3);
    CollisionStart detector;
    int wanted = 0, found = 0;
    double t = 0;
    const auto run = [&](double duration, auto count) {
      for (const double end = t + duration; t < end; t += dt) found += detector.update(t, count()) ? 1 : 0;
    };
    for (int meeting = 0; meeting < 5; ++meeting) {
      run(inputs.between(0.2, 0.6), [] { return 0u; });
      EXPECT_EQ(found, wanted);
      ++wanted;
      const auto typical = static_cast<std::uint32_t>(inputs.between(1, 1000));
      run(dt, [&] { return typical; });
      for (int part = 0; part < 6; ++part) {
        run(inputs.between(0, 0.08), [] { return 0u; });
        run(inputs.between(0.01, 0.05), [&] { return static_cast<std::uint32_t>(typical * inputs.between(1, 2)); });
      }
      EXPECT_EQ(found, wanted);
    }
  }
}

// A body that lies on one thing and runs into another: the count grows to more than twice of what it was.
TEST(CollisionStart, IsFoundInWhatTouchesAlready) {
  CollisionStart detector;
  std::vector<int> starts;
  for (int i = 0; i < 1000; ++i)
    if (detector.update(1e-3 * i, i < 100 ? 0 : i < 500 ? 40 : 100)) starts.push_back(i);
  EXPECT_EQ(starts, (std::vector<int>{100, 500}));
}

}  // namespace
}  // namespace verisim::collision_start_test
