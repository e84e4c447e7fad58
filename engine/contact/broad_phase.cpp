#include "engine/contact/broad_phase.hpp"

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/shape/box.h>

#include <algorithm>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"

namespace verisim {

struct BroadPhase::Implementation {
  struct Box {
    std::shared_ptr<fcl::Boxd> shape;
    std::unique_ptr<fcl::CollisionObjectd> object;
    Vector3d center, half;
    bool can_move;
  };
  fcl::DynamicAABBTreeCollisionManagerd moving, fixed;
  bool fixed_ready = false;
  std::vector<Box> boxes;
  std::vector<fcl::CollisionObjectd*> placed;  ///< those that find_of() is asked for
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  std::size_t left_out = 0;

  static std::uint32_t index(const fcl::CollisionObjectd* o) {
    return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(o->getUserData()));
  }
  static bool collect(fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* data) {
    auto* self = static_cast<Implementation*>(data);
    if (a == b) return false;
    if (self->pairs.size() < self->pairs.capacity())
      self->pairs.emplace_back(std::min(index(a), index(b)), std::max(index(a), index(b)));
    else
      ++self->left_out;
    return false;  // go on: all pairs are wanted
  }
  /// By first and second; as one number, for a heap has thousands of pairs.
  void sort() {
    const auto number = [](const auto& pair) { return std::uint64_t{pair.first} << 32 | pair.second; };
    std::sort(pairs.begin(), pairs.end(), [&](const auto& a, const auto& b) { return number(a) < number(b); });
  }
  void begin() {
    pairs.clear();
    left_out = 0;
    if (!fixed_ready && !fixed.empty()) fixed.update();
    fixed_ready = true;
  }
};

BroadPhase::BroadPhase(const std::vector<BroadPhaseBody>& bodies)
    : implementation_(std::make_unique<Implementation>()) {
  Implementation& self = *implementation_;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    VERISIM_ASSERT(is_finite(bodies[i].center_B));
    VERISIM_ASSERT(is_finite(bodies[i].half_B));
    VERISIM_ASSERT(bodies[i].half_B.minCoeff() >= 0);
    Implementation::Box box{std::make_shared<fcl::Boxd>(2 * bodies[i].half_B), nullptr, bodies[i].center_B,
                            bodies[i].half_B, bodies[i].can_move};
    box.object = std::make_unique<fcl::CollisionObjectd>(box.shape);
    box.object->setUserData(reinterpret_cast<void*>(static_cast<std::uintptr_t>(i)));
    (box.can_move ? self.moving : self.fixed).registerObject(box.object.get());
    self.boxes.push_back(std::move(box));
  }
  self.moving.setup();
  self.placed.reserve(bodies.size());
  make_room();
}

BroadPhase::~BroadPhase() = default;

void BroadPhase::set_pose(std::size_t body, const Pose& X_WB, double ahead) {
  VERISIM_ASSERT(body < implementation_->boxes.size());
  VERISIM_ASSERT(is_placement(X_WB));  // the tree's search would not end
  VERISIM_ASSERT(is_not_negative(ahead));
  Implementation::Box& box = implementation_->boxes[body];
  VERISIM_ASSERT(box.can_move || !implementation_->fixed_ready);
  box.shape->side = 2 * (box.half + Vector3d::Constant(ahead));
  box.shape->computeLocalAABB();
  box.object->setTransform(X_WB.rotation.toRotationMatrix(), X_WB * box.center);
  box.object->computeAABB();
}

const std::vector<std::pair<std::uint32_t, std::uint32_t>>& BroadPhase::find() {
  Implementation& self = *implementation_;
  self.begin();
  if (!self.moving.empty()) {
    self.moving.update();
    self.moving.collide(&self, &Implementation::collect);
    if (!self.fixed.empty()) self.moving.collide(&self.fixed, &self, &Implementation::collect);
  }
  self.sort();
  return self.pairs;
}

const std::vector<std::pair<std::uint32_t, std::uint32_t>>& BroadPhase::find_of(std::span<const std::size_t> bodies) {
  Implementation& self = *implementation_;
  self.begin();
  self.placed.clear();
  for (const std::size_t i : bodies) {
    VERISIM_ASSERT(i < self.boxes.size());
    VERISIM_ASSERT(self.boxes[i].can_move);
    self.placed.push_back(self.boxes[i].object.get());
  }
  if (!self.placed.empty()) self.moving.update(self.placed);
  for (fcl::CollisionObjectd* const object : self.placed) {
    self.moving.collide(object, &self, &Implementation::collect);
    if (!self.fixed.empty()) self.fixed.collide(object, &self, &Implementation::collect);
  }
  self.sort();
  self.pairs.erase(std::unique(self.pairs.begin(), self.pairs.end()), self.pairs.end());  // of two of them: found twice
  return self.pairs;
}

std::size_t BroadPhase::left_out() const {
  return implementation_->left_out;
}

std::size_t BroadPhase::make_room() {
  Implementation& self = *implementation_;
  self.pairs.reserve(std::max(8 * self.boxes.size() + 8, 2 * (self.pairs.size() + self.left_out)));
  return self.pairs.capacity();
}

}  // namespace verisim
