#include "engine/base/contract.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace verisim::contract_test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Contract, NumbersAreJudgedBySignAndSize) {
  EXPECT_TRUE(is_positive(1e-300));
  for (const double x : {0.0, -1.0, kNaN, kInfinity}) EXPECT_FALSE(is_positive(x)) << x;
  EXPECT_TRUE(is_not_negative(0));
  for (const double x : {-1e-300, kNaN, kInfinity}) EXPECT_FALSE(is_not_negative(x)) << x;
  for (const double x : {0.0, 0.5, 1.0}) EXPECT_TRUE(is_fraction(x)) << x;
  for (const double x : {-1e-300, 1 + 0x1p-52, kNaN}) EXPECT_FALSE(is_fraction(x)) << x;
}

// Six digits of a file are a unit vector, five are not.
TEST(Contract, ADirectionFromAFileIsUnit) {
  EXPECT_TRUE(is_unit(Vector3d(0.5773503, 0.5773503, 0.5773503)));
  EXPECT_FALSE(is_unit(Vector3d(0.5774, 0.5774, 0.5774)));
  EXPECT_FALSE(is_unit(Vector3d(kNaN, 0, 1)));
  EXPECT_TRUE(is_placement(Pose()));
  EXPECT_FALSE(is_placement({{kInfinity, 0, 0}, Quaterniond::Identity()}));
  EXPECT_FALSE(is_placement({{0, 0, 0}, Quaterniond(0, 0, 0, 0)}));
}

TEST(Contract, ASymmetricMatrixIsSoToRounding) {
  Matrix3d m = Matrix3d::Identity();
  EXPECT_TRUE(is_symmetric(m));
  EXPECT_TRUE(is_symmetric(Matrix3d(Matrix3d::Zero())));
  m(0, 1) = 0x1p-50;
  EXPECT_TRUE(is_symmetric(m));
  m(0, 1) = 1e-8;
  EXPECT_FALSE(is_symmetric(m));
  m(0, 1) = kNaN;  // another question: see the header
  EXPECT_TRUE(is_symmetric(m));
}

TEST(Contract, WhatAscendsHasNoEqualNeighbours) {
  EXPECT_TRUE(is_ascending(std::vector<int>{}));
  EXPECT_TRUE(is_ascending(std::vector<int>{1, 2, 5}));
  EXPECT_FALSE(is_ascending(std::vector<int>{1, 2, 2}));
  EXPECT_FALSE(is_ascending(std::vector<double>{1, kNaN, 2}));
}

}  // namespace
}  // namespace verisim::contract_test
