// Bullet's contact queries at their own best. A world's step keeps contacts from pose to pose, which helps what moves
// on and misleads what is put elsewhere: here every pose is asked afresh.
//
// What its users can choose: how finely the hole is cut; whether it is cut at all; who walks over the pieces; how depth
// is found where cores overlap; and margins. A hull's margin lies around it: the hull may be drawn in by it, so that
// its faces are where they belong and its edges are rounded. A cylinder's margin is within it.
#include <BulletCollision/NarrowPhaseCollision/btGjkEpaPenetrationDepthSolver.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkPairDetector.h>
#include <BulletCollision/NarrowPhaseCollision/btMinkowskiPenetrationDepthSolver.h>
#include <BulletCollision/NarrowPhaseCollision/btPointCollector.h>
#include <BulletCollision/NarrowPhaseCollision/btVoronoiSimplexSolver.h>
#include <btBulletDynamicsCommon.h>
#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "bench/peers/peer.hpp"

namespace verisim::peers {
namespace {

btVector3 of(const Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}
btTransform of(const Pose& X) {
  const Quaterniond& q = X.rotation;
  return btTransform(btQuaternion(q.x(), q.y(), q.z(), q.w()), of(X.position));
}

struct Margins {
  double margin = 0;  ///< m; below 0: Bullet's own
  bool drawn_in = false;
  [[nodiscard]] std::string text() const {
    if (margin < 0) return "default margins";
    return fmt::format("margins {:g} mm{}", 1e3 * margin, drawn_in ? ", drawn in" : "");
  }
};

std::vector<std::unique_ptr<btConvexHullShape>> hulls_of(int wedges, const Margins& margins) {
  std::vector<std::unique_ptr<btConvexHullShape>> hulls;
  for (int i = 0; i < wedges; ++i) {
    hulls.push_back(std::make_unique<btConvexHullShape>());
    for (const Vector3d& p : wedge(i, {.wedges = wedges, .drawn_in = margins.drawn_in ? margins.margin : 0}))
      hulls.back()->addPoint(of(p));
    if (margins.margin >= 0) hulls.back()->setMargin(margins.margin);
  }
  return hulls;
}

btCylinderShapeZ pin_of(double clearance, const Margins& margins) {
  const double radius = kHoleRadius - clearance;
  btCylinderShapeZ pin(btVector3(radius, radius, kPinLength / 2));
  if (margins.margin >= 0) pin.setMargin(margins.margin);
  return pin;
}

/// The nearest pair of points of two convex shapes, wedge by wedge where boxes overlap, by btGjkPairDetector.
class Pairs final : public Finder {
 public:
  Pairs(double clearance, int wedges, const Margins& margins, bool epa)
      : hulls_(hulls_of(wedges, margins)), pin_(pin_of(clearance, margins)) {
    if (epa)
      depth_ = std::make_unique<btGjkEpaPenetrationDepthSolver>();
    else
      depth_ = std::make_unique<btMinkowskiPenetrationDepthSolver>();
    boxes_.resize(hulls_.size());
    for (std::size_t i = 0; i < hulls_.size(); ++i)
      hulls_[i]->getAabb(btTransform::getIdentity(), boxes_[i].first, boxes_[i].second);
  }
  void place(const Pose& X) override { pin_at_ = of(X); }
  double query() override {
    btVector3 low, high;
    pin_.getAabb(pin_at_, low, high);
    double nearest = -kNothing;
    for (std::size_t i = 0; i < hulls_.size(); ++i) {
      if (!TestAabbAgainstAabb2(low, high, boxes_[i].first, boxes_[i].second)) continue;
      btVoronoiSimplexSolver simplex;
      btGjkPairDetector detector(hulls_[i].get(), &pin_, &simplex, depth_.get());
      btGjkPairDetector::ClosestPointInput input;
      input.m_transformA = btTransform::getIdentity();
      input.m_transformB = pin_at_;
      btPointCollector found;
      detector.getClosestPoints(input, found, nullptr);
      if (found.m_hasResult) nearest = std::min(nearest, static_cast<double>(found.m_distance));
    }
    return -nearest;
  }

 private:
  std::vector<std::unique_ptr<btConvexHullShape>> hulls_;
  btCylinderShapeZ pin_;
  std::unique_ptr<btConvexPenetrationDepthSolver> depth_;
  std::vector<std::pair<btVector3, btVector3>> boxes_;
  btTransform pin_at_;
};

/// btCollisionWorld::contactPairTest on the block as a compound of wedges, or as a mesh with Bullet's tree. (It treats
/// GImpact's meshes as it treats those.)
class PairTest final : public Finder {
 public:
  PairTest(double clearance, bool as_mesh, int sides, const Margins& margins) : pin_shape_(pin_of(clearance, margins)) {
    if (as_mesh) {
      const Mesh mesh = block_mesh(0, sides);
      const auto corner = [&](int i) { return of(mesh.vertices[static_cast<std::size_t>(i)]); };
      for (const auto& [a, b, c] : mesh.triangles) triangles_.addTriangle(corner(a), corner(b), corner(c));
      block_shape_ = std::make_unique<btBvhTriangleMeshShape>(&triangles_, true);
    } else {
      hulls_ = hulls_of(sides, margins);
      auto compound = std::make_unique<btCompoundShape>();
      for (const auto& hull : hulls_) compound->addChildShape(btTransform::getIdentity(), hull.get());
      block_shape_ = std::move(compound);
    }
    if (margins.margin >= 0) block_shape_->setMargin(margins.margin);
    block_.setCollisionShape(block_shape_.get());
    pin_.setCollisionShape(&pin_shape_);
  }
  void place(const Pose& X) override { pin_.setWorldTransform(of(X)); }
  double query() override {
    Deepest deepest;
    world_.contactPairTest(&block_, &pin_, deepest);
    return -deepest.nearest;
  }

 private:
  struct Deepest final : btCollisionWorld::ContactResultCallback {
    double nearest = -kNothing;
    btScalar addSingleResult(btManifoldPoint& point, const btCollisionObjectWrapper* /*a*/, int /*part_a*/,
                             int /*index_a*/, const btCollisionObjectWrapper* /*b*/, int /*part_b*/,
                             int /*index_b*/) override {
      nearest = std::min(nearest, static_cast<double>(point.getDistance()));
      return 0;
    }
  };
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broad_phase_;
  btCollisionWorld world_{&dispatcher_, &broad_phase_, &configuration_};
  std::vector<std::unique_ptr<btConvexHullShape>> hulls_;
  btTriangleMesh triangles_;
  std::unique_ptr<btCollisionShape> block_shape_;
  btCylinderShapeZ pin_shape_;
  btCollisionObject block_, pin_;
};

}  // namespace

std::vector<FindSetting> bullet_finds() {
  std::vector<FindSetting> finds;
  const std::vector<Margins> around = {{-1, false},  {0, false},   {1e-5, false}, {1e-4, false},
                                       {1e-4, true}, {1e-3, true}, {3e-3, true}};
  for (const int sides : {64, 256})
    for (const Margins& margins : {Margins{-1, false}, Margins{0, false}, Margins{1e-4, false}})
      finds.push_back({.text = fmt::format("mesh of {} sides, {}, contactPairTest", sides, margins.text()),
                       .make = [sides, margins](double clearance) -> std::unique_ptr<Finder> {
                         return std::make_unique<PairTest>(clearance, true, sides, margins);
                       }});
  for (const int wedges : {64, 256})
    for (const Margins& margins : around) {
      for (const bool epa : {false, true})
        finds.push_back({.text = fmt::format("{} wedges, {}, btGjkPairDetector, {}", wedges, margins.text(),
                                             epa ? "EPA" : "Minkowski"),
                         .make = [wedges, margins, epa](double clearance) -> std::unique_ptr<Finder> {
                           return std::make_unique<Pairs>(clearance, wedges, margins, epa);
                         }});
      finds.push_back({.text = fmt::format("{} wedges, {}, contactPairTest", wedges, margins.text()),
                       .make = [wedges, margins](double clearance) -> std::unique_ptr<Finder> {
                         return std::make_unique<PairTest>(clearance, false, wedges, margins);
                       }});
    }
  return finds;
}

}  // namespace verisim::peers
