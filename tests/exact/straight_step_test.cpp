// The overlap that one frame leaves. A step treats motion and surfaces as straight (exact_link.hpp), so the overlap is
// that of a straight line beside a curve, in closed form, and none of it stays for the next step.
#include <gtest/gtest.h>

#include "engine/exact/convex_step.hpp"
#include "tests/exact/scenes.hpp"

namespace verisim::exact::test::straight_step_test {
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

Pair ball_in_tube(const Sizes& sizes) {
  return {make(Kind::tube, {sizes.bore + 0.01, sizes.bore, 0.02}), make(Kind::sphere, {sizes.ball})};
}

// A ball runs around in a tube. Each step it goes on straight along the wall, by v dt beside a circle of radius
// R - r: the overlap is sqrt((R - r)^2 + (v dt)^2) - (R - r), about (v dt)^2 / 2 (R - r), however many steps it has
// run. Where it passes more than a tenth of R - r in a step, further rows keep it nearer to the wall
// (conforming_normals.hpp).
TEST(StraightStep, OfABallAroundATubeEndsAsDeepAsAStraightLineBesideACircle) {
  for (const Sizes& sizes : kSizes) {
    Pair pair = ball_in_tube(sizes);
    for (const double speed : {0.01, 0.1, 0.3}) {
      SCOPED_TRACE(::testing::Message() << sizes.bore << " " << sizes.ball << " " << speed);
      ConvexStep solver(64);
      const Vector3d o = Vector3d::Zero();
      Vector3d p(sizes.room(), 0, 0);
      Vector6d u = Vector6d::Zero();
      u.y() = speed;
      for (int i = 0; i < 200; ++i) {
        pair.link.find({}, {{p, Quaterniond::Identity()}, p, {u.head<3>(), o}, {u.head<3>(), o}}, kStep, 1e-3);
        solver.clear();
        const int ball = solver.add_body(p, 0.1 * Matrix6d::Identity(), u, u);
        solver.add_rows(pair.link.rows().rows(), kFixed, ball);
        solver.solve(kStep);
        u = solver.velocity(ball);
        const Vector3d across = p.normalized();
        const double along = kStep * (u.head<3>() - across.dot(u.head<3>()) * across).norm();
        p += kStep * u.head<3>();
        const double overlap = std::hypot(sizes.room(), along) - sizes.room();
        EXPECT_LE(p.norm() - sizes.room(), 1.01 * overlap + kRounding) << "frame " << i;
        if (is_close(sizes, kStep * speed)) continue;
        EXPECT_NEAR(p.norm() - sizes.room(), overlap, 0.01 * overlap + kRounding) << "frame " << i;
      }
    }
  }
}

// A tube turns about an axis a beside its own, and a ball that does not move touches its outer wall. The wall's place
// moves on a circle of radius a + R - r and the wall is curved: with phi = omega dt both make
// sqrt((a + R - r)^2 + a^2 - 2 a (a + R - r) cos phi) - (R - r), about a (a + R - r) phi^2 / 2 (R - r).
TEST(StraightStep, OfATurningTubeEndsAsDeepAsAStraightLineBesideBothCircles) {
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
        ASSERT_NEAR(solver.velocity(tube)[5], omega, 1e-6) << "straight along the wall, nothing stops it";
        const double phi = kStep * omega;
        const Quaterniond turned = rotation_from_vector({0, 0, phi});
        const Pose X_W1{center + turned * -center, turned};
        pair.link.find({X_W1, center, turning, turning}, {X_W2, X_W2.position, {}}, kStep, 1e-3);
        const double far = arm + sizes.room();
        const double overlap = std::sqrt(far * far + arm * arm - 2 * arm * far * std::cos(phi)) - sizes.room();
        EXPECT_NEAR(pair.link.depth_max(), overlap, 1e-6 * overlap + kRounding);
        EXPECT_LE(overlap, 0.5 * arm * far * phi * phi / sizes.room() + 1e-15) << "the short formula is a bound";
      }
    }
  }
}

}  // namespace
}  // namespace verisim::exact::test::straight_step_test
