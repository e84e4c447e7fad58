#include "engine/contact/broad_phase.hpp"

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/shape/box.h>

#include <algorithm>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"

namespace verisim {
namespace {

/// Of the diagonal of its box: how much larger on every side the tree's is. A hand's part at 0.2 m/s then leaves it
/// after some twenty frames.
constexpr double kReserve = 0.05;
/// A box so many times as large as it needs to be is made anew: it was that of a body that has slowed down.
constexpr double kTooLarge = 4;

}  // namespace

struct BroadPhase::Implementation {
  struct Box {
    std::shared_ptr<fcl::Boxd> shape;
    std::unique_ptr<fcl::CollisionObjectd> object;
    Vector3d center, half;
    bool can_move;
    bool has_left = false;  ///< the box that it had in the tree
  };
  fcl::DynamicAABBTreeCollisionManagerd moving, fixed;
  bool fixed_ready = false;
  bool anew = true;  ///< are all to be looked at?
  std::vector<Box> boxes;
  std::vector<fcl::CollisionObjectd*> left;  ///< of movable bodies that have left their boxes
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
  void find_all() {
    pairs.clear();
    left_out = 0;
    if (!fixed_ready && !fixed.empty()) fixed.update();
    fixed_ready = true;
    if (moving.empty()) return;
    moving.update();
    moving.collide(this, &collect);
    if (!fixed.empty()) moving.collide(&fixed, this, &collect);
  }
  void find_of_left() {
    std::erase_if(pairs, [&](const auto& pair) { return boxes[pair.first].has_left || boxes[pair.second].has_left; });
    moving.update(left);
    for (fcl::CollisionObjectd* const object : left) {
      moving.collide(object, this, &collect);
      if (!fixed.empty()) fixed.collide(object, this, &collect);
    }
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
  self.left.reserve(bodies.size());
  make_room();
}

BroadPhase::~BroadPhase() = default;

void BroadPhase::set_pose(std::size_t body, const Pose& X_WB, double ahead) {
  VERISIM_ASSERT(body < implementation_->boxes.size());
  VERISIM_ASSERT(is_placement(X_WB));  // the tree's search would not end
  VERISIM_ASSERT(is_not_negative(ahead));
  Implementation& self = *implementation_;
  Implementation::Box& box = self.boxes[body];
  VERISIM_ASSERT(box.can_move || !self.fixed_ready);
  const Matrix3d R = X_WB.rotation.toRotationMatrix();
  const Vector3d center = X_WB * box.center;
  const Vector3d half = box.half + Vector3d::Constant(ahead);
  const Vector3d half_W = R.cwiseAbs() * half;
  const fcl::AABBd& kept = box.object->getAABB();
  const fcl::AABBd needed(center - half_W, center + half_W);
  if (!self.anew && kept.contain(needed) && kept.radius() < kTooLarge * needed.radius()) return;
  box.shape->side = 2 * (half + Vector3d::Constant(box.can_move ? 2 * kReserve * box.half.norm() : 0));
  box.shape->computeLocalAABB();
  box.object->setTransform(R, center);
  box.object->computeAABB();
  if (!box.has_left && box.can_move) self.left.push_back(box.object.get());
  box.has_left = box.can_move;
}

const std::vector<std::pair<std::uint32_t, std::uint32_t>>& BroadPhase::find() {
  Implementation& self = *implementation_;
  if (self.left.empty() && !self.anew) return self.pairs;
  if (self.anew || 2 * self.left.size() > self.moving.size())
    self.find_all();
  else
    self.find_of_left();
  self.sort();
  self.pairs.erase(std::unique(self.pairs.begin(), self.pairs.end()), self.pairs.end());  // of two of them: found twice
  for (Implementation::Box& box : self.boxes) box.has_left = false;
  self.left.clear();
  self.anew = false;
  return self.pairs;
}

std::size_t BroadPhase::left_out() const {
  return implementation_->left_out;
}

std::size_t BroadPhase::make_room() {
  Implementation& self = *implementation_;
  self.pairs.reserve(std::max(8 * self.boxes.size() + 8, 2 * (self.pairs.size() + self.left_out)));
  self.anew = true;
  return self.pairs.capacity();
}

}  // namespace verisim
