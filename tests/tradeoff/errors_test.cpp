// Errors of settings: means over windows, kinds of error, the observed order of convergence.
#include "engine/tradeoff/errors.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace verisim::errors_test {
namespace {

using namespace tradeoff;

Vector6d wrench_of(double force, double torque = 0) {
  Vector6d wrench = Vector6d::Zero();
  wrench[0] = force;
  wrench[4] = torque;
  return wrench;
}

Motion motion_of(std::vector<Vector6d> wrench, const Pose& end = {}) {
  Motion motion;
  motion.bodies.push_back({"pin", std::move(wrench), end});
  return motion;
}

double error(const Errors& errors, Kind kind) {
  return errors[index_of(kind)].value();
}

// 10 ms hold ten steps of 1 ms: the mean of 0 to 9 N is 4.5 N. Ten roundings of at most 10 N.
TEST(WindowMeans, AreOfWholeSteps) {
  WindowMeans means;
  for (int i = 0; i < 20; ++i) means.add(0.001 * i, 0.001 * (i + 1), wrench_of(i));
  ASSERT_EQ(means.means().size(), 2u);
  EXPECT_NEAR(means.means()[0][0], 4.5, 1e-13);
  EXPECT_NEAR(means.means()[1][0], 14.5, 1e-13);
}

// An impulse is the same whatever the step: 0.004 N s.
TEST(WindowMeans, HaveTheImpulseOfAnyStep) {
  for (const double dt : {0.001, 0.0001, 0.0003, 0.004, 0.025}) {
    WindowMeans means;
    for (int i = 0; i < 40; ++i) means.add(dt * i, dt * (i + 1), wrench_of(i == 1 ? 0.004 / dt : 0));
    double sum = 0;
    for (const Vector6d& mean : means.means()) sum += mean[0] * kWindow;
    EXPECT_NEAR(sum, 0.004, 1e-15) << dt;
  }
}

// A step from 8 to 13 ms counts for 2 ms in the first window and for 3 ms in the second.
TEST(WindowMeans, DivideAStepAmongItsWindows) {
  WindowMeans means;
  means.add(0.008, 0.013, wrench_of(10));
  ASSERT_EQ(means.means().size(), 2u);
  EXPECT_NEAR(means.means()[0][0], 2, 1e-13);
  EXPECT_NEAR(means.means()[1][0], 3, 1e-13);
}

// Worked: true forces 3 and 4 N, found 3 and 1 N: rms of (0, 3) is 3/sqrt 2, of the truth 5/sqrt 2, their ratio 0.6.
TEST(Errors, AreTheWorkedNumbers) {
  Pose turned{{0.003, 0.004, 0}, rotation_from_vector({0, 0, 0.1})};
  Motion found = motion_of({wrench_of(3, 0.5), wrench_of(1)}, turned);
  found.overlap = 0.002;
  found.work = 0.001;
  const Errors errors = errors_of(motion_of({wrench_of(3), wrench_of(4)}), found, true);
  EXPECT_DOUBLE_EQ(error(errors, Kind::wrench), 0.6);
  EXPECT_DOUBLE_EQ(error(errors, Kind::force), 3 / std::sqrt(2.0));
  EXPECT_DOUBLE_EQ(error(errors, Kind::force_max), 3);
  EXPECT_DOUBLE_EQ(error(errors, Kind::torque), 0.5 / std::sqrt(2.0));
  EXPECT_DOUBLE_EQ(error(errors, Kind::torque_max), 0.5);
  EXPECT_DOUBLE_EQ(error(errors, Kind::position), 0.005);
  EXPECT_NEAR(error(errors, Kind::rotation), 0.1, 1e-15);
  EXPECT_EQ(error(errors, Kind::overlap), 0.002);
  EXPECT_EQ(error(errors, Kind::work), 0.001);
  EXPECT_EQ(error(errors, Kind::flips), 1);
}

TEST(Errors, OfTheTruthAgainstItselfAreNone) {
  const Motion truth = motion_of({wrench_of(3), wrench_of(4)}, {{1, 2, 3}, rotation_from_vector({0.1, 0.2, 0.3})});
  const Errors errors = errors_of(truth, truth, false);
  for (std::size_t i = 0; i < kKinds.size(); ++i) EXPECT_NEAR(errors[i].value(), 0, 1e-15) << kKinds[i].name;
}

// There is nothing to divide by: no figure, and not 0 or infinity.
TEST(Errors, AreNotRelativeToNoForce) {
  const Errors errors = errors_of(motion_of({wrench_of(0)}), motion_of({wrench_of(2)}), false);
  EXPECT_FALSE(errors[index_of(Kind::wrench)]);
  EXPECT_EQ(error(errors, Kind::force), 2);
}

// A window that one of them lacks is a window without force, not one that is left out.
TEST(Errors, CountWindowsThatOneLacks) {
  const Errors errors = errors_of(motion_of({wrench_of(3)}), motion_of({wrench_of(3), wrench_of(4)}), false);
  EXPECT_EQ(error(errors, Kind::force_max), 4);
}

// a(h) = a + c h^p at h, h/2, h/4: differences shrink by 2^p, and Richardson's estimate is exactly c (h/4)^p.
TEST(Convergence, FindsTheOrderAndTheErrorOfAKnownSeries) {
  for (const double p : {1.0, 2.0, 3.0}) {
    const auto value = [p](double h) { return 7 + 3 * std::pow(h, p); };
    const double coarse = std::abs(value(1) - value(0.5)), fine = std::abs(value(0.5) - value(0.25));
    const Convergence c = convergence_of(coarse, fine, 2);
    EXPECT_TRUE(c.converges);
    EXPECT_NEAR(c.order, p, 1e-12);
    EXPECT_NEAR(c.error, 3 * std::pow(0.25, p), 1e-12);
  }
}

TEST(Convergence, IsNotClaimedWhereDifferencesDoNotShrink) {
  EXPECT_FALSE(convergence_of(1, 1, 2).converges);
  EXPECT_FALSE(convergence_of(1, 3, 2).converges);
  EXPECT_FALSE(convergence_of(0, 3, 2).converges);
  EXPECT_TRUE(convergence_of(0, 0, 2).converges);
  EXPECT_EQ(convergence_of(1, 0, 2).error, 0);
}

}  // namespace
}  // namespace verisim::errors_test
