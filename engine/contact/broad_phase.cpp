#include "engine/contact/broad_phase.hpp"

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/shape/box.h>

#include <algorithm>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"

namespace verisim {

struct BroadPhase::Implementation {
  fcl::DynamicAABBTreeCollisionManagerd manager;
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects;
  std::vector<Vector3d> centers;
  std::vector<bool> can_move;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;

  static bool collect(fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* data) {
    auto* self = static_cast<Implementation*>(data);
    const auto index = [](const fcl::CollisionObjectd* o) {
      return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(o->getUserData()));
    };
    const std::uint32_t i = std::min(index(a), index(b));
    const std::uint32_t j = std::max(index(a), index(b));
    if (self->can_move[i] || self->can_move[j]) self->pairs.emplace_back(i, j);
    return false;  // go on: all pairs are wanted
  }
};

BroadPhase::BroadPhase(const std::vector<BroadPhaseBody>& bodies)
    : implementation_(std::make_unique<Implementation>()) {
  Implementation& self = *implementation_;
  const std::size_t n = bodies.size();
  self.pairs.reserve(n * (n - (n > 0 ? 1 : 0)) / 2);
  for (std::size_t i = 0; i < n; ++i) {
    VERISIM_ASSERT(is_finite(bodies[i].center_B));
    VERISIM_ASSERT(is_finite(bodies[i].half_B));
    VERISIM_ASSERT(bodies[i].half_B.minCoeff() >= 0);
    const Vector3d side = 2 * bodies[i].half_B;
    auto object = std::make_unique<fcl::CollisionObjectd>(std::make_shared<fcl::Boxd>(side.x(), side.y(), side.z()));
    object->setUserData(reinterpret_cast<void*>(static_cast<std::uintptr_t>(i)));
    self.centers.push_back(bodies[i].center_B);
    self.can_move.push_back(bodies[i].can_move);
    self.manager.registerObject(object.get());
    self.objects.push_back(std::move(object));
  }
  self.manager.setup();
}

BroadPhase::~BroadPhase() = default;

void BroadPhase::set_pose(std::size_t body, const Pose& X_WB) {
  VERISIM_ASSERT(body < implementation_->objects.size());
  VERISIM_ASSERT(is_placement(X_WB));  // the tree's search would not end
  fcl::CollisionObjectd& object = *implementation_->objects[body];
  object.setTransform(X_WB.rotation.toRotationMatrix(), X_WB * implementation_->centers[body]);
  object.computeAABB();
}

const std::vector<std::pair<std::uint32_t, std::uint32_t>>& BroadPhase::find() {
  Implementation& self = *implementation_;
  self.pairs.clear();
  self.manager.update();
  self.manager.collide(&self, &Implementation::collect);
  std::sort(self.pairs.begin(), self.pairs.end());
  return self.pairs;
}

}  // namespace verisim
