// The overlap that one frame leaves of what a straight step beside a curve would leave, in closed form.
#include <gtest/gtest.h>

#include "engine/exact/convex_step.hpp"
#include "tests/exact/scenes.hpp"

namespace verisim::exact::test::curved_step_test {
namespace {

using Kind = Solid::Kind;

constexpr double kStep = 0.001;      // s
constexpr double kRounding = 3e-10;  // m, of entities and closest places

struct Sizes {
  double bore, ball;  ///< m, radii
  [[nodiscard]] double room() const { return bore - ball; }
};
constexpr Sizes kSizes[] = {{0.03, 0.01}, {0.02, 0.019}, {0.06, 0.005}};

/// Does the ball pass so much of its room in a step [m] that further rows hold it?
bool is_close(const Sizes& sizes, double slide) {
  return slide > SearchThresholds().conforms * sizes.room();
}

/// What may be left of the overlap of a straight step: all of it where the place moves by less than
/// SearchThresholds::slow [m], else a hundredth.
double left_of(double straight) {
  const double slow = SearchThresholds().slow;
  return std::max(0.01 * straight, std::min(straight, slow * slow / 0.002)) + kRounding;
}

Pair ball_in_tube(const Sizes& sizes) {
  return {make(Kind::tube, {sizes.bore + 0.01, sizes.bore, 0.02}), make(Kind::sphere, {sizes.ball})};
}

// A ball runs around in a tube. A step that went on straight along the wall, by v dt beside a circle of radius R - r,
// would end sqrt((R - r)^2 + (v dt)^2) - (R - r) deep. The step knows of the curve: next to nothing of that is left,
// and the ball does not leave the wall either.
TEST(CurvedStep, OfABallAroundATubeStaysOnTheWall) {
  for (const Sizes& sizes : kSizes) {
    Pair pair = ball_in_tube(sizes);
    for (const double speed : {0.005, 0.1, 0.3, 1.0}) {
      SCOPED_TRACE(::testing::Message() << sizes.bore << " " << sizes.ball << " " << speed);
      ConvexStep solver(64);
      const Vector3d o = Vector3d::Zero();
      Vector3d p(sizes.room(), 0, 0);
      Vector6d u = Vector6d::Zero();
      u.y() = speed;
      for (int i = 0; i < 200; ++i) {
        pair.link.find({}, {{p, Quaterniond::Identity()}, p, {u.head<3>(), o}, {u.head<3>(), o}}, kStep, 3e-3);
        solver.clear();
        const int ball = solver.add_body(p, 0.1 * Matrix6d::Identity(), u, u);
        solver.add_rows(pair.link.rows().rows(), kFixed, ball);
        solver.solve(kStep);
        u = solver.velocity(ball);
        p += kStep * u.head<3>();
        const double straight = std::hypot(sizes.room(), kStep * speed) - sizes.room();
        const double off = p.norm() - sizes.room();
        EXPECT_LE(off, (is_close(sizes, 1.01 * kStep * speed) ? 5 : 1) * left_of(straight)) << "frame " << i;
        if (is_close(sizes, kStep * speed)) continue;
        EXPECT_GE(off, -left_of(straight)) << "frame " << i;
      }
      if (is_close(sizes, kStep * speed)) continue;
      EXPECT_NEAR(u.head<3>().norm(), speed, 2e-3 * speed);
    }
  }
}

// A tube turns about an axis a beside its own, and a ball that does not move touches its wall. The wall's place moves
// on a circle of radius a + R - r and the wall is curved: with phi = omega dt a straight step would end
// sqrt((a + R - r)^2 + a^2 - 2 a (a + R - r) cos phi) - (R - r) deep.
TEST(CurvedStep, OfATurningTubeStaysOnTheWall) {
  for (const Sizes& sizes : kSizes) {
    Pair pair = ball_in_tube(sizes);
    for (const double arm : {0.01, 0.1}) {
      for (const double omega : {0.1, 1.0, 5.0}) {
        SCOPED_TRACE(::testing::Message() << sizes.bore << " " << sizes.ball << " " << arm << " " << omega);
        const Pose X_W2{{sizes.room(), 0, 0}, Quaterniond::Identity()};
        const Vector3d center(-arm, 0, 0);
        const Twist turning{Vector3d::Zero(), {0, 0, omega}};
        Vector6d u = Vector6d::Zero();
        u[5] = omega;
        pair.link.find({Pose(), center, turning, turning}, {X_W2, X_W2.position, {}}, kStep, 1e-3);
        ASSERT_NEAR(pair.link.depth_max(), 0, kRounding);
        ConvexStep solver(64);
        const int tube = solver.add_body(center, Matrix6d::Identity(), u, u);
        solver.add_rows(pair.link.rows().rows(), tube, kFixed);
        solver.solve(kStep);
        if (is_close(sizes, kStep * omega * (arm + sizes.room()))) continue;
        const Vector6d& after = solver.velocity(tube);
        ASSERT_GT(after[5], 0.5 * omega) << "the wall gives way, and hardly brakes";
        const Quaterniond turned = rotation_from_vector(kStep * after.tail<3>());
        const Pose X_W1{center + kStep * after.head<3>() + turned * -center, turned};
        pair.link.find({X_W1, center, turning, turning}, {X_W2, X_W2.position, {}}, kStep, 1e-3);
        const double far = arm + sizes.room();
        const double straight =
            std::sqrt(far * far + arm * arm - 2 * arm * far * std::cos(kStep * omega)) - sizes.room();
        EXPECT_LE(pair.link.depth_max(), left_of(straight));
      }
    }
  }
}

// A box beside a plane turns about its centre of mass, which is not its origin, and flies on. Each corner's row says
// where that corner is after the step: on the straight line of its velocity, or below where it turns towards the plane.
TEST(CurvedStep, OfABoxThatTurnsAndFliesEndsWhereItsRowsSay) {
  Pair pair(make(Kind::box, {0.3, 0.3, 0.02}), make(Kind::box, {0.03, 0.02, 0.01}));
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    Draw draw(seed);
    const Pose X_WB{{0, 0, 0.01 + draw.between(0.019, 0.03)}, draw.rotation()};
    const Vector3d center = X_WB * draw.in_box({0.01, 0.01, 0.01});
    const Twist twist{draw.in_box({1, 1, 1}), draw.in_box({40, 40, 40})};
    pair.link.find({}, {X_WB, center, twist, twist}, kStep, 0.05);
    const Quaterniond turn = rotation_from_vector(kStep * twist.angular);
    int corners = 0;
    for (const ContactRow& row : pair.link.rows().rows()) {
      const Vector3d corner = X_WB.inverse() * row.point;
      if ((corner.cwiseAbs() - Vector3d(0.015, 0.01, 0.005)).cwiseAbs().maxCoeff() > 1e-9) continue;
      if ((row.normal - Vector3d::UnitZ()).norm() > 1e-9) continue;
      const Vector3d arm = row.point - center;
      const double straight = row.gap + kStep * (twist.linear + twist.angular.cross(arm)).z();
      const double after = (center + kStep * twist.linear + turn * arm).z() - 0.01;
      EXPECT_NEAR(straight + row.curving, std::min(straight, after), kRounding);
      ++corners;
    }
    EXPECT_GT(corners, 0);
  }
}

// The tip of a cone slides down in a conical hole and across its axis, where the wall's other side is next: no step
// takes it through. It knows the wall by tangent planes, which leave some hundredths of the hollow: 20 um.
TEST(CurvedStep, OfATipAcrossTheAxisOfAHoleIsStoppedByItsOtherSide) {
  const Solid hole = combine(Solid::Kind::difference, make(Kind::box, {0.04, 0.04, 0.02}),
                             placed(make(Kind::cone, {0, 0.006, 0.006}), {{0, 0, 0.007}, Quaterniond::Identity()}));
  Pair pair(hole, make(Kind::cone, {0, 0.002, 0.006}), 0.001);
  constexpr double kBottom = 0.004;  // m, height of the hole's apex
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE(seed);
    Draw draw(seed);
    const double beside = draw.between(5e-5, 3e-4), height = kBottom + beside + 1e-6;
    Vector3d p(beside, 0, height + 0.003);  // the cone's middle
    Vector6d u = Vector6d::Zero();
    u.x() = draw.between(-0.5, -0.2);
    u.y() = draw.between(-0.1, 0.1);
    u.z() = u.x();
    for (int i = 0; i < 10; ++i) {
      pair.link.find(
          {}, {{p, Quaterniond::Identity()}, p, {u.head<3>(), Vector3d::Zero()}, {u.head<3>(), Vector3d::Zero()}},
          kStep, 2e-3);
      Matrix6d M = 0.1 * Matrix6d::Identity();
      M.bottomRightCorner<3, 3>() *= 1e9;  // it does not turn
      ConvexStep solver(4096);
      const int cone = solver.add_body(p, M, u, u);
      solver.add_rows(pair.link.rows().rows(), kFixed, cone);
      solver.solve(kStep);
      u = solver.velocity(cone);
      p += kStep * u.head<3>();
      const Vector3d tip = p - Vector3d(0, 0, 0.003);
      EXPECT_GE((tip.z() - kBottom - tip.head<2>().norm()) * std::sqrt(0.5), -2e-5) << "step " << i;
    }
  }
}

}  // namespace
}  // namespace verisim::exact::test::curved_step_test
