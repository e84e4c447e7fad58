// Bullet in double precision: 64 convex wedges and its own cylinder.
#include <btBulletDynamicsCommon.h>
#include <fmt/format.h>

#include <memory>
#include <string>

#include "bench/peers/peer.hpp"

namespace verisim::peers {
namespace {

struct BulletOptions {
  double margin_of_clearance = 0;  ///< 0: Bullet's own margins
  double drawn_in = 0;             ///< m: this margin instead, around wedges that are drawn in by it
  int iterations = 200;
  double erp = 0.2;
};

class Bullet final : public Pusher {
 public:
  Bullet(const Insertion& task, const BulletOptions& options, const Pose& start)
      : coupling_{kHoleRadius - task.clearance},
        pin_shape_(btVector3(coupling_.radius, coupling_.radius, kPinLength / 2)) {
    const double margin = options.drawn_in > 0 ? options.drawn_in : options.margin_of_clearance * task.clearance;
    for (int i = 0; i < kWedges; ++i) {
      hulls_.push_back(std::make_unique<btConvexHullShape>());
      for (const Vector3d& p : wedge(i, {.chamfer = task.chamfer, .drawn_in = options.drawn_in}))
        hulls_.back()->addPoint(of(p));
      if (margin > 0) hulls_.back()->setMargin(margin);
      block_shape_.addChildShape(btTransform::getIdentity(), hulls_.back().get());
    }
    if (margin > 0) pin_shape_.setMargin(margin), block_shape_.setMargin(margin);
    world_.setGravity(btVector3(0, 0, 0));
    world_.getSolverInfo().m_numIterations = options.iterations;
    world_.getSolverInfo().m_splitImpulse = 1;
    world_.getSolverInfo().m_erp2 = options.erp;
    block_ = std::make_unique<btRigidBody>(0, nullptr, &block_shape_);
    pin_ = std::make_unique<btRigidBody>(1, nullptr, &pin_shape_, of(coupling_.inertia()));
    for (btRigidBody* body : {block_.get(), pin_.get()}) body->setFriction(0), world_.addRigidBody(body);
    pin_->setActivationState(DISABLE_DEACTIVATION);
    const Quaterniond& q = start.rotation;
    pin_->setWorldTransform(btTransform(btQuaternion(q.x(), q.y(), q.z(), q.w()), of(start.position)));
  }
  ~Bullet() override {
    for (btRigidBody* body : {block_.get(), pin_.get()}) world_.removeRigidBody(body);
  }
  [[nodiscard]] Motion motion() const override {
    const btTransform& X = pin_->getWorldTransform();
    const btQuaternion q = X.getRotation();
    return {{of(X.getOrigin()), Quaterniond(q.w(), q.x(), q.y(), q.z())},
            of(pin_->getLinearVelocity()),
            of(pin_->getAngularVelocity())};
  }
  Vector3d step(const Hand& hand) override {
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

}  // namespace

Engine peer_bullet() {
  const int version = btGetVersion();  // 324: 3.24
  Engine engine{.name = "Bullet",
                .version = fmt::format("{}.{}", version / 100, version % 100),
                .package = "libbullet-dev",
                .pushes = {},
                .finds = bullet_finds()};
  struct Margin {
    std::string text;
    double of_clearance, drawn_in;
  };
  for (const Margin& margin : {Margin{"default margins", 0, 0}, Margin{"margins 0.1 of the clearance", 0.1, 0},
                               Margin{"margins 0.01 of the clearance", 0.01, 0},
                               Margin{"margins 1 mm, drawn in", 0, 1e-3}, Margin{"margins 0.1 mm, drawn in", 0, 1e-4}})
    for (const int iterations : {10, 200})
      for (const double erp : {0.2, 0.8}) {
        const BulletOptions options{margin.of_clearance, margin.drawn_in, iterations, erp};
        engine.pushes.push_back(
            {.text = fmt::format("{}, {} iterations, erp2 {}", margin.text, iterations, erp),
             .make = [options](const Insertion& task, const Pose& start) -> std::unique_ptr<Pusher> {
               return std::make_unique<Bullet>(task, options, start);
             }});
      }
  return engine;
}

}  // namespace verisim::peers
