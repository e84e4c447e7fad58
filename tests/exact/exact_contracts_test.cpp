// The doors of engine/exact: bodies, links and the convex problem.
#include <gtest/gtest.h>

#include <limits>

#include "engine/exact/convex_step.hpp"
#include "engine/exact/exact_link.hpp"
#include "tests/support/broken.hpp"

namespace verisim::exact::exact_contracts_test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kStep = 1e-3;

/// One triangle without b-rep: nothing is known precisely of it, and nothing wrong.
Part bare_part() {
  Part part;
  part.mesh = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, {}};
  return part;
}
std::shared_ptr<const ExactBody> body_of(const Part& part, const BodyOptions& options) {
  return std::make_shared<const ExactBody>(std::span(&part, 1), options);
}

TEST(ExactBodyDeathTest, IsCutByOptionsThatMeanSomething) {
  const auto with = [](double BodyOptions::*member, double value) {
    BodyOptions options;
    options.spacing = 0.01;
    options.*member = value;
    return body_of(bare_part(), options);
  };
  EXPECT_BROKEN(with(&BodyOptions::spacing, 0), "is_positive(options.spacing)");
  EXPECT_BROKEN(with(&BodyOptions::line_stiffness, kNaN), "is_positive(options.line_stiffness)");
  EXPECT_BROKEN(with(&BodyOptions::point_length, -1), "is_not_negative(options.point_length)");
  EXPECT_BROKEN(with(&BodyOptions::smooth, -1), "is_not_negative(options.smooth)");
  EXPECT_BROKEN(with(&BodyOptions::group_angle, kNaN), "is_not_negative(options.group_angle)");
}

TEST(ExactBodyDeathTest, IsOfPartsThatHangTogether) {
  BodyOptions options;
  options.spacing = 0.01;
  Part part = bare_part();
  part.mesh.triangles[0][1] = 3;
  EXPECT_BROKEN(body_of(part, options), "is_whole(part.mesh)");
  part = bare_part();
  part.edges.resize(1);
  part.edges[0].faces = {0};
  EXPECT_BROKEN(body_of(part, options), "face < part.faces.size()");
}

TEST(ExactLinkDeathTest, LooksAStepAheadFromTwoPlacements) {
  BodyOptions options;
  options.spacing = 0.01;
  const auto body = body_of(bare_part(), options);
  EXPECT_BROKEN(ExactLink(nullptr, body), "first_ != nullptr");
  EXPECT_BROKEN(ExactLink(body, nullptr), "second_ != nullptr");
  SearchThresholds thresholds;
  thresholds.own_face_none = thresholds.own_face_full;
  EXPECT_BROKEN(ExactLink(body, body, 16, thresholds), "thresholds.own_face_full < thresholds.own_face_none");
  thresholds = {};
  thresholds.cone_none = 0;
  EXPECT_BROKEN(ExactLink(body, body, 16, thresholds), "thresholds.cone_full < thresholds.cone_none");
  ExactLink link(body, body);
  BodyMotion still;
  EXPECT_BROKEN(link.find(still, still, 0, 0.01), "is_positive(dt)");
  EXPECT_BROKEN(link.find(still, still, kStep, -0.01), "!(margin < 0)");
  EXPECT_BROKEN(link.find(still, still, kStep, 0.01, -0.01), "!(overlap < 0)");
  BodyMotion stretched;
  stretched.X_WB.rotation = Quaterniond(2, 0, 0, 0);
  EXPECT_BROKEN(link.find(stretched, still, kStep, 0.01), "is_unit(first.X_WB.rotation)");
  EXPECT_BROKEN(link.find(still, stretched, kStep, 0.01), "is_unit(second.X_WB.rotation)");
  // A run that diverges is told by its state, not by a broken promise.
  BodyMotion diverged;
  diverged.twist.linear.x() = kNaN;
  link.find(diverged, still, kStep, kNaN);
  EXPECT_TRUE(link.rows().rows().empty());
}

TEST(ConvexStepDeathTest, IsOfBodiesWithInertiaAndRowsBetweenThem) {
  ConvexStep step(4);
  const Vector3d o = Vector3d::Zero();
  const Vector6d u = Vector6d::Zero();
  Matrix6d M = Matrix6d::Identity();
  M(0, 5) = 1e-3;
  EXPECT_BROKEN(step.add_body(o, M, u, u), "is_symmetric(M)");
  M = Matrix6d::Identity();
  M(2, 2) = 0;
  EXPECT_BROKEN(step.add_body(o, M, u, u), "!(M.diagonal().array() <= 0).any()");
  M(2, 2) = 1;
  const int body = step.add_body(o, M, u, u);
  EXPECT_BROKEN(step.add_rows({}, body, body), "first != second");
  EXPECT_BROKEN(step.add_rows({}, body, -2), "std::min(first, second) >= kFixed");
  EXPECT_BROKEN(step.add_rows({}, body, body + 1), "std::max(first, second) < static_cast<int>(bodies_.size())");
  const ConvexStep::Grip grip{{1, 2, 3}, {0, 0, 1}, 0.1, 2};
  ConvexStep::Grip bad = grip;
  bad.normal *= 2;
  EXPECT_BROKEN(step.add_grip(bad, kFixed, body, 1e-3), "is_unit(grip.normal)");
  bad = grip;
  bad.drag = -1;
  EXPECT_BROKEN(step.add_grip(bad, kFixed, body, 1e-3), "grip.drag >= 0");
  bad = grip;
  bad.radius = -1;
  EXPECT_BROKEN(step.add_grip(bad, kFixed, body, 1e-3), "grip.radius >= 0");
  EXPECT_BROKEN(step.add_grip(grip, kFixed, body, 0), "is_positive(dt)");
  EXPECT_BROKEN(step.add_grip(grip, body, body, 1e-3), "first != second");
  EXPECT_BROKEN(step.grip_wrench(0), "at(grip) < grips_.size()");
  EXPECT_BROKEN(step.solve(0), "is_positive(dt)");
  EXPECT_BROKEN(step.velocity(body + 1), "at(body) < bodies_.size()");
  EXPECT_BROKEN(step.wrench(-1), "at(body) < bodies_.size()");
  for (int i = 1; i < ConvexStep::kDenseMax; ++i) (void)step.add_body(o, M, u, u);
  EXPECT_BROKEN(step.add_body(o, M, u, u), "bodies_.size() < bodies_.capacity()");
}

}  // namespace
}  // namespace verisim::exact::exact_contracts_test
