#include "engine/exact/convex_step.hpp"

#include <gtest/gtest.h>

#include "tests/contact/allocations.hpp"
#include "tests/exact/scenes.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::exact::test::convex_step_test {
namespace {

using verisim::test::tolerance;

constexpr double kStep = 0.001;

ContactRow row_at(const Vector3d& normal, const Vector3d& point, double gap, double stiffness) {
  return {.normal = normal, .point = point, .gap = gap, .stiffness = stiffness, .source = 0};
}

/// Rows around a hole, as a tight fit has them, at random gaps and with stiffnesses over four decades.
std::vector<ContactRow> random_rows(Draw& draw, int count) {
  std::vector<ContactRow> rows;
  for (int i = 0; i < count; ++i) {
    const Vector3d n = (draw.rotation() * Vector3d::UnitX()).normalized();
    rows.push_back(
        row_at(n, draw.in_box({0.1, 0.1, 0.1}), draw.between(-2e-5, 2e-5), 1e6 * std::pow(10.0, draw.between(0, 4))));
  }
  return rows;
}

Matrix6d random_matrix(Draw& draw) {
  Matrix6d A;
  for (int i = 0; i < 36; ++i) A(i) = draw.between(-1, 1);
  return A * A.transpose() + 0.05 * Matrix6d::Identity();
}
Vector6d random_velocity(Draw& draw) {
  Vector6d u;
  for (int i = 0; i < 6; ++i) u[i] = draw.between(-0.05, 0.05);
  return u;
}

Vector6d column(const Wrench& w) {
  Vector6d c;
  c << w.force, w.torque;
  return c;
}

// One body of mass m meets one wall with speed v: u = v - dt f/m and f = -k (g + dt u), solved by hand.
TEST(OneRow, GivesTheClosedForm) {
  constexpr double kMass = 2;
  constexpr double kStiffness = 1e6;
  constexpr double kGap = 1e-5;
  ConvexStep step(8);
  Vector6d u0 = Vector6d::Zero();
  u0.x() = -0.1;
  const int body = step.add_body(Vector3d::Zero(), kMass * Matrix6d::Identity(), u0, Vector6d::Zero());
  const ContactRow row = row_at(Vector3d::UnitX(), Vector3d::Zero(), kGap, kStiffness);
  step.add_rows(std::span(&row, 1), kFixed, body);
  EXPECT_EQ(step.solve(kStep), 1);
  const double u = (kMass * -0.1 - kStep * kStiffness * kGap) / (kMass + kStep * kStep * kStiffness);
  EXPECT_NEAR(step.velocity(body).x(), u, tolerance(1e-16));
  EXPECT_NEAR(step.force(0), -kStiffness * (kGap + kStep * u), tolerance(1e-11));
  EXPECT_NEAR(step.wrench(body).force.x(), step.force(0), 0);
}

// The condition for the one minimum: what the contacts' impulse changes is the momentum, M (u - u0) = dt sum J f.
TEST(ConvexStep, EndsWhereMomentumBalances) {
  int iterations_max = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    Draw draw(seed);
    const std::vector<ContactRow> rows = random_rows(draw, 40);
    const Matrix6d M = random_matrix(draw);
    const Vector6d u0 = random_velocity(draw);
    ConvexStep step(64);
    const int body = step.add_body(draw.in_box({0.1, 0.1, 0.1}), M, u0, random_velocity(draw));
    step.add_rows(rows, kFixed, body);
    iterations_max = std::max(iterations_max, step.solve(kStep));
    const Vector6d impulse = kStep * column(step.wrench(body));
    const Vector6d momentum = M * (step.velocity(body) - u0);
    double scale = 0;
    for (std::size_t i = 0; i < step.row_count(); ++i) scale += kStep * step.force(i);
    ASSERT_LE((impulse - momentum).norm(), tolerance(1e-7 * scale + 1e-12));
  }
  EXPECT_LE(iterations_max, 30);
}

// The start of the search is no part of the answer.
TEST(ConvexStep, EndsInTheSamePlaceFromAnywhere) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    Draw draw(seed);
    const std::vector<ContactRow> rows = random_rows(draw, 40);
    const Matrix6d M = random_matrix(draw);
    const Vector6d u0 = random_velocity(draw);
    ConvexStep step(64);
    Vector6d first = Vector6d::Zero();
    for (int i = 0; i < 3; ++i) {
      step.clear();
      const int body = step.add_body(Vector3d::Zero(), M, u0, (i * 10) * random_velocity(draw));
      step.add_rows(rows, kFixed, body);
      step.solve(kStep);
      if (i == 0) first = step.velocity(body);
      ASSERT_LE((step.velocity(body) - first).norm(), tolerance(1e-9)) << "seed " << seed;
    }
  }
}

// Two bodies that push each other: momentum is kept, and a partner of a million times the mass is like a wall.
TEST(TwoBodies, KeepTheirMomentum) {
  const ContactRow row = row_at(Vector3d::UnitX(), {0.05, 0.01, 0}, -1e-6, 1e8);
  Vector6d u0 = Vector6d::Zero();
  u0.x() = -0.1;
  const auto solve = [&](double mass_of_first, bool fixed) {
    ConvexStep step(8);
    const int second = step.add_body({0.1, 0, 0}, Matrix6d::Identity(), u0, u0);
    const int first = fixed ? kFixed
                            : step.add_body(Vector3d::Zero(), mass_of_first * Matrix6d::Identity(), Vector6d::Zero(),
                                            Vector6d::Zero());
    step.add_rows(std::span(&row, 1), first, second);
    step.solve(kStep);
    if (!fixed) {
      const Wrench a = step.wrench(first);
      const Wrench b = step.wrench(second);
      EXPECT_LE((a.force + b.force).norm(), 1e-12 * b.force.norm());
      const Vector3d momentum = mass_of_first * step.velocity(first).head<3>() + step.velocity(second).head<3>();
      EXPECT_NEAR(momentum.x(), -0.1, tolerance(1e-9));
    }
    return step.velocity(second);
  };
  solve(1, false);
  const Vector6d against_wall = solve(1, true);
  EXPECT_LE((solve(1e9, false) - against_wall).norm(), tolerance(1e-8));
}

// A column of bodies on a floor carries its weight: the lowest contact all of it.
TEST(Stack, RestsOnItsLowestBody) {
  for (const int count : {8, 60}) {
    ConvexStep step(64, 60);
    std::vector<Vector6d> u(static_cast<std::size_t>(count), Vector6d::Zero());
    std::vector<double> gap(static_cast<std::size_t>(count));
    for (int i = 0; i < 4 * count * count; ++i) {  // a tall one takes longer to settle
      step.clear();
      for (const Vector6d& v : u) {
        Vector6d u0 = v;
        u0.z() -= 9.81 * kStep;
        step.add_body(Vector3d::Zero(), Matrix6d::Identity(), u0, v);
      }
      for (int j = 0; j < count; ++j) {
        const ContactRow row = row_at(Vector3d::UnitZ(), Vector3d::Zero(), gap[static_cast<std::size_t>(j)], 1e8);
        step.add_rows(std::span(&row, 1), j - 1, j);  // -1 is kFixed: the floor
      }
      step.solve(kStep);
      for (int j = 0; j < count; ++j) {
        const auto at = static_cast<std::size_t>(j);
        u[at] = step.velocity(j);
        gap[at] = step.gap_at_end(at);
      }
    }
    for (int j = 0; j < count; ++j)
      EXPECT_NEAR(step.force(static_cast<std::size_t>(j)), (count - j) * 9.81, tolerance(1e-7 * 9.81 * count));
  }
}

// A dozen bodies in a chain, with and without blows. Each row is cut into several at its place, in any order: nothing
// but roundings changes, and each part has its part of the force.
TEST(ConvexStep, SolvesRowsAtOnePlaceAsTheirSum) {
  constexpr int kBodies = 12;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Draw draw(seed);
    ConvexStep whole(1000, kBodies), cut(1000, kBodies);
    for (ConvexStep* step : {&whole, &cut}) {
      Draw of_bodies(100 + seed);
      for (int i = 0; i < kBodies; ++i) {
        const Vector6d u = random_velocity(of_bodies);
        (void)step->add_body(of_bodies.in_box({0.1, 0.1, 0.1}), random_matrix(of_bodies), u, u);
      }
    }
    const ConvexStep::Pair pair{.restitution = seed % 2 == 0 ? 0 : 0.5, .overlap = 1e-4};
    std::vector<std::vector<std::size_t>> parts;  // of each row of `whole`, rows of `cut`
    std::size_t added = 0;
    for (int i = 0; i < kBodies; ++i) {
      const std::vector<ContactRow> rows = random_rows(draw, 6);
      std::vector<ContactRow> pieces;
      parts.resize(parts.size() + rows.size());
      for (int piece = 0; piece < 3; ++piece) {
        for (std::size_t r = 0; r < rows.size(); ++r) {
          if (piece > 0 && draw.between(0, 1) < 0.3) continue;
          parts[parts.size() - rows.size() + r].push_back(added++);
          pieces.push_back(rows[r]);
        }
      }
      for (std::size_t r = 0; r < rows.size(); ++r)
        for (const std::size_t p : parts[parts.size() - rows.size() + r])
          pieces[p - (added - pieces.size())].stiffness /=
              static_cast<double>(parts[parts.size() - rows.size() + r].size());
      whole.add_rows(rows, i == 0 ? kFixed : i - 1, i, pair);
      cut.add_rows(pieces, i == 0 ? kFixed : i - 1, i, pair);
    }
    (void)whole.solve(kStep);
    (void)cut.solve(kStep);
    EXPECT_EQ(cut.row_count(), added);
    for (int i = 0; i < kBodies; ++i) {
      EXPECT_LE((whole.velocity(i) - cut.velocity(i)).norm(), 1e-9);
      EXPECT_LE((whole.velocity_after(i) - cut.velocity_after(i)).norm(), 1e-9);
    }
    double most = 0;
    for (std::size_t r = 0; r < parts.size(); ++r) most = std::max(most, whole.force(r));
    EXPECT_GT(most, 0);
    for (std::size_t r = 0; r < parts.size(); ++r) {
      for (const std::size_t p : parts[r]) {
        EXPECT_NEAR(cut.force(p), whole.force(r) / static_cast<double>(parts[r].size()), 1e-6 * most);
        EXPECT_NEAR(cut.gap_at_end(p), whole.gap_at_end(r), 1e-12);
      }
    }
  }
}

// What a row was told of curves may be wrong by any amount: it gives no energy. Told rightly it is all taken.
TEST(ConvexStep, WhatCurvesGivesNoEnergy) {
  constexpr double kSpeed = 1, kMass = 2;
  for (const double told : {1e-6, 1e-5, 3e-5, 1e-4, 3e-4, 1e-3, 1e-2}) {
    SCOPED_TRACE(told);
    ContactRow row = row_at(Vector3d::UnitX(), Vector3d::Zero(), 0, 1e9);
    row.curving = -told;
    Vector6d u = Vector6d::Zero();
    u.y() = kSpeed;
    ConvexStep step(8);
    const int body = step.add_body(Vector3d::Zero(), kMass * Matrix6d::Identity(), u, u);
    step.add_rows(std::span(&row, 1), kFixed, body);
    step.solve(kStep);
    EXPECT_LE(step.velocity(body).squaredNorm(), 1.0101 * kSpeed * kSpeed);
    if (told < 0.1 * kSpeed * kStep) {
      EXPECT_NEAR(kStep * step.velocity(body).x(), told, 3e-3 * told);
    }
  }
}

// A body of 1e-9 kg lies on a box of 1 kg, which lies on a plate, each on four corners: it has next to no part in the
// cost of the whole, and is held like any other.
TEST(ConvexStep, BalancesWhatIsLightBesideWhatIsHeavy) {
  constexpr double kGravity = 9.81;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE(seed);
    Draw draw(seed);
    ConvexStep step(64);
    Vector6d free = Vector6d::Zero();
    free.z() = -kStep * kGravity;
    const auto inertia = [](double mass) {
      Matrix6d M = mass * Matrix6d::Identity();
      M.bottomRightCorner<3, 3>() *= 1e-4;
      return M;
    };
    const double light = std::pow(10.0, draw.between(-9, -6));
    const int below = step.add_body({0, 0, 0.01}, inertia(1), free, Vector6d::Zero());
    const int above = step.add_body({0, 0, 0.03}, inertia(light), free, Vector6d::Zero());
    std::vector<ContactRow> of_below, of_above;
    for (const double x : {-0.01, 0.01})
      for (const double y : {-0.01, 0.01}) {
        of_below.push_back(row_at(Vector3d::UnitZ(), {x, y, 0}, draw.between(-1e-9, 1e-9), 1e9));
        of_above.push_back(row_at(Vector3d::UnitZ(), {0.7 * x, 0.7 * y, 0.02}, draw.between(-1e-12, 1e-12), 1e9));
      }
    step.add_rows(of_below, kFixed, below);
    step.add_rows(of_above, below, above);
    step.solve(kStep);
    const double momentum = light * (step.velocity(above).z() - free.z());
    EXPECT_NEAR(kStep * step.wrench(above).force.z(), momentum, 1e-7 * light * kStep * kGravity);
  }
}

TEST(ConvexStep, LeavesOutRowsBeyondItsCapacityAndSaysSo) {
  Draw draw(1);
  ConvexStep step(10);
  const int body = step.add_body(Vector3d::Zero(), Matrix6d::Identity(), Vector6d::Zero(), Vector6d::Zero());
  step.add_rows(random_rows(draw, 12), kFixed, body);
  EXPECT_EQ(step.row_count(), 10U);
  EXPECT_EQ(step.left_out(), 2U);
}

TEST(ConvexStep, AllocatesNothing) {
  Draw draw(1);
  const std::vector<ContactRow> rows = random_rows(draw, 40);
  ConvexStep step(1024, 40);
  const std::uint64_t before = allocations;
  for (const int bodies : {1, 2, 3, 9, 40}) {
    step.clear();
    for (int i = 0; i < bodies; ++i)
      step.add_body(Vector3d::Zero(), Matrix6d::Identity(), Vector6d::Constant(-0.01 * i), Vector6d::Zero());
    for (int i = 0; i < bodies; ++i) step.add_rows(std::span(rows).first(20), i - 1, i);
    step.solve(kStep);
  }
  EXPECT_EQ(allocations, before);
}

}  // namespace
}  // namespace verisim::exact::test::convex_step_test
