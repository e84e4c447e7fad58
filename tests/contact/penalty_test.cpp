#include "engine/contact/penalty.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "engine/base/random.hpp"
#include "tests/contact/allocations.hpp"

namespace verisim::penalty_test {
namespace {

struct RestoreTargets {
  ~RestoreTargets() { use_simd_target(""); }
};

/// `count` contacts in a cube of 0.2 m, with unit normals and depths up to 2 mm.
ContactList random_contacts(std::uint64_t seed, std::uint32_t count) {
  const RandomStream r(seed, "contacts");
  ContactList list(count);
  list.size = count;
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto draw = [&](std::uint64_t k) { return 2 * r.uniform(8 * std::uint64_t{i} + k) - 1; };
    const Vector3f n = Vector3d(draw(3), draw(4), draw(5)).normalized().cast<float>();
    list.x[i] = static_cast<float>(0.1 * draw(0));
    list.y[i] = static_cast<float>(0.1 * draw(1));
    list.z[i] = static_cast<float>(0.1 * draw(2));
    list.nx[i] = n.x(), list.ny[i] = n.y(), list.nz[i] = n.z();
    list.depth[i] = static_cast<float>(0.001 * (1.0 + draw(6)));
  }
  // What an earlier, larger query may have left behind the end must never be read into a sum.
  for (auto* column : {&list.x, &list.nx, &list.depth, &list.fx}) {
    for (std::size_t i = count; i < column->size(); ++i) (*column)[i] = 7.0F;
  }
  return list;
}

Vector3d point(const ContactList& c, std::uint32_t i) {
  return Vector3f(c.x[i], c.y[i], c.z[i]).cast<double>();
}
Vector3d normal(const ContactList& c, std::uint32_t i) {
  return Vector3f(c.nx[i], c.ny[i], c.nz[i]).cast<double>();
}
Vector3d force(const ContactList& c, std::uint32_t i) {
  return Vector3f(c.fx[i], c.fy[i], c.fz[i]).cast<double>();
}

const Vector3d kAbout(0.01, -0.02, 0.03);
const Twist kMoving = {{0.03, -0.02, 0.01}, {0.5, -0.4, 0.3}};

/// W by its definition.
Matrix6d naive_matrix(const ContactList& c, const Vector3d& about) {
  Matrix6d W = Matrix6d::Zero();
  for (std::uint32_t i = 0; i < c.size; ++i) {
    Vector6d J;
    J << normal(c, i), (point(c, i) - about).cross(normal(c, i));
    W += J * J.transpose();
  }
  return W;
}

// Counts around the strands' number and the vectors' widths, where a wrong tail would show.
const std::uint32_t kCounts[] = {0, 1, 2, 3, 7, 8, 9, 15, 16, 17, 31, 33, 100, 1001};

TEST(Penalty, EveryTargetGivesTheSameBits) {
  const RestoreTargets restore;
  for (const std::uint32_t count : kCounts) {
    SCOPED_TRACE(count);
    ContactList first = random_contacts(count, count);
    use_simd_target("scalar");
    apply_penalty(first, kAbout, kMoving, 2000, 5);
    const ContactSum first_sum = sum(first, kAbout);
    const Matrix6d first_matrix = contact_matrix(first, kAbout);
    const Pushing first_at_once = pushing(first, kAbout, kMoving, 2000, 5);
    for (const std::string& target : simd_targets()) {
      SCOPED_TRACE(target);
      use_simd_target(target);
      ContactList list = random_contacts(count, count);
      apply_penalty(list, kAbout, kMoving, 2000, 5);
      for (std::uint32_t i = 0; i < count; ++i) ASSERT_EQ(force(list, i), force(first, i)) << "contact " << i;
      const ContactSum s = sum(list, kAbout);
      EXPECT_EQ(s.wrench.force, first_sum.wrench.force);
      EXPECT_EQ(s.wrench.torque, first_sum.wrench.torque);
      EXPECT_EQ(s.depth_max, first_sum.depth_max);
      EXPECT_EQ(contact_matrix(list, kAbout), first_matrix);
      const Pushing at_once = pushing(list, kAbout, kMoving, 2000, 5);
      EXPECT_EQ(at_once.sum.wrench.force, first_at_once.sum.wrench.force);
      EXPECT_EQ(at_once.sum.wrench.torque, first_at_once.sum.wrench.torque);
      EXPECT_EQ(at_once.W, first_at_once.W);
    }
  }
}

// The forces between the two passes are floats of at most 4 N, arms below 0.3 m: half an ulp of each is 2^-23 N.
TEST(Penalty, InOnePassIsThatInTwoButForTheRoundingOfForces) {
  for (const std::uint32_t count : kCounts) {
    SCOPED_TRACE(count);
    ContactList list = random_contacts(count + 2, count);
    const ContactSum at_once = pushing(list, kAbout, kMoving, 2000, 5).sum;
    for (std::uint32_t i = 0; i < count; ++i) ASSERT_EQ(force(list, i), Vector3d::Zero()) << "forces are not kept";
    apply_penalty(list, kAbout, kMoving, 2000, 5);
    const ContactSum two = sum(list, kAbout);
    const double rounding = count * std::sqrt(3.0) * 0x1p-23;
    EXPECT_LE((at_once.wrench.force - two.wrench.force).norm(), rounding);
    EXPECT_LE((at_once.wrench.torque - two.wrench.torque).norm(), 0.3 * rounding);
    EXPECT_EQ(at_once.depth_max, two.depth_max);
  }
}

TEST(Penalty, OnlyWhatPushesResists) {
  constexpr double kDamping = 60;  // so much that about every third contact does not push
  for (const std::uint32_t count : kCounts) {
    SCOPED_TRACE(count);
    ContactList list = random_contacts(count + 3, count);
    const Matrix6d W = pushing(list, kAbout, kMoving, 2000, kDamping).W;
    apply_penalty(list, kAbout, kMoving, 2000, kDamping);
    ContactList pushes(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      if (force(list, i).isZero(0)) continue;
      const std::uint32_t k = pushes.size++;
      pushes.x[k] = list.x[i], pushes.y[k] = list.y[i], pushes.z[k] = list.z[i];
      pushes.nx[k] = list.nx[i], pushes.ny[k] = list.ny[i], pushes.nz[k] = list.nz[i];
    }
    if (count > 30) {
      EXPECT_LT(pushes.size, 0.9 * count);
      EXPECT_GT(pushes.size, 0.3 * count);
    }
    EXPECT_LE((W - naive_matrix(pushes, kAbout)).norm(), 1e-12 * count);
  }
}

// Sums of n terms below t differ from the long double sum by at most n roundings of n t.
TEST(Penalty, SumsAreTheNaiveSumsWithinRounding) {
  for (const std::uint32_t count : kCounts) {
    SCOPED_TRACE(count);
    ContactList list = random_contacts(count + 1, count);
    apply_penalty(list, kAbout, kMoving, 2000, 5);
    using Long3 = Eigen::Matrix<long double, 3, 1>;
    Long3 f = Long3::Zero();
    Long3 t = Long3::Zero();
    double deepest = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      f += force(list, i).cast<long double>();
      t += (point(list, i) - kAbout).cast<long double>().cross(force(list, i).cast<long double>());
      deepest = std::max(deepest, static_cast<double>(list.depth[i]));
    }
    const ContactSum s = sum(list, kAbout);
    const double rounding = 4.0 * count * count * 0x1p-53 + 0x1p-50;  // forces are below 4 N, arms below 0.3 m
    EXPECT_LE((s.wrench.force - f.cast<double>()).norm(), rounding);
    EXPECT_LE((s.wrench.torque - t.cast<double>()).norm(), rounding);
    EXPECT_EQ(s.depth_max, deepest);
  }
}

TEST(Penalty, GivesTheWorkedForce) {
  ContactList list(1);
  list.size = 1;
  list.x[0] = 0.5F;
  list.nz[0] = 1;
  list.depth[0] = 0.25F;
  // Velocity of the point: (0, 0, 1) + (0, -2, 0) x (0.5, 0, 0) = (0, 0, 1) + (0, 0, 1) = 2 m/s, leaving.
  const Twist leaving = {{0, 0, 1}, {0, -2, 0}};
  apply_penalty(list, Vector3d::Zero(), leaving, 100, 8);  // 100 x 0.25 - 8 x 2 = 9
  EXPECT_EQ(force(list, 0), Vector3d(0, 0, 9));
  EXPECT_EQ(sum(list, Vector3d::Zero()).wrench.torque, Vector3d(0, -4.5, 0));  // (0.5, 0, 0) x (0, 0, 9)
  apply_penalty(list, Vector3d::Zero(), leaving, 100, 13);  // 25 - 26 < 0: it pulls back faster than it pushes
  EXPECT_EQ(force(list, 0), Vector3d::Zero()) << "a surface never pulls";
}

TEST(ContactMatrix, IsTheNaiveOneAndPositiveSemidefinite) {
  for (const std::uint32_t count : kCounts) {
    SCOPED_TRACE(count);
    const ContactList list = random_contacts(count + 2, count);
    const Matrix6d W = contact_matrix(list, kAbout);
    EXPECT_EQ(W, W.transpose());
    EXPECT_LE((W - naive_matrix(list, kAbout)).norm(), 40.0 * count * count * 0x1p-53);
    const double smallest = Eigen::SelfAdjointEigenSolver<Matrix6d>(W).eigenvalues()[0];
    EXPECT_GE(smallest, -1e-13 * std::max(W.norm(), 1.0));
  }
}

/// Largest size that the linear model M v' = -k W q - b W v, stepped semi-implicitly (damping explicit), reaches in
/// 4000 steps from a random start, in the norm in which its energy is measured.
double growth(const Matrix6d& W, const Vector6d& mass, double k, double b, double dt, std::uint64_t seed) {
  const RandomStream r(seed, "start");
  const Vector6d scale = mass.cwiseSqrt();
  Vector6d q;
  for (int i = 0; i < 6; ++i) q[i] = (2 * r.uniform(static_cast<std::uint64_t>(i)) - 1) / scale[i];
  const double start = q.cwiseProduct(scale).norm();
  Vector6d v = Vector6d::Zero();
  double largest = 0;
  for (int step = 0; step < 4000 && largest < 1e6; ++step) {
    v -= (dt * (W * (k * q + b * v))).cwiseQuotient(mass);
    q += dt * v;
    largest = std::max(largest, q.cwiseProduct(scale).norm() / start);
  }
  return largest;
}

// The rule in penalty.hpp: at the bound of the Frobenius norm nothing grows. That norm exceeds the largest eigenvalue
// of a 6 x 6 matrix by at most sqrt(6), so at three times the bound the model is beyond the exact limit, and grows.
TEST(StabilityRule, HoldsAtTheBoundAndFailsAtThreeTimesIt) {
  constexpr double dt = 0.001;
  Vector6d mass;
  mass << 1.5, 1.5, 1.5, 0.004, 0.005, 0.002;  // kg, kg m^2
  const Vector6d inverse_root = mass.cwiseSqrt().cwiseInverse();
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    SCOPED_TRACE(seed);
    const ContactList list = random_contacts(seed, 5 + 20 * static_cast<std::uint32_t>(seed));
    const Matrix6d W = contact_matrix(list, kAbout);
    const double norm = (inverse_root.asDiagonal() * W * inverse_root.asDiagonal()).norm();
    const double limit = 4 / norm;                 // of k dt^2 + 2 b dt
    for (const double damped : {0.0, 0.3, 0.9}) {  // share of the limit that damping takes
      const double k = (1 - damped) * limit / (dt * dt);
      const double b = damped * limit / (2 * dt);
      // A single undamped oscillator just below the limit swings to 1 / sqrt(1 - (1 - 2 margin)^2) of its start.
      EXPECT_LT(growth(W, mass, 0.99 * k, 0.99 * b, dt, seed), 20);
      EXPECT_GE(growth(W, mass, 3 * k, 3 * b, dt, seed), 1e6);
    }
  }
}

TEST(Penalty, AllocatesNothing) {
  ContactList list = random_contacts(1, 500);
  apply_penalty(list, kAbout, kMoving, 2000, 5);
  const auto before = allocations.load();
  apply_penalty(list, kAbout, kMoving, 2000, 5);
  const ContactSum s = sum(list, kAbout);
  const Matrix6d W = contact_matrix(list, kAbout);
  EXPECT_EQ(allocations.load(), before);
  EXPECT_GT(s.wrench.force.norm() + W.norm(), 0);
}

}  // namespace
}  // namespace verisim::penalty_test
