// Blows and late rows of the convex step, against closed forms; and many bodies at once.
#include <gtest/gtest.h>

#include "engine/exact/convex_step.hpp"
#include "tests/exact/scenes.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::exact::test::impact_test {
namespace {

using verisim::test::tolerance;

constexpr double kStep = 0.001;

ContactRow row_at(const Vector3d& normal, double gap, double stiffness) {
  return {.normal = normal, .point = Vector3d::Zero(), .gap = gap, .stiffness = stiffness, .source = 0};
}
Vector6d along_x(double v) {
  Vector6d u = Vector6d::Zero();
  u.x() = v;
  return u;
}

/// Bodies that move along x, in a row; neighbours are `gaps` apart. Velocities after one step.
struct Row {
  std::vector<double> masses, speeds, gaps;
  double restitution = 1, stiffness = 1e9;

  std::vector<double> step() const {
    ConvexStep step(64, masses.size());
    for (std::size_t i = 0; i < masses.size(); ++i)
      step.add_body(Vector3d::Zero(), masses[i] * Matrix6d::Identity(), along_x(speeds[i]), along_x(speeds[i]));
    for (std::size_t i = 0; i < gaps.size(); ++i) {
      const ContactRow row = row_at(Vector3d::UnitX(), gaps[i], stiffness);
      step.add_rows(std::span(&row, 1), static_cast<int>(i), static_cast<int>(i) + 1,
                    {.restitution = restitution, .overlap = 0});
    }
    step.solve(kStep);
    std::vector<double> after;
    for (std::size_t i = 0; i < masses.size(); ++i) after.push_back(step.velocity_after(static_cast<int>(i)).x());
    return after;
  }
  [[nodiscard]] double momentum(const std::vector<double>& u) const {
    double sum = 0;
    for (std::size_t i = 0; i < u.size(); ++i) sum += masses[i] * u[i];
    return sum;
  }
  [[nodiscard]] double energy(const std::vector<double>& u) const {
    double sum = 0;
    for (std::size_t i = 0; i < u.size(); ++i) sum += 0.5 * masses[i] * u[i] * u[i];
    return sum;
  }
};

// Newton's law of impact for two bodies, whatever the stiffness, the gap within the step and the masses.
TEST(Blow, OfTwoBodiesIsNewtons) {
  for (const double stiffness : {1e2, 1e6, 1e10})
    for (const double mass : {0.01, 1.0, 50.0})
      for (const double e : {0.1, 0.5, 0.9, 1.0})
        for (const double gap : {0.0, 0.0003, 0.0009}) {
          const Row row{{1, mass}, {2, 1}, {gap}, e, stiffness};
          const std::vector<double> after = row.step();
          ASSERT_NEAR(after[1] - after[0], e, tolerance(1e-4)) << stiffness << " " << mass << " " << e << " " << gap;
          ASSERT_NEAR(row.momentum(after), row.momentum(row.speeds), tolerance(1e-9 * (2 + mass)));
        }
}

TEST(Blow, IsNoneBelowTheThresholdNorOfWhatLies) {
  const Row slow{{1, 1}, {0.009, 0}, {0}};
  EXPECT_NEAR(slow.step()[0], 0.0045, 1e-5);
  const Row slides{{1, 1}, {0.1, 0}, {-0.00005}};  // overlaps by half of its approach within the step
  EXPECT_NEAR(slides.step()[1] - slides.step()[0], 0.05, 1e-3) << "the spring gives what it holds and no more";
}

// A row of three that touch, hit by the first: one simultaneous blow that keeps the energy.
TEST(Blow, OfARowThatTouchesKeepsMomentumAndEnergy) {
  const Row row{{1, 1, 1}, {1, 0, 0}, {0, 0}, 1, 1e12};
  const std::vector<double> after = row.step();
  EXPECT_NEAR(after[0], -1.0 / 3, 1e-4);
  EXPECT_NEAR(after[1], 2.0 / 3, 1e-4);
  EXPECT_NEAR(after[2], 2.0 / 3, 1e-4);
}

// The last is leaving when the first arrives: Newton's law for all at once would create energy; the step does not.
TEST(Blow, OfARowThatPartsCreatesNoEnergy) {
  const Row parting{{1, 1, 1}, {1, 0, 0.5}, {0, 0}};
  const std::vector<double> after = parting.step();
  EXPECT_LE(parting.energy(after), parting.energy(parting.speeds) * (1 + 1e-9));
  EXPECT_GT(parting.energy(after), parting.energy(parting.speeds) * 0.8);
  EXPECT_NEAR(parting.momentum(after), 1.5, 1e-9);
}

TEST(Blow, OfRandomRowsNeverCreatesEnergyAndKeepsMomentum) {
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    Draw draw(seed);
    Row row;
    const int count = 2 + static_cast<int>(draw.between(0, 14));
    for (int i = 0; i < count; ++i) {
      row.masses.push_back(std::pow(10.0, draw.between(-2, 2)));
      row.speeds.push_back(draw.between(-2, 2));
      if (i > 0) row.gaps.push_back(draw.between(0, 0.002));
    }
    row.restitution = draw.between(0, 1);
    row.stiffness = std::pow(10.0, draw.between(3, 10));
    const std::vector<double> after = row.step();
    const double momenta = std::sqrt(row.energy(row.speeds) * 2 * 100 * count);
    ASSERT_LE(row.energy(after), row.energy(row.speeds) * (1 + 1e-9)) << "seed " << seed;
    ASSERT_NEAR(row.momentum(after), row.momentum(row.speeds), tolerance(1e-8 * momenta)) << "seed " << seed;
  }
}

/// Free bodies of any shape with any velocities, and rows between them anywhere.
struct Cluster {
  std::vector<Vector3d> at;
  std::vector<Matrix6d> M;
  std::vector<Vector6d> u;
  double held = 0;  ///< J, by the rows' springs
  ConvexStep step{64, 16};

  /// @param pull  m/s, by which what acts beside contacts has changed their velocities
  Cluster(Draw& draw, double pull) {
    const int count = 2 + static_cast<int>(draw.between(0, 4));
    for (int i = 0; i < count; ++i) {
      Matrix3d A;
      for (int c = 0; c < 9; ++c) A(c) = draw.between(-0.1, 0.1);
      const double mass = std::pow(10.0, draw.between(-2, 2));
      M.push_back(Matrix6d::Zero());
      M.back().topLeftCorner<3, 3>() = mass * Matrix3d::Identity();
      M.back().bottomRightCorner<3, 3>() = mass * (A * A.transpose() + 1e-4 * Matrix3d::Identity());
      at.push_back(draw.in_box({0.1, 0.1, 0.1}));
      u.emplace_back();
      u.back() << draw.in_box({2, 2, 2}), draw.in_box({10, 10, 10});
      const Vector6d before = u.back() + along_x(draw.between(-pull, pull));
      step.add_body(at.back(), M.back(), u.back(), before);
    }
    const double e = std::min(1.0, draw.between(0.01, 1.5)), deepest = draw.between(-1e-4, 1e-4);
    for (int i = 1; i < count; ++i) {
      std::vector<ContactRow> rows;
      for (int r = 0; r < 4; ++r) {
        rows.push_back(row_at((draw.rotation() * Vector3d::UnitX()).normalized(),
                              draw.between(std::min(deepest, 0.0), 1e-3), std::pow(10.0, draw.between(4, 9))));
        rows.back().point = draw.in_box({0.1, 0.1, 0.1});
        held += 0.5 * rows.back().stiffness * std::pow(std::min(0.0, rows.back().gap), 2);
      }
      step.add_rows(rows, static_cast<int>(draw.between(0, i)), i,
                    {.restitution = e, .overlap = std::max(0.0, -deepest)});
    }
  }
  /// About the origin, of bodies that have moved with `moved` for one step and have the velocities `with`.
  template <typename Moved, typename With>
  [[nodiscard]] Vector6d momentum(Moved moved, With with) const {
    Vector6d sum = Vector6d::Zero();
    for (std::size_t i = 0; i < M.size(); ++i) {
      const Vector6d p = M[i] * with(i);
      sum.head<3>() += p.head<3>();
      sum.tail<3>() += p.tail<3>() + (at[i] + moved(i)).cross(Vector3d(p.head<3>()));
    }
    return sum;
  }
  template <typename With>
  [[nodiscard]] double energy(With with) const {
    double sum = 0;
    for (std::size_t i = 0; i < M.size(); ++i) sum += 0.5 * with(i).dot(M[i] * with(i));
    return sum;
  }
};

// Whatever is hit wherever, and whatever pulls at it meanwhile: linear and angular momentum are kept by bodies that
// move within the step, and if nothing pulls, no energy comes from anywhere but springs.
TEST(Blow, InSpaceKeepsMomentumAndCreatesNoEnergy) {
  int rebounds = 0;
  for (std::uint64_t seed = 0; seed < 5000; ++seed) {
    SCOPED_TRACE(seed);
    Draw draw(seed);
    const double pull = seed % 2 == 0 ? 0 : 2;
    Cluster cluster(draw, pull);
    cluster.step.solve(kStep);
    rebounds += cluster.step.was_hit() ? 1 : 0;
    const auto before = [&](std::size_t i) { return cluster.u[i]; };
    const auto after = [&](std::size_t i) { return cluster.step.velocity_after(static_cast<int>(i)); };
    const auto way = [&](std::size_t i) {
      return Vector3d(kStep * cluster.step.velocity(static_cast<int>(i)).head<3>());
    };
    const Vector6d start = cluster.momentum([](std::size_t) { return Vector3d(Vector3d::Zero()); }, before);
    const double size = std::sqrt(cluster.energy(before)) * 10;
    ASSERT_LE((cluster.momentum(way, after) - start).norm(), tolerance(1e-8 * size));
    if (pull == 0) {
      ASSERT_LE(cluster.energy(after), cluster.energy(before) * (1 + 1e-9) + cluster.held);
    }
  }
  EXPECT_GT(rebounds, 1000);
}

// A row that is there for the first time a millimetre deep moves the bodies apart and gives them no speed; the same row
// whose overlap is known is a spring.
TEST(LateRow, GivesNoEnergy) {
  const auto after = [](double known) {
    ConvexStep step(8, 2);
    for (int i = 0; i < 2; ++i)
      step.add_body(Vector3d::Zero(), Matrix6d::Identity(), Vector6d::Zero(), Vector6d::Zero());
    const ContactRow row = row_at(Vector3d::UnitX(), -0.001, 1e9);
    step.add_rows(std::span(&row, 1), 0, 1, {.restitution = 0.5, .overlap = known});
    step.solve(kStep);
    return std::array{step.velocity(1).x() - step.velocity(0).x(),
                      step.velocity_after(1).x() - step.velocity_after(0).x()};
  };
  EXPECT_NEAR(after(0)[0], ConvexStep::kPushOut, 0.01);
  EXPECT_NEAR(after(0)[1], 0, 1e-9);
  EXPECT_NEAR(after(0.001)[0], 1, 0.01);
  EXPECT_EQ(after(0.001)[0], after(0.001)[1]);
}

/// A heap: each body has rows with `others` of those before it or with what is fixed.
void fill(ConvexStep& step, Draw& draw, int bodies, int others, std::vector<Matrix6d>& M, std::vector<Vector6d>& u0) {
  step.clear();
  M.clear();
  u0.clear();
  for (int i = 0; i < bodies; ++i) {
    Matrix6d A;
    for (int c = 0; c < 36; ++c) A(c) = draw.between(-1, 1);
    M.push_back(A * A.transpose() + 0.05 * Matrix6d::Identity());
    Vector6d u;
    for (int c = 0; c < 6; ++c) u[c] = draw.between(-0.05, 0.05);
    u0.push_back(u);
    step.add_body(draw.in_box({0.1, 0.1, 0.1}), M.back(), u, u);
  }
  for (int i = 0; i < bodies; ++i) {
    for (int k = 0; k < others; ++k) {
      const int other = static_cast<int>(std::floor(draw.between(-1, i)));
      std::vector<ContactRow> rows;
      for (int r = 0; r < 4; ++r) {
        rows.push_back(row_at((draw.rotation() * Vector3d::UnitX()).normalized(), draw.between(-2e-5, 2e-5),
                              1e6 * std::pow(10.0, draw.between(0, 3))));
        rows.back().point = draw.in_box({0.1, 0.1, 0.1});
      }
      step.add_rows(rows, std::max(other, kFixed), i);
    }
  }
}

double unbalanced(const ConvexStep& step, const std::vector<Matrix6d>& M, const std::vector<Vector6d>& u0) {
  double scale = 0;
  double most = 0;
  for (std::size_t i = 0; i < step.row_count(); ++i) scale = std::max(scale, kStep * step.force(i));
  for (std::size_t i = 0; i < M.size(); ++i) {
    const Wrench w = step.wrench(static_cast<int>(i));
    Vector6d impulse;
    impulse << kStep * w.force, kStep * w.torque;
    most = std::max(most, (impulse - M[i] * (step.velocity_after(static_cast<int>(i)) - u0[i])).norm());
  }
  return most / scale;
}

// The condition for the one minimum, for heaps of up to 150 bodies.
TEST(ManyBodies, EndWhereMomentumBalances) {
  ConvexStep step(4096, 150);
  std::vector<Matrix6d> M;
  std::vector<Vector6d> u0;
  step.reserve_blocks(150 * 149 / 2);
  int most = 0;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE(seed);
    Draw draw(seed);
    fill(step, draw, 9 + static_cast<int>(draw.between(0, 141)), 3, M, u0);
    most = std::max(most, step.solve(kStep));
    EXPECT_TRUE(step.finished());
    EXPECT_GT(step.blocks_needed(), 0U);
    ASSERT_LE(unbalanced(step, M, u0), 1e-6);
  }
  EXPECT_LE(most, 60);
}

// Without room for the factor it either arrives all the same, body by body, or says that it has not.
TEST(ManyBodies, SayWhetherTheyArrivedWithoutRoomForTheFactor) {
  Draw draw(3);
  std::vector<Matrix6d> M;
  std::vector<Vector6d> u0;
  ConvexStep step(4096, 100);
  fill(step, draw, 100, 9, M, u0);
  step.solve(kStep);
  ASSERT_GT(step.blocks_needed(), step.blocks_max()) << "there was room: this proves nothing";
  EXPECT_TRUE(!step.finished() || unbalanced(step, M, u0) <= 1e-6);
  step.reserve_blocks(2 * step.blocks_needed());  // other rows act on the way that it takes with room
  Draw again(3);
  fill(step, again, 100, 9, M, u0);
  step.solve(kStep);
  EXPECT_TRUE(step.finished());
  EXPECT_LE(unbalanced(step, M, u0), 1e-6);
}

}  // namespace
}  // namespace verisim::exact::test::impact_test
