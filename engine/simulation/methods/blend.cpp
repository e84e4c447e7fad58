// `blend`: Faas's comparator. The collision's response is mixed by alignment with the pull of a spring towards where
// the constraints would have the body. The spring is the virtual coupling's, as weak as that of the weaker of the
// bodies that move.
#include <algorithm>

#include "engine/constraint/blend.hpp"
#include "engine/simulation/methods/set_look_up.hpp"
#include "engine/simulation/world.hpp"

namespace verisim {
namespace {

BlendParameters spring_between(const Pair& pair) {
  BlendParameters spring{.stiffness = pair.parameters.max_stiffness,
                         .angular_stiffness = pair.parameters.max_angular_stiffness};
  for (const Body* body : {&pair.map(), &pair.points()}) {
    if (!body->can_move) continue;
    spring.stiffness = std::min(spring.stiffness, body->coupling.stiffness);
    spring.angular_stiffness = std::min(spring.angular_stiffness, body->coupling.angular_stiffness);
  }
  spring.length = 0.5 * pair.points().bounds_B.size().norm();
  return spring;
}

class BlendPair final : public PairMethod {
 public:
  explicit BlendPair(const Pair& pair) : pair_(pair), sets_(pair), spring_(spring_between(pair)) {}

  void act_on_sides(const ContactList& contacts, const Pose& X_AB, LinkSides& sides) override {
    sets_.look_up(contacts, X_AB);
    look_ups_ = sets_.look_ups();
    const bool first_is_map = pair_.contact.first_is_map();
    LinkSide& on_map = first_is_map ? sides.first : sides.second;
    LinkSide& on_points = first_is_map ? sides.second : sides.first;
    const RigidBody& map = pair_.map().rigid;
    const RigidBody& points = pair_.points().rigid;
    const Vector3d center_B = points.pose().inverse() * points.p_WC;
    const ConstraintForce pull = constraint_force(sets_.engaged(), X_AB, center_B, spring_);
    const double alpha = is_pulled() ? pull.alpha : 0;
    const Matrix3d R_WA = map.R_WB.toRotationMatrix();
    const Wrench pull_W{R_WA * pull.on_b.force, R_WA * pull.on_b.torque};
    on_points.wrench = blended(on_points.wrench, pull_W, alpha);
    on_map.wrench = reaction(on_points.wrench, points.p_WC, map.p_WC);
    for (LinkSide* side : {&on_map, &on_points}) {  // the collision's part of what an implicit step is told
      side->stiffness *= 1 - alpha;
      side->damping *= 1 - alpha;
      side->drift *= 1 - alpha;
    }
  }

 private:
  /// The pull is a hand's, and as weak: it cannot hold up what falls, nor stop what flies. @returns whether one of the
  /// bodies is held, or none of them moves
  [[nodiscard]] bool is_pulled() const {
    return !pair_.parameters.all_bodies_are_dynamic || pair_.map().held_by != kNone || pair_.points().held_by != kNone;
  }

  Pair pair_;
  SetLookUp sets_;
  BlendParameters spring_;
};

constinit const MethodByPair<BlendPair> kBlend("blend", 20);

}  // namespace

constinit const Hybrid hybrid::blend = &kBlend;

}  // namespace verisim
