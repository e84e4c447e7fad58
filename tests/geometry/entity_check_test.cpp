// Every kind of surface and curve, sound and with one number spoilt.
#include "engine/geometry/entity_check.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

namespace verisim::entity_check_test {
namespace {

const Vector3d kO = Vector3d::Zero(), kX = Vector3d::UnitX(), kZ = Vector3d::UnitZ();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRightAngle = 1.5707963267948966;

/// A kind of entity as a function of its two sizes, of which it may not use all.
struct Sort {
  const char* name;
  std::function<std::optional<std::string>(double first, double second)> fault;
  std::vector<double> first, second;        ///< sound ones
  std::vector<double> no_first, no_second;  ///< finite ones that are none
};

std::optional<std::string> fault(const Surface& surface) {
  return fault_of(surface);
}
std::optional<std::string> fault(const Curve& curve) {
  return fault_of(curve);
}

const std::vector<double> kLengths = {1e-6, 0.5, 1e3}, kNoLengths = {0, -0.0, -1e-9, -2};

const Sort kSorts[] = {
    {"cylinder",
     [](double r, double) {
       return fault(Surface(Cylinder{kO, kZ, kX, r, false}));
     },
     kLengths,
     {},
     kNoLengths,
     {}},
    {"cone",
     [](double r, double a) {
       return fault(Surface(Cone{kO, kZ, kX, r, a, true}));
     },
     {0, -0.0, 0.5},
     {1e-6, 0.7, 1.57},
     {-1e-9, -0.5, -2},
     {0, -0.5, kRightAngle, 2, 4}},
    {"sphere",
     [](double r, double) {
       return fault(Surface(Sphere{kO, kZ, kX, r, false}));
     },
     kLengths,
     {},
     kNoLengths,
     {}},
    {"torus",
     [](double a, double b) {
       return fault(Surface(Torus{kO, kZ, kX, a, b, false}));
     },
     kLengths, kLengths, kNoLengths, kNoLengths},
    {"circle",
     [](double r, double) {
       return fault(Curve(Circle{kO, kZ, kX, r}));
     },
     kLengths,
     {},
     kNoLengths,
     {}},
    {"ellipse",
     [](double a, double b) {
       return fault(Curve(Ellipse{kO, kZ, kX, a, b}));
     },
     kLengths, kLengths, kNoLengths, kNoLengths},
};

TEST(FaultOf, FindsEverySizeThatIsNone) {
  for (const Sort& sort : kSorts) {
    SCOPED_TRACE(sort.name);
    const std::vector<double> any_second = sort.second.empty() ? std::vector<double>{0} : sort.second;
    for (const double a : sort.first)
      for (const double b : any_second) EXPECT_EQ(sort.fault(a, b), std::nullopt) << a << " " << b;
    for (const double a : sort.no_first) {
      const auto found = sort.fault(a, any_second[0]);
      ASSERT_TRUE(found) << a;
      EXPECT_NE(found->find("but it must be"), std::string::npos) << *found;
    }
    for (const double b : sort.no_second) {
      const auto found = sort.fault(sort.first[1], b);
      ASSERT_TRUE(found) << b;
      EXPECT_NE(found->find("but it must be"), std::string::npos) << *found;
    }
    for (const double bad : {kNan, kInfinity, -kInfinity}) {
      EXPECT_NE(sort.fault(bad, any_second[0]).value_or("").find("not finite"), std::string::npos) << bad;
      if (sort.second.empty()) continue;
      EXPECT_NE(sort.fault(sort.first[1], bad).value_or("").find("not finite"), std::string::npos) << bad;
    }
  }
}

/// All kinds, in one place and with the given axes.
std::vector<std::pair<const char*, std::optional<std::string>>> faults_with(const Vector3d& p, const Vector3d& z,
                                                                            const Vector3d& x) {
  return {{"plane", fault(Surface(Plane{p, z, x}))},
          {"cylinder", fault(Surface(Cylinder{p, z, x, 1, false}))},
          {"cone", fault(Surface(Cone{p, z, x, 1, 0.5, false}))},
          {"sphere", fault(Surface(Sphere{p, z, x, 1, false}))},
          {"torus", fault(Surface(Torus{p, z, x, 2, 1, false}))},
          {"circle", fault(Curve(Circle{p, z, x, 1}))},
          {"ellipse", fault(Curve(Ellipse{p, z, x, 2, 1}))}};
}

TEST(FaultOf, FindsPlacesAndDirectionsThatAreNone) {
  for (const auto& [name, found] : faults_with({1, 2, 3}, kZ, kX)) EXPECT_EQ(found, std::nullopt) << name;
  for (const auto& [name, found] : faults_with(kO, kZ, {1, 1e-9, 1e-8})) EXPECT_EQ(found, std::nullopt) << name;
  for (const double bad : {kNan, kInfinity}) {
    for (const auto& [name, found] : faults_with({0, bad, 0}, kZ, kX)) EXPECT_TRUE(found) << name;
    for (const auto& [name, found] : faults_with(kO, {0, 0, bad}, kX)) EXPECT_TRUE(found) << name;
    for (const auto& [name, found] : faults_with(kO, kZ, {bad, 0, 0})) EXPECT_TRUE(found) << name;
  }
  for (const auto& [name, found] : faults_with(kO, 2 * kZ, kX)) EXPECT_TRUE(found) << name;
  for (const auto& [name, found] : faults_with(kO, kO, kX)) EXPECT_TRUE(found) << name;
  for (const auto& [name, found] : faults_with(kO, kZ, 0.5 * kX)) EXPECT_TRUE(found) << name;
  for (const auto& [name, found] : faults_with(kO, kZ, kZ)) EXPECT_TRUE(found) << name;
  EXPECT_EQ(fault(Curve(Line{kO, kZ})), std::nullopt);
  EXPECT_TRUE(fault(Curve(Line{kO, 3 * kZ})));
  EXPECT_TRUE(fault(Curve(Line{kNan * kX, kZ})));
}

TEST(FaultOf, SaysWhatIsWrongAndWhatToGive) {
  EXPECT_EQ(fault(Surface(Cone{kO, kZ, kX, -0.01, 0.5, false})), "has a radius of -0.01 m but it must be 0 or more");
  EXPECT_EQ(fault(Surface(Plane{kO, 2 * kZ, kX})), "has a normal of length 2 but it must be of length 1");
  EXPECT_EQ(fault(Surface(Sphere{kO, kZ, kX, kNan, false})), "has a radius that is not finite; give a number");
}

// They promise nothing, so nothing is broken; a torus may meet itself, as those of the CAD kernel do.
TEST(FaultOf, LeavesOtherKindsAndSpindlesInPeace) {
  EXPECT_EQ(fault(Surface(OtherSurface{})), std::nullopt);
  EXPECT_EQ(fault(Curve(OtherCurve{})), std::nullopt);
  EXPECT_EQ(fault(Surface(Torus{kO, kZ, kX, 1, 3, false})), std::nullopt);
}

}  // namespace
}  // namespace verisim::entity_check_test
