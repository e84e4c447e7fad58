#include "engine/base/named_array.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace verisim::named_array_test {
namespace {

template <typename T>
class NamedArrayOf : public testing::Test {};
using AllTypes =
    testing::Types<double, float, std::uint64_t, std::uint32_t, std::uint16_t, std::uint8_t, std::int32_t, std::int8_t>;
TYPED_TEST_SUITE(NamedArrayOf, AllTypes);

TYPED_TEST(NamedArrayOf, GivesBackWhatItWasMadeFrom) {
  const std::vector<TypeParam> values = {
      std::numeric_limits<TypeParam>::lowest(), TypeParam{0}, TypeParam{1}, TypeParam{2}, TypeParam{3},
      std::numeric_limits<TypeParam>::max()};
  const auto array = NamedArray::from<TypeParam>("corners", values, {2, 3}, "m", "Two rows of three.");
  EXPECT_EQ(array.template as<TypeParam>(), values);
  EXPECT_EQ(array.count(), 6u);
  EXPECT_EQ(size_of(array.dtype), sizeof(TypeParam));
  EXPECT_EQ(array.name, "corners");
  EXPECT_EQ(array.units, "m");
}

TEST(NamedArray, HoldsNothingAndOneNumberToo) {
  EXPECT_TRUE(NamedArray::from<double>("none", {}, {0, 3}, "m", "").as<double>().empty());
  const double one = 7.5;
  EXPECT_EQ(NamedArray::from<double>("scalar", {&one, 1}, {}, "m", "").as<double>(), std::vector<double>{7.5});
}

TEST(NamedArray, RefusesToBeReadAsAnotherType) {
  const std::vector<float> values = {1, 2};
  const auto array = NamedArray::from<float>("speeds", values, {2}, "m/s", "");
  EXPECT_THROW((void)array.as<double>(), Error);
  EXPECT_THROW((void)array.as<std::uint32_t>(), Error);
}

// As a damaged run file would give it.
TEST(NamedArray, RefusesBytesThatDoNotFillItsShape) {
  const std::vector<double> values = {1, 2, 3};
  auto array = NamedArray::from<double>("times", values, {3}, "s", "");
  array.bytes.pop_back();
  EXPECT_THROW((void)array.as<double>(), Error);
  array.bytes.resize(16);
  EXPECT_THROW((void)array.as<double>(), Error);
}

TEST(NamedArrayDeathTest, IsNotMadeWithAShapeOfAnotherSize) {
  const std::vector<double> values = {1, 2, 3};
  EXPECT_DEATH((void)NamedArray::from<double>("times", values, {2, 2}, "s", ""), "broken promise");
}

}  // namespace
}  // namespace verisim::named_array_test
