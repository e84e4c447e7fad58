// What a hybrid method is: how much of the precise geometry acts on a pair of bodies (INTERFACES section 3: hybrid).
//
// A HybridMethod is a constant thing that a scene points to. For every pair of bodies on which it acts it makes a
// PairMethod, which owns whatever the method keeps for that pair and is called at fixed places of each frame:
//
//     query      contacts of the voxels are found          needs_voxels, take_over
//     response   their forces are computed and summed      act_on_normals, act_on_forces, act_on_sides
//     exact      precise contacts are solved               precise
//
// Which method acts on a pair: of the two bodies' methods that of lower precedence; none ("off") while one of the two
// is switched off, or if a body has no entities. The order: off 0, restore 10, blend 20, exact 30 (methods.cpp).
//
// To add one: see README.md.
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "engine/base/pose.hpp"
#include "engine/constraint/constraint.hpp"
#include "engine/contact/collision_link.hpp"
#include "engine/exact/exact_link.hpp"

namespace verisim {

struct Body;
struct SimulationParameters;

/// What a method's look-ups found in one frame (/state/link and /cost).
struct LookUps {
  ConstraintKind constraint = ConstraintKind::none;  ///< of the contact with the largest alpha
  double alpha = 0;
  std::uint32_t hits = 0, misses = 0;
  std::uint64_t recognitions = 0, null_misses = 0, overflows = 0;
};

/// A pair of bodies as a method is made for it. All of it outlives the method.
struct Pair {
  const SimulationParameters& parameters;
  const Body& first;
  const Body& second;
  const CollisionLink& contact;
  [[nodiscard]] const Body& map() const { return contact.first_is_map() ? first : second; }     ///< A: has the voxmap
  [[nodiscard]] const Body& points() const { return contact.first_is_map() ? second : first; }  ///< B: has the points
};

/// A method on one pair. Contacts are in the coordinates of A; X_AB places B in them. No hook allocates.
class PairMethod {
 public:
  PairMethod() = default;
  virtual ~PairMethod() = default;
  PairMethod(const PairMethod&) = delete;
  PairMethod& operator=(const PairMethod&) = delete;

  /// False: the method answers every contact of the pair itself; voxels are not even asked, and nothing is looked up.
  /// Always the same; so is precise().
  [[nodiscard]] virtual bool needs_voxels() const { return true; }
  /// Removes from the voxels' contacts those that the method answers itself. Keeps the order.
  virtual void take_over(ContactList& /*contacts*/) const {}
  /// Before there are forces: changes the contacts' normals, unit or shorter. Returns whether it changed any.
  virtual bool act_on_normals(ContactList& /*contacts*/, const Pose& /*X_AB*/) { return false; }
  /// After each contact has its force, before the sum, where the step is explicit: changes the forces.
  virtual void act_on_forces(ContactList& /*contacts*/, const Pose& /*X_AB*/) {}
  /// After the sum: changes what both bodies get. What is taken from one side is to be taken from the other.
  virtual void act_on_sides(const ContactList& /*contacts*/, const Pose& /*X_AB*/, LinkSides& /*sides*/) {}
  /// The search for precise contacts, which the exact response solves; null: none.
  [[nodiscard]] virtual exact::ExactLink* precise() { return nullptr; }

  void begin_frame() { look_ups_ = {}; }
  [[nodiscard]] const LookUps& look_ups() const { return look_ups_; }  ///< of this frame

 protected:
  LookUps look_ups_;
};

class HybridMethod {
 public:
  constexpr HybridMethod(std::string_view name, int precedence) : name_(name), precedence_(precedence) {}
  virtual ~HybridMethod() = default;
  HybridMethod(const HybridMethod&) = delete;
  HybridMethod& operator=(const HybridMethod&) = delete;

  [[nodiscard]] std::string_view name() const { return name_; }  ///< as scenarios write it
  [[nodiscard]] int precedence() const { return precedence_; }
  /// Are the bodies' voxels to be associated with their entities?
  [[nodiscard]] virtual bool needs_entities() const { return true; }
  /// Are precise surfaces to be made of the bodies, and are steps to be implicit?
  [[nodiscard]] virtual bool needs_precise_surfaces() const { return false; }
  /// For a pair of bodies that both have entities; null: nothing acts on this pair.
  [[nodiscard]] virtual std::unique_ptr<PairMethod> make(const Pair& pair) const = 0;

 private:
  std::string_view name_;
  int precedence_;
};

/// A method that acts on every such pair, each time by an `OfPair` made of it.
template <typename OfPair>
class MethodByPair final : public HybridMethod {
 public:
  using HybridMethod::HybridMethod;
  [[nodiscard]] std::unique_ptr<PairMethod> make(const Pair& pair) const override {
    return std::make_unique<OfPair>(pair);
  }
};

using Hybrid = const HybridMethod*;  ///< never null

namespace hybrid {
extern const Hybrid off;      ///< nothing: the penalty forces of the voxels
extern const Hybrid restore;  ///< each contact loses what opposes a motion that a recognized constraint leaves free
extern const Hybrid blend;    ///< Faas's comparator: the sum is mixed with the pull of the constraints
extern const Hybrid exact;    ///< contacts of precise surfaces, solved at the end of the step; the rest are voxels'

/// All of them in the order of their precedence: the words of a scenario.
[[nodiscard]] std::span<const Hybrid> all();
}  // namespace hybrid

/// Of two bodies' methods the one that acts on their pair.
[[nodiscard]] inline Hybrid lesser(Hybrid a, Hybrid b) {
  return b->precedence() < a->precedence() ? b : a;
}

}  // namespace verisim
