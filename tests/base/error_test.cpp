#include "engine/base/error.hpp"

#include <gtest/gtest.h>

namespace verisim::error_test {
namespace {

// The exit codes are promised to users (INTERFACES section 1).
TEST(Error, CarriesTheExitCodeOfItsKind) {
  EXPECT_EQ(Error(ErrorKind::check_failed, "").exit_code(), 1);
  EXPECT_EQ(Error(ErrorKind::usage, "").exit_code(), 2);
  EXPECT_EQ(Error(ErrorKind::input, "").exit_code(), 3);
  EXPECT_EQ(Error(ErrorKind::diverged, "").exit_code(), 4);
  EXPECT_EQ(Error(ErrorKind::io, "").exit_code(), 5);
  EXPECT_EQ(Error(ErrorKind::interrupted, "").exit_code(), 130);
}

TEST(Error, FailThrowsTheFormattedLine) {
  try {
    fail(ErrorKind::input, "{}:{}: mass is {} kg", "pin.lua", 17, 0.5);
    FAIL() << "fail() returned";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::input);
    EXPECT_STREQ(e.what(), "pin.lua:17: mass is 0.5 kg");
  }
}

TEST(AssertDeathTest, ABrokenPromiseNamesItsConditionAndAborts) {
  EXPECT_DEATH(VERISIM_ASSERT(1 + 1 == 3), "broken promise at .*error_test.cpp:[0-9]+: 1 \\+ 1 == 3");
}

TEST(NearestName, FindsTheMisspelledName) {
  const std::vector<std::string> known = {"clearance", "tilt", "voxelsize"};
  EXPECT_EQ(nearest_name("clerance", known), "clearance");   // a letter left out
  EXPECT_EQ(nearest_name("tillt", known), "tilt");           // one too many
  EXPECT_EQ(nearest_name("voxelSize", known), "voxelsize");  // one replaced
  EXPECT_EQ(nearest_name("titl", known), "tilt");            // two swapped
  EXPECT_EQ(nearest_name("tilt", known), "tilt");
}

TEST(NearestName, SuggestsNothingThatIsNotNear) {
  EXPECT_EQ(nearest_name("gravity", {"tilt", "voxelsize"}), "");
  EXPECT_EQ(nearest_name("r", {"h"}), "") << "short names without a common letter are no misspellings of each other";
  EXPECT_EQ(nearest_name("", {"h", "tilt"}), "");
  EXPECT_EQ(nearest_name("tilt", {}), "");
}

TEST(NearestName, TakesTheFirstOfEquallyNearNames) {
  EXPECT_EQ(nearest_name("pan", {"pin", "pen"}), "pin");
}

}  // namespace
}  // namespace verisim::error_test
