// Bullet in double precision: 64 convex wedges and its own cylinder.
#include <btBulletDynamicsCommon.h>
#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "bench/peers/peer.hpp"

namespace verisim::peers {
namespace {

struct BulletOptions {
  double margin_of_clearance = 0;  ///< 0: Bullet's own margins
  int iterations = 200;
  double erp = 0.2;
};

class Bullet final : public Peer {
 public:
  Bullet(const Insertion& task, const BulletOptions& options, const Pose& start)
      : coupling_{kHoleRadius - task.clearance},
        pin_shape_(btVector3(coupling_.radius, coupling_.radius, kPinLength / 2)) {
    const double margin = options.margin_of_clearance * task.clearance;
    for (int i = 0; i < kWedges; ++i) {
      hulls_.push_back(std::make_unique<btConvexHullShape>());
      for (const Vector3d& p : wedge(i, task.chamfer)) hulls_.back()->addPoint(of(p));
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
    place(start);
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
  void place(const Pose& X) override {
    const Quaterniond& q = X.rotation;
    pin_->setWorldTransform(btTransform(btQuaternion(q.x(), q.y(), q.z(), q.w()), of(X.position)));
  }
  double query() override {
    world_.performDiscreteCollisionDetection();
    double nearest = 1;
    for (int i = 0; i < dispatcher_.getNumManifolds(); ++i) {
      const btPersistentManifold& manifold = *dispatcher_.getManifoldByIndexInternal(i);
      for (int k = 0; k < manifold.getNumContacts(); ++k)
        nearest = std::min(nearest, static_cast<double>(manifold.getContactPoint(k).getDistance()));
    }
    return -nearest;
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

std::vector<Setting> settings_of_bullet() {
  std::vector<Setting> settings;
  for (const double margin : {0.0, 0.1, 0.01})
    for (const int iterations : {10, 200})
      for (const double erp : {0.2, 0.8}) {
        const BulletOptions options{margin, iterations, erp};
        settings.push_back(
            {.engine = "Bullet",
             .text = fmt::format("margins {}, {} iterations, erp2 {}",
                                 margin > 0 ? fmt::format("{} of the clearance", margin) : "default", iterations, erp),
             .make = [options](const Insertion& task, const Pose& start) -> std::unique_ptr<Peer> {
               return std::make_unique<Bullet>(task, options, start);
             }});
      }
  return settings;
}

}  // namespace verisim::peers
