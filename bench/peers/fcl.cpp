// FCL: contacts of a mesh of the block, or of wedges, with its own cylinder. It has no dynamics: each contact pushes
// with a spring and a damper, and the step is semi-implicit, as a user of it would begin.
#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/broadphase/default_broadphase_callbacks.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/narrowphase/collision.h>
#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "bench/peers/peer.hpp"

namespace verisim::peers {
namespace {

using Tree = fcl::BVHModel<fcl::OBBRSSd>;

void fill(Tree& tree, const Mesh& mesh) {
  std::vector<fcl::Triangle> triangles;
  for (const auto& [a, b, c] : mesh.triangles)
    triangles.emplace_back(static_cast<std::size_t>(a), static_cast<std::size_t>(b), static_cast<std::size_t>(c));
  tree.beginModel();
  tree.addSubModel(mesh.vertices, triangles);
  tree.endModel();
}

fcl::CollisionRequestd all_contacts() {
  fcl::CollisionRequestd request;
  request.num_max_contacts = 10000;
  request.enable_contact = true;
  return request;
}

fcl::Transform3d of(const Pose& X_WB) {
  fcl::Transform3d X = fcl::Transform3d::Identity();
  X.linear() = X_WB.rotation.toRotationMatrix();
  X.translation() = X_WB.position;
  return X;
}

double deepest_of(const fcl::CollisionResultd& result) {
  double deepest = kNothing;
  for (std::size_t i = 0; i < result.numContacts(); ++i)
    deepest = std::max(deepest, result.getContact(i).penetration_depth);
  return deepest;
}

struct FclOptions {
  double stiffness = 1e5;  ///< N/m, of all contacts together
  double damping = 0.5;    ///< of critical
};

/// The mesh.
class FclMesh final : public Pusher, public Finder {
 public:
  FclMesh(const Insertion& task, const FclOptions& options, int sides, const Pose& start)
      : coupling_{kHoleRadius - task.clearance}, options_(options), pin_(coupling_.radius, kPinLength) {
    fill(block_, block_mesh(task.chamfer, sides));
    place(start);
  }
  [[nodiscard]] Motion motion() const override { return motion_; }
  void place(const Pose& X) override { motion_.X_WB = X; }
  double query() override {
    result_.clear();
    fcl::collide(&block_, fcl::Transform3d::Identity(), &pin_, of(motion_.X_WB), request_, result_);
    return deepest_of(result_);
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
  Tree block_;
  fcl::Cylinderd pin_;
  fcl::CollisionRequestd request_ = all_contacts();
  fcl::CollisionResultd result_;
  Motion motion_;
};

/// The wedges in FCL's tree of boxes; depths by libccd (MPR) or by FCL's own GJK and EPA.
class FclWedges final : public Finder {
 public:
  FclWedges(double clearance, int wedges, bool libccd)
      : pin_(std::make_shared<fcl::Cylinderd>(kHoleRadius - clearance, kPinLength)) {
    data_.request = all_contacts();
    data_.request.gjk_solver_type = libccd ? fcl::GST_LIBCCD : fcl::GST_INDEP;
    // Two loops of four vertices and four sides, counter-clockwise from outside.
    const auto faces = std::make_shared<const std::vector<int>>(
        std::vector<int>{4, 0, 3, 2, 1, 4, 4, 5, 6, 7, 4, 0, 1, 5, 4, 4, 1, 2, 6, 5, 4, 2, 3, 7, 6, 4, 3, 0, 4, 7});
    for (int i = 0; i < wedges; ++i) {
      const auto vertices = std::make_shared<const std::vector<fcl::Vector3d>>(wedge(i, {.wedges = wedges}));
      pieces_.push_back(std::make_unique<fcl::CollisionObjectd>(std::make_shared<fcl::Convexd>(vertices, 6, faces)));
      tree_.registerObject(pieces_.back().get());
    }
    tree_.setup();
  }
  void place(const Pose& X) override {
    pin_.setTransform(of(X));
    pin_.computeAABB();
  }
  double query() override {
    data_.result.clear();
    data_.done = false;
    tree_.collide(&pin_, &data_, fcl::DefaultCollisionFunction<double>);
    return deepest_of(data_.result);
  }

 private:
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> pieces_;
  fcl::DynamicAABBTreeCollisionManagerd tree_;
  fcl::CollisionObjectd pin_;
  fcl::DefaultCollisionData<double> data_;
};

}  // namespace

Engine peer_fcl() {
  Engine engine{.name = "FCL", .version = FCL_VERSION, .package = "libfcl-dev"};
  for (const double stiffness : {1e4, 1e5, 4e5})
    for (const double damping : {0.1, 0.5}) {
      const FclOptions options{stiffness, damping};
      engine.pushes.push_back({.text = fmt::format("{:g} N/m, {} of critical damping", stiffness, damping),
                               .make = [options](const Insertion& task, const Pose& start) -> std::unique_ptr<Pusher> {
                                 return std::make_unique<FclMesh>(task, options, kWedges, start);
                               }});
    }
  for (const int sides : {64, 256}) {
    engine.finds.push_back({.text = fmt::format("mesh of {} sides, OBBRSS", sides),
                            .make = [sides](double clearance) -> std::unique_ptr<Finder> {
                              return std::make_unique<FclMesh>(Insertion{.clearance = clearance}, FclOptions(), sides,
                                                               Pose());
                            }});
    for (const bool libccd : {true, false})
      engine.finds.push_back({.text = fmt::format("{} wedges, {}", sides, libccd ? "libccd" : "FCL's own GJK"),
                              .make = [sides, libccd](double clearance) -> std::unique_ptr<Finder> {
                                return std::make_unique<FclWedges>(clearance, sides, libccd);
                              }});
  }
  return engine;
}

}  // namespace verisim::peers
