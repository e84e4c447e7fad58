// Bodies that nobody holds and no weight pulls: whatever answers their contacts, the momentum of all is that of the
// start, and the record tells of equal and opposite wrenches.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/pinned_math.hpp"
#include "engine/dynamics/body.hpp"
#include "tests/length.hpp"
#include "tests/simulation/hybrid_scenes.hpp"
#include "tests/simulation/link_wrench.hpp"
#include "tests/support/random_inputs.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::momentum_test {
namespace {

using test::by_length;
using test::Inputs;
using test::link_wrench;
using test::seeds;
using test::tolerance;

/// Of what is summed: the momenta of the start and all that contacts exchanged.
constexpr double kRounding = 1e-9;

struct Answer {
  const char* name;
  Hybrid hybrid;
  Integrator integrator;
  ContactMethod contact = ContactMethod::voxmap;
  double restitution = 0;
};
void PrintTo(const Answer& answer, std::ostream* out) {
  *out << answer.name;
}

const BodyDescription& body_like(std::uint64_t kind) {
  static const std::array bodies = {
      scenes::body_of("box", *scenes::solid(Solid::Kind::box, {0.05, 0.04, 0.03}), 0.003),
      scenes::body_of("sphere", *scenes::solid(Solid::Kind::sphere, {0.02}), 0.003),
      scenes::body_of("cylinder", *scenes::solid(Solid::Kind::cylinder, {0.02, 0.05}), 0.003)};
  return bodies.at(kind % bodies.size());
}

Scene scene_of(const Answer& answer) {
  Scene scene;
  scene.parameters.hybrid = answer.hybrid;
  scene.parameters.integrator = answer.integrator;
  scene.parameters.contact = answer.contact;
  scene.parameters.restitution = answer.restitution;
  scene.parameters.all_bodies_are_dynamic = true;
  scene.parameters.gravity = Vector3d::Zero();
  scene.parameters.duration = 0.15;
  return scene;
}

/// Two that fly at each other, a little past the middle, and turn; one up to a thousand times as heavy as the other.
Scene random_pair(std::uint64_t seed, const Answer& answer) {
  Inputs in(seed);
  Scene scene = scene_of(answer);
  scene.bodies = {body_like(seed), body_like(seed / 3)};
  const Quaterniond from = in.rotation();
  for (BodyDescription& body : scene.bodies) {
    body.X_WB.rotation = in.rotation();
    body.twist.angular = in.vector(5);
  }
  scene.bodies[0].name = "first";
  scene.bodies[1].name = "second";
  scene.bodies[1].density *= pinned::pow(10, in.between(-3, 3));
  scene.bodies[0].X_WB.position = in.vector(0.1);
  scene.bodies[1].X_WB.position =
      scene.bodies[0].X_WB.position + from * Vector3d(0.07, in.between(-0.01, 0.01), in.between(-0.01, 0.01));
  scene.bodies[1].twist.linear = from * Vector3d(in.between(-1, -0.4), 0, 0);
  return scene;
}

/// Momentum of all bodies about the world's origin: linear [kg m/s], angular [kg m^2/s].
struct Momentum {
  Wrench sum;
  double linear = 0, angular = 0;  ///< sums of magnitudes
};

class Observed {
 public:
  explicit Observed(const Scene& scene) : simulation_(scene, {}) {
    for (const BodyDescription& body : scene.bodies) {
      const MassProperties mass = body.parts[0].mass;
      rigid_.push_back(make_body(body.name, mass.volume, mass.centroid, mass.inertia, body.density));
    }
    start_ = momentum();
    linear_ = start_.linear;
    angular_ = start_.angular;
  }

  /// All frames; wrenches of each are summed about the world's origin, bodies where they were when contacts were found.
  void run() {
    while (simulation_.frame() < simulation_.frames_planned()) {
      place();
      simulation_.step();
      Wrench sum;
      double force = 0, torque = 0;
      for (std::size_t i = 0; i < rigid_.size(); ++i) {
        const Wrench w = simulation_.body_force(i);
        const Vector3d arm = rigid_[i].p_WC;
        sum += {w.force, w.torque + arm.cross(w.force)};
        force += w.force.norm();
        torque += w.torque.norm() + arm.norm() * w.force.norm();
      }
      ASSERT_LE(sum.force.norm(), tolerance(kRounding * force)) << "frame " << simulation_.frame();
      ASSERT_LE(sum.torque.norm(), tolerance(kRounding * torque)) << "frame " << simulation_.frame();
      impulse_ += simulation_.dt() * force;
      linear_ += simulation_.dt() * force;
      angular_ += simulation_.dt() * torque;
      if (rigid_.size() == 2) check_link(force, torque);
      const Momentum now = momentum();
      ASSERT_LE((now.sum.force - start_.sum.force).norm(), tolerance(kRounding * linear_)) << simulation_.frame();
      ASSERT_LE((now.sum.torque - start_.sum.torque).norm(), tolerance(kRounding * angular_)) << simulation_.frame();
    }
  }
  /// N s, of all bodies.
  [[nodiscard]] double impulse() const { return impulse_; }
  [[nodiscard]] const Simulation& simulation() const { return simulation_; }

 private:
  void place() {
    for (std::size_t i = 0; i < rigid_.size(); ++i) rigid_[i].set_pose(simulation_.body_pose(i));
  }
  void check_link(double force, double torque) const {
    const Wrench link = link_wrench(simulation_);
    const Wrench on_second = simulation_.body_force(1);
    ASSERT_LE((link.force - on_second.force).norm(), tolerance(kRounding * force));
    ASSERT_LE((link.torque - on_second.torque).norm(), tolerance(kRounding * torque));
  }
  [[nodiscard]] Momentum momentum() {
    place();
    Momentum m;
    for (std::size_t i = 0; i < rigid_.size(); ++i) {
      const Twist u = simulation_.body_twist(i);
      const Vector3d p = rigid_[i].mass * u.linear;
      const Vector3d spin = rigid_[i].inertia_W() * u.angular;
      m.sum += {p, spin + rigid_[i].p_WC.cross(p)};
      m.linear += p.norm();
      m.angular += spin.norm() + rigid_[i].p_WC.norm() * p.norm();
    }
    return m;
  }

  Simulation simulation_;
  std::vector<RigidBody> rigid_;
  Momentum start_;
  double impulse_ = 0, linear_ = 0, angular_ = 0;
};

class FreeBodies : public testing::TestWithParam<Answer> {};
INSTANTIATE_TEST_SUITE_P(
    EveryMethod, FreeBodies,
    testing::Values(Answer{"off", hybrid::off, Integrator::semi_implicit},
                    Answer{"off, implicit", hybrid::off, Integrator::implicit},
                    Answer{"restore", hybrid::restore, Integrator::semi_implicit},
                    Answer{"restore, implicit", hybrid::restore, Integrator::implicit},
                    Answer{"blend", hybrid::blend, Integrator::semi_implicit},
                    Answer{"blend, implicit", hybrid::blend, Integrator::implicit},
                    Answer{"exact", hybrid::exact, Integrator::implicit},
                    Answer{"exact, restitution 0.4", hybrid::exact, Integrator::implicit, ContactMethod::voxmap, 0.4},
                    Answer{"exact, restitution 1", hybrid::exact, Integrator::implicit, ContactMethod::voxmap, 1},
                    Answer{"fcl", hybrid::off, Integrator::semi_implicit, ContactMethod::fcl},
                    Answer{"fcl, implicit", hybrid::off, Integrator::implicit, ContactMethod::fcl}));

TEST_P(FreeBodies, KeepTheirMomentumInPairs) {
  for (const std::uint64_t seed : seeds(by_length(2, 18, 400))) {
    SCOPED_TRACE(seed);
    Observed pair(random_pair(seed, GetParam()));
    pair.run();
    EXPECT_GT(pair.impulse(), 0) << "they never met: this seed proves nothing";
    if (HasFailure()) return;
  }
}

// Three in a row: in the middle one that, under `exact`, is answered by precise surfaces on one side and by voxels on
// the other.
TEST_P(FreeBodies, KeepTheirMomentumInARow) {
  for (const std::uint64_t seed : seeds(by_length(2, 6, 200))) {
    SCOPED_TRACE(seed);
    Inputs in(seed);
    Scene scene = scene_of(GetParam());
    scene.bodies = {body_like(0), body_like(seed), body_like(0)};
    for (std::size_t i = 0; i < 3; ++i) {
      BodyDescription& body = scene.bodies[i];
      body.name = std::to_string(i);
      const double x = static_cast<double>(i) - 1;
      body.X_WB = {{0.055 * x, in.between(-0.005, 0.005), 0.1}, in.rotation()};
      body.twist.linear = {-0.5 * x, 0.1, 0};
      body.density *= pinned::pow(10, in.between(-1, 1));
    }
    if (GetParam().hybrid == hybrid::exact) scene.bodies[2].hybrid = hybrid::restore;
    Observed row(scene);
    row.run();
    EXPECT_GT(row.impulse(), 0);
    if (HasFailure()) return;
  }
}

// A coupling that an implicit step makes as stiff as it likes takes nothing of what explicit forces may be: a light box
// that a hand of 300 N/m holds pushes another, and both go no faster than the hand and what voxels of 3 mm give back.
TEST(HeldBody, PushesAFreeOneHoweverStifflyItIsHeld) {
  for (const double density : {1e-3, 1.0, 1000.0}) {
    for (const Hybrid hybrid : {hybrid::off, hybrid::restore, hybrid::blend}) {
      SCOPED_TRACE(::testing::Message() << density << ' ' << hybrid->name());
      Scene scene = scene_of({"", hybrid, Integrator::implicit});
      scene.parameters.duration = 1;
      scene.bodies = {body_like(0), body_like(0)};
      for (BodyDescription& body : scene.bodies) body.density = density;
      scene.bodies[1].name = "other";
      scene.bodies[1].X_WB.position = {0.06, 0.001, 0.002};
      scene.devices = {scenes::hand_along({{0, 0, 0}, {0.1, 0, 0}}, 0.1)};
      scene.grasps = {{0, 0}};
      Simulation simulation(std::move(scene), {});
      double most = 0;
      while (simulation.frame() < simulation.frames_planned()) {
        const Vector3d arm = simulation.body_pose(0).position - simulation.body_pose(1).position;
        simulation.step();
        for (std::size_t i = 0; i < 2; ++i) most = std::max(most, simulation.body_twist(i).linear.norm());
        const Wrench on_held = simulation.body_force(0);
        const Wrench on_free = simulation.body_force(1);
        const double size = on_held.force.norm();
        ASSERT_LE((on_held.force + on_free.force).norm(), tolerance(kRounding * size));
        ASSERT_LE((on_held.torque + on_free.torque + arm.cross(on_held.force)).norm(),
                  tolerance(kRounding * (on_held.torque.norm() + arm.norm() * size)));
      }
      EXPECT_GT(simulation.body_pose(1).position.x(), 0.08) << "it was never pushed";
      EXPECT_LT(most, 0.5);
    }
  }
}

}  // namespace
}  // namespace verisim::momentum_test
