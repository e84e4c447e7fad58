// A hand that leans by half a degree and stands 1 mm beside the axis pushes a pin through a hole, with this project's
// exact contacts, with MuJoCo and with Bullet: same gains, same starts, same run
// (../shared/reference/peers/README.md, "Driven insertion"). Prints for each engine and clearance how deep the pin went
// into the wall at worst, the largest contact force, whether it came through, and what a step cost.
//
// The peers have the hole as 64 convex wedges whose polygon's sides touch the circle, so theirs is wider at the
// corners; depth is measured against what each was given. MuJoCo comes with its default contact, with contacts as stiff
// as a step of 1 ms allows, and with these, elliptic cones and several contacts per pair of convex shapes; Bullet in
// double precision with its default margins and with margins of a hundredth of the clearance.
#include <btBulletDynamicsCommon.h>
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>

#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"
#include "engine/base/quantile.hpp"
#include "tests/exact/driven_insertion.hpp"

namespace verisim::bench {
namespace {

using exact::test::Hand;
using exact::test::hand_at;
using exact::test::Insertion;
using exact::test::kBlockHeight;
using exact::test::kHoleRadius;
using exact::test::kPinLength;
using exact::test::Start;

constexpr int kWedges = 64;
constexpr double kStep = 0.001;
constexpr double kBlockHalf = 0.1875;

struct Motion {
  Pose X_WB;
  Vector3d v = Vector3d::Zero(), omega = Vector3d::Zero();  ///< world axes
};

Vector3d sector_normal(int i) {
  const double angle = 2 * pinned::kPi * (i + 0.5) / kWedges;
  return {std::cos(angle), std::sin(angle), 0};
}

/// The vertices of a wedge: a sector between the hole's polygon, chamfered at its upper rim, and the outer square.
std::vector<Vector3d> wedge(int sector, double chamfer) {
  std::vector<Vector3d> vertices;
  for (const int k : {sector, sector + 1}) {
    const double angle = 2 * pinned::kPi * k / kWedges;
    const Vector3d d(std::cos(angle), std::sin(angle), 0);
    const double corner = 1 / std::cos(pinned::kPi / kWedges);
    const double half = kBlockHeight / 2;
    const Vector3d outer = kBlockHalf / d.cwiseAbs().maxCoeff() * d;
    vertices.push_back(kHoleRadius * corner * d - half * Vector3d::UnitZ());
    vertices.push_back(kHoleRadius * corner * d + (half - chamfer) * Vector3d::UnitZ());
    if (chamfer > 0) vertices.push_back((kHoleRadius + chamfer) * corner * d + half * Vector3d::UnitZ());
    vertices.push_back(outer - half * Vector3d::UnitZ());
    vertices.push_back(outer + half * Vector3d::UnitZ());
  }
  return vertices;
}

/// Shortest distance between the line through `p` along the unit vector `a` and the segment from s to t.
double line_to_segment(const Vector3d& p, const Vector3d& a, const Vector3d& s, const Vector3d& t) {
  const auto off_line = [&](const Vector3d& q) { return Vector3d(q - p - a.dot(q - p) * a); };
  const Vector3d from = off_line(s);
  const Vector3d way = off_line(t) - from;
  const double fraction = way.squaredNorm() > 0 ? std::clamp(-from.dot(way) / way.squaredNorm(), 0.0, 1.0) : 0.0;
  return (from + fraction * way).norm();
}

/// Deepest overlap of the pin's side with the round hole below its chamfer [m], in closed form at many angles: the
/// pin's end circles against the wall, the wall's end circles against the pin's side.
double overlap_with_circle(const Pose& X, double radius, double chamfer) {
  constexpr int kAngles = 720;
  const Matrix3d R = X.rotation.toRotationMatrix();
  const double top = kBlockHeight / 2 - chamfer;
  double deepest = 0;
  for (int i = 0; i < kAngles; ++i) {
    const double angle = 2 * pinned::kPi * i / kAngles;
    const Vector3d ring(std::cos(angle), std::sin(angle), 0);
    for (const double end : {-0.5, 0.5}) {
      const Vector3d p = X.position + R * (radius * ring + Vector3d(0, 0, end * kPinLength));
      if (p.z() >= -kBlockHeight / 2 && p.z() <= top) deepest = std::max(deepest, p.head<2>().norm() - kHoleRadius);
    }
    for (const double z : {-kBlockHeight / 2, top}) {
      const Vector3d q = kHoleRadius * ring + Vector3d(0, 0, z) - X.position;
      const double along = R.col(2).dot(q);
      if (std::abs(along) <= kPinLength / 2) deepest = std::max(deepest, radius - (q - along * R.col(2)).norm());
    }
  }
  return deepest;
}

/// Deepest overlap of the pin's side with the wedges' inner faces [m], in closed form: the pin's end circles against
/// the faces, the faces' lower and upper edges against the pin's side.
double overlap_with_polygon(const Pose& X, double radius, double chamfer) {
  const Vector3d a = X.rotation * Vector3d::UnitZ();
  const double corner = kHoleRadius / std::cos(pinned::kPi / kWedges);
  double deepest = 0;
  for (int i = 0; i < kWedges; ++i) {
    const Vector3d n = sector_normal(i);
    const Vector3d across = n - n.dot(a) * a;
    for (const double end : {-0.5, 0.5}) {
      const Vector3d p = X.position + end * kPinLength * a + radius * across.normalized();
      if (p.z() < kBlockHeight / 2 - chamfer && p.z() > -kBlockHeight / 2)
        deepest = std::max(deepest, n.dot(p) - kHoleRadius);
    }
    for (const double z : {-kBlockHeight / 2, kBlockHeight / 2 - chamfer}) {
      const double from = 2 * pinned::kPi * i / kWedges, to = 2 * pinned::kPi * (i + 1) / kWedges;
      const Vector3d s(corner * std::cos(from), corner * std::sin(from), z);
      const Vector3d t(corner * std::cos(to), corner * std::sin(to), z);
      if (std::abs(a.dot(0.5 * (s + t) - X.position)) < kPinLength / 2)
        deepest = std::max(deepest, radius - line_to_segment(X.position, a, s, t));
    }
  }
  return deepest;
}

/// The pull of the hand on a peer's pin: the coupling of held_pin.hpp, evaluated at the step's start.
struct Coupling {
  double radius;
  [[nodiscard]] Vector3d inertia() const { return exact::test::HeldPin::inertia(radius); }
  [[nodiscard]] Wrench pull(const Hand& hand, const Motion& m) const {
    const auto limited = [](const Vector3d& w, double most) {
      return Vector3d(w.norm() > most ? w * (most / w.norm()) : w);
    };
    const Matrix3d R = m.X_WB.rotation.toRotationMatrix();
    const Matrix3d B = R * Matrix3d((2 * (50 * inertia()).cwiseSqrt()).asDiagonal()) * R.transpose();
    const Vector3d force = 5000 * (hand.position - m.X_WB.position) + 2 * std::sqrt(5000.0) * (hand.velocity - m.v);
    const Vector3d torque = 50 * vector_from_rotation(hand.rotation * m.X_WB.rotation.conjugate()) - B * m.omega;
    return {limited(force, 100), limited(torque, 5)};
  }
};

/// Contact parameters, friction cone, and whether convex shapes may touch at several points.
struct MuJoCoOptions {
  const char* contact = "";
  bool elliptic = false;
};

class MuJoCo {
 public:
  MuJoCo(const Insertion& task, const MuJoCoOptions& options, const Pose& start)
      : coupling_{kHoleRadius - task.clearance} {
    const std::string xml = scene(task, options);
    auto files = std::make_unique<mjVFS>();  // 1 MB of tables: not on the stack
    mj_defaultVFS(files.get());
    mj_makeEmptyFileVFS(files.get(), "pin.xml", static_cast<int>(xml.size()));
    std::memcpy(files->filedata[0], xml.data(), xml.size());
    char reason[1000] = "";
    model_.reset(mj_loadXML("pin.xml", files.get(), reason, sizeof reason));
    mj_deleteVFS(files.get());
    if (!model_) fail(ErrorKind::input, "MuJoCo refuses the scene: {}", reason);
    data_.reset(mj_makeData(model_.get()));
    const Quaterniond& q = start.rotation;
    const double values[7] = {start.position.x(), start.position.y(), start.position.z(), q.w(), q.x(), q.y(), q.z()};
    std::copy(values, values + 7, data_->qpos);
  }
  [[nodiscard]] Motion motion() const {
    const double *q = data_->qpos, *v = data_->qvel;
    Motion m{{{q[0], q[1], q[2]}, Quaterniond(q[3], q[4], q[5], q[6])}};
    m.v = {v[0], v[1], v[2]};
    m.omega = m.X_WB.rotation * Vector3d(v[3], v[4], v[5]);
    return m;
  }
  Vector3d step(const Hand& hand) {
    const Wrench w = coupling_.pull(hand, motion());
    double* applied = data_->xfrc_applied + 6;  // of the first body after the world
    for (int i = 0; i < 3; ++i) applied[i] = w.force[i], applied[3 + i] = w.torque[i];
    mj_step(model_.get(), data_.get());
    return w.force;
  }

 private:
  [[nodiscard]] std::string scene(const Insertion& task, const MuJoCoOptions& options) const {
    std::string meshes, geoms;
    for (int i = 0; i < kWedges; ++i) {
      std::string vertices;
      for (const Vector3d& p : wedge(i, task.chamfer))
        vertices += fmt::format("{:.17g} {:.17g} {:.17g} ", p.x(), p.y(), p.z());
      meshes += fmt::format("<mesh name='w{}' vertex='{}'/>", i, vertices);
      geoms += fmt::format("<geom type='mesh' mesh='w{}' contype='1' conaffinity='2'/>", i);
    }
    const Vector3d I = coupling_.inertia();
    return fmt::format(
        "<mujoco><size nconmax='2000' njmax='8000'/><option timestep='{}' gravity='0 0 0' cone='{}' iterations='200' "
        "tolerance='1e-12'><flag multiccd='{}'/></option><default><geom condim='1' margin='0.0005' "
        "gap='0'{}/></default>"
        "<asset>{}</asset><worldbody><body><freejoint/><inertial pos='0 0 0' mass='1' diaginertia='{} {} {}'/>"
        "<geom type='cylinder' size='{:.17g} {:.17g}' contype='2' conaffinity='1'/></body>{}</worldbody></mujoco>",
        kStep, options.elliptic ? "elliptic" : "pyramidal", options.elliptic ? "enable" : "disable", options.contact,
        meshes, I.x(), I.y(), I.z(), coupling_.radius, kPinLength / 2, geoms);
  }
  Coupling coupling_;
  std::unique_ptr<mjModel, decltype(&mj_deleteModel)> model_{nullptr, &mj_deleteModel};
  std::unique_ptr<mjData, decltype(&mj_deleteData)> data_{nullptr, &mj_deleteData};
};

class Bullet {
 public:
  Bullet(const Insertion& task, std::optional<double> margin, const Pose& start)
      : coupling_{kHoleRadius - task.clearance},
        pin_shape_(btVector3(coupling_.radius, coupling_.radius, kPinLength / 2)) {
    for (int i = 0; i < kWedges; ++i) {
      hulls_.push_back(std::make_unique<btConvexHullShape>());
      for (const Vector3d& p : wedge(i, task.chamfer)) hulls_.back()->addPoint(of(p));
      if (margin) hulls_.back()->setMargin(*margin);
      block_shape_.addChildShape(btTransform::getIdentity(), hulls_.back().get());
    }
    if (margin) pin_shape_.setMargin(*margin), block_shape_.setMargin(*margin);
    world_.setGravity(btVector3(0, 0, 0));
    world_.getSolverInfo().m_numIterations = 200;
    world_.getSolverInfo().m_splitImpulse = 1;
    block_ = std::make_unique<btRigidBody>(0, nullptr, &block_shape_);
    pin_ = std::make_unique<btRigidBody>(1, nullptr, &pin_shape_, of(coupling_.inertia()));
    for (btRigidBody* body : {block_.get(), pin_.get()}) body->setFriction(0), world_.addRigidBody(body);
    pin_->setActivationState(DISABLE_DEACTIVATION);
    const Quaterniond& q = start.rotation;
    pin_->setWorldTransform(btTransform(btQuaternion(q.x(), q.y(), q.z(), q.w()), of(start.position)));
  }
  ~Bullet() {
    for (btRigidBody* body : {block_.get(), pin_.get()}) world_.removeRigidBody(body);
  }
  [[nodiscard]] Motion motion() const {
    const btTransform& X = pin_->getWorldTransform();
    const btQuaternion q = X.getRotation();
    return {{of(X.getOrigin()), Quaterniond(q.w(), q.x(), q.y(), q.z())},
            of(pin_->getLinearVelocity()),
            of(pin_->getAngularVelocity())};
  }
  Vector3d step(const Hand& hand) {
    const Wrench w = coupling_.pull(hand, motion());
    pin_->applyCentralForce(of(w.force));
    pin_->applyTorque(of(w.torque));
    world_.stepSimulation(kStep, 0);
    pin_->clearForces();
    return w.force;
  }

 private:
  static btVector3 of(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }
  static Vector3d of(const btVector3& v) { return {v.x(), v.y(), v.z()}; }
  Coupling coupling_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broad_phase_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_{&dispatcher_, &broad_phase_, &solver_, &configuration_};
  std::vector<std::unique_ptr<btConvexHullShape>> hulls_;
  btCompoundShape block_shape_;
  btCylinderShapeZ pin_shape_;
  std::unique_ptr<btRigidBody> block_, pin_;
};

struct Outcome {
  double bottom = 0, overlap = 0, force = 0;  ///< m, m, N
  std::vector<double> step_us;
  void enter(double us, double depth, double push) {
    step_us.push_back(us);
    overlap = std::max(overlap, depth);
    force = std::max(force, push);
  }
};

double bottom_of(const Pose& X) {
  return (X.position - 0.5 * kPinLength * (X.rotation * Vector3d::UnitZ())).z();
}

template <typename Step>
double timed_us(const Step& step) {
  const auto start = std::chrono::steady_clock::now();
  step();
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
}

Outcome run_here(const Insertion& task) {
  exact::test::HeldPin pin = exact::test::pin_for(task);
  Outcome outcome;
  for (int i = 0; i < exact::test::steps_of(task); ++i) {
    const Hand hand = hand_at(task, i * kStep);
    const double us = timed_us([&] { pin.step(hand); });
    outcome.enter(us, overlap_with_circle(pin.X_WB, pin.radius, task.chamfer), pin.contact_force.norm());
  }
  outcome.bottom = bottom_of(pin.X_WB);
  return outcome;
}

template <typename Peer>
Outcome run_peer(const Insertion& task, Peer& peer) {
  Outcome outcome;
  for (int i = 0; i < exact::test::steps_of(task); ++i) {
    const Hand hand = hand_at(task, i * kStep);
    const Vector3d before = peer.motion().v;
    Vector3d pull;
    const double us = timed_us([&] { pull = peer.step(hand); });
    const Motion now = peer.motion();
    outcome.enter(us, overlap_with_polygon(now.X_WB, kHoleRadius - task.clearance, task.chamfer),
                  ((now.v - before) / kStep - pull).norm());
  }
  outcome.bottom = bottom_of(peer.motion().X_WB);
  return outcome;
}

void print(const char* name, const Insertion& task, Outcome outcome) {
  std::printf("%-38s %8.2f  %-7s %10.4f %12.3f %12.1f %9.1f %9.1f\n", name, 1e3 * task.clearance,
              outcome.bottom < -kBlockHeight / 2 ? "passes" : "stays", 1e3 * outcome.overlap,
              outcome.overlap / task.clearance, outcome.force, quantile(outcome.step_us, 0.5),
              quantile(outcome.step_us, 0.99));
  std::fflush(stdout);
}

void run_all(const Insertion& task) {
  const Hand hand = hand_at(task, 0);
  const Pose start{hand.position, hand.rotation};
  print("verisim, exact", task, run_here(task));
  constexpr std::pair<const char*, MuJoCoOptions> kMuJoCo[] = {
      {"MuJoCo, default contact", {}},
      {"MuJoCo, short time constant", {"solref='0.004 1' solimp='0.95 0.99 0.001'"}},
      {"MuJoCo, hard, elliptic, multiccd", {"solimp='0.99 0.9999 0.001'", true}}};
  for (const auto& [name, options] : kMuJoCo) {
    MuJoCo peer(task, options, start);
    print(name, task, run_peer(task, peer));
  }
  {
    Bullet peer(task, {}, start);
    print("Bullet, default margins", task, run_peer(task, peer));
  }
  Bullet peer(task, 0.01 * task.clearance, start);
  print("Bullet, margins 0.01 of the clearance", task, run_peer(task, peer));
}

}  // namespace
}  // namespace verisim::bench

int main() {
  using namespace verisim::bench;
  using verisim::exact::test::Start;
  for (const auto& [title, start, chamfer] : {std::tuple("engaged by 10 mm, sharp rim", Start::engaged_10mm, 0.0),
                                              std::tuple("from above, chamfer of 2 mm", Start::above, 0.002)}) {
    std::printf("%s; no friction\n%-38s %8s  %-7s %10s %12s %12s %9s %9s\n", title, "", "gap mm", "", "deepest mm",
                "of the gap", "force max N", "us median", "us 99 %");
    for (const double clearance : {1e-3, 1e-4, 2e-5, 1e-5})
      run_all({.clearance = clearance, .start = start, .chamfer = chamfer});
  }
  return 0;
}
