// FCL: contacts of a mesh of the block with its own cylinder. It has no dynamics: each contact pushes with a spring and
// a damper, and the step is semi-implicit, as a user of it would begin.
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/collision.h>
#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "bench/peers/peer.hpp"

namespace verisim::peers {
namespace {

struct FclOptions {
  double stiffness = 1e5;  ///< N/m, of all contacts together
  double damping = 0.5;    ///< of critical
};

class Fcl final : public Peer {
 public:
  Fcl(const Insertion& task, const FclOptions& options, const Pose& start)
      : coupling_{kHoleRadius - task.clearance}, options_(options), pin_(coupling_.radius, kPinLength) {
    const Mesh mesh = block_mesh(task.chamfer);
    std::vector<fcl::Triangle> triangles;
    for (const auto& [a, b, c] : mesh.triangles)
      triangles.emplace_back(static_cast<std::size_t>(a), static_cast<std::size_t>(b), static_cast<std::size_t>(c));
    block_.beginModel();
    block_.addSubModel(mesh.vertices, triangles);
    block_.endModel();
    request_.num_max_contacts = 10000;
    request_.enable_contact = true;
    place(start);
  }
  [[nodiscard]] Motion motion() const override { return motion_; }
  void place(const Pose& X) override { motion_.X_WB = X; }
  double query() override {
    fcl::Transform3d X = fcl::Transform3d::Identity();
    X.linear() = motion_.X_WB.rotation.toRotationMatrix();
    X.translation() = motion_.X_WB.position;
    result_.clear();
    fcl::collide(&block_, fcl::Transform3d::Identity(), &pin_, X, request_, result_);
    double deepest = -1;
    for (std::size_t i = 0; i < result_.numContacts(); ++i)
      deepest = std::max(deepest, result_.getContact(i).penetration_depth);
    return deepest;
  }
  Vector3d step(const Hand& hand) override {
    const Wrench pull = coupling_.pull(hand, motion_);
    Vector3d force = pull.force, torque = pull.torque;
    query();
    const double each = 1.0 / std::max<double>(1, static_cast<double>(result_.numContacts()));
    const double damping = options_.damping * 2 * std::sqrt(options_.stiffness);  // of 1 kg
    for (std::size_t i = 0; i < result_.numContacts(); ++i) {
      const fcl::Contactd& contact = result_.getContact(i);
      const Vector3d arm = contact.pos - motion_.X_WB.position;
      const double approach = -contact.normal.dot(motion_.v + motion_.omega.cross(arm));
      const double push = std::max(0.0, options_.stiffness * contact.penetration_depth + damping * approach);
      force += each * push * contact.normal;  // from the block to the pin
      torque += arm.cross(each * push * contact.normal);
    }
    const Matrix3d R = motion_.X_WB.rotation.toRotationMatrix();
    const Matrix3d I = R * coupling_.inertia().asDiagonal() * R.transpose();
    motion_.v += kStep * force;
    motion_.omega += kStep * I.inverse() * (torque - motion_.omega.cross(I * motion_.omega));
    motion_.X_WB.position += kStep * motion_.v;
    motion_.X_WB.rotation = (rotation_from_vector(kStep * motion_.omega) * motion_.X_WB.rotation).normalized();
    return pull.force;
  }

 private:
  Coupling coupling_;
  FclOptions options_;
  fcl::BVHModel<fcl::OBBRSSd> block_;
  fcl::Cylinderd pin_;
  fcl::CollisionRequestd request_;
  fcl::CollisionResultd result_;
  Motion motion_;
};

}  // namespace

std::vector<Setting> settings_of_fcl() {
  std::vector<Setting> settings;
  for (const double stiffness : {1e4, 1e5, 4e5})
    for (const double damping : {0.1, 0.5}) {
      const FclOptions options{stiffness, damping};
      settings.push_back({.engine = "FCL",
                          .text = fmt::format("{:g} N/m, {} of critical damping", stiffness, damping),
                          .make = [options](const Insertion& task, const Pose& start) -> std::unique_ptr<Peer> {
                            return std::make_unique<Fcl>(task, options, start);
                          }});
    }
  return settings;
}

}  // namespace verisim::peers
