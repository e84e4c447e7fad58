// "How to add a pair in three steps" (ARCHITECTURE.md), followed here: an elliptic pin in an elliptic hole.
#include <gtest/gtest.h>

#include "engine/constraint/recognizers.hpp"

namespace verisim::add_a_pair_test {

// Step 1: one struct (in the engine: recognize/ellipse_ellipse.hpp).
struct EllipseEllipse {
  using First = Ellipse;
  using Second = Ellipse;
  static constexpr ConstraintKind kKind = ConstraintKind::other;

  static bool matches(const Bounded<First>& a, const Bounded<Second>& b, const Tolerances& tolerances) {
    const Side hole = recognizing::hole_of(a.role, a.shape.major_radius, b.role, b.shape.major_radius);
    if (hole == Side::neither) return false;
    const Ellipse& outer = hole == Side::a ? a.shape : b.shape;
    const Ellipse& inner = hole == Side::a ? b.shape : a.shape;
    return recognizing::is_fit(outer.major_radius, inner.major_radius, tolerances) &&
           recognizing::is_fit(outer.minor_radius, inner.minor_radius, tolerances);
  }

  static Constraint make(const Bounded<First>& a, const Bounded<Second>& b) {
    Constraint c;
    c.kind = kKind;
    c.pairing = Pairing::axis_axis;
    c.field = NormalField::about_line;
    c.pin = opposite(recognizing::hole_of(a.role, a.shape.major_radius, b.role, b.shape.major_radius));
    c.normal_source = opposite(c.pin);
    c.unilateral = false;
    c.a = {a.shape.center, a.shape.normal, a.shape.major_radius, a.half_length, 0};
    c.b = {b.shape.center, b.shape.normal, b.shape.major_radius, b.half_length, 0};
    c.clearance = std::abs(c.a.radius - c.b.radius);
    return c;
  }
};

namespace {

// Step 2: its place in the list, and its cell in the drawing.
using Extended = Recognizers::With<EllipseEllipse>;
template <std::size_t I = 0>
constexpr std::size_t number_of_ellipse() {
  if constexpr (std::is_same_v<std::variant_alternative_t<I, Entity>, Bounded<Ellipse>>) {
    return I;
  } else {
    return number_of_ellipse<I + 1>();
  }
}
constexpr std::size_t kEllipse = number_of_ellipse();
static_assert(drawing_of<Recognizers, Entity>()[kEllipse][kEllipse] == '-');
static_assert(drawing_of<Extended, Entity>()[kEllipse][kEllipse] == 'O');

Entity ellipse(double major, double minor, Role role) {
  const Ellipse shape{Vector3d::Zero(), Vector3d::UnitZ(), Vector3d::UnitX(), major, minor};
  return Bounded<Ellipse>{shape, major, 0, role};
}

// Step 3: its test. Recognized; just past each tolerance not; both orders equal.
TEST(AddingAPair, MakesItRecognized) {
  const Entity hole = ellipse(0.10, 0.05, Role::hole);
  const Entity pin = ellipse(0.09, 0.048, Role::pin);
  const Constraint c = recognize_by<Extended>(hole, pin, Tolerances());
  EXPECT_EQ(c.kind, ConstraintKind::other);
  EXPECT_EQ(c.pin, Side::b);
  EXPECT_EQ(recognize_by<Extended>(pin, hole, Tolerances()).pin, Side::a);
  EXPECT_EQ(recognize_by<Extended>(hole, hole, Tolerances()).kind, ConstraintKind::none);
  EXPECT_EQ(recognize_by<Extended>(hole, ellipse(0.09, 0.042, Role::pin), Tolerances()).kind, ConstraintKind::none);
}

TEST(AddingAPair, ChangesNoOtherCell) {
  constexpr auto before = drawing_of<Recognizers, Entity>();
  constexpr auto after = drawing_of<Extended, Entity>();
  int changed = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    for (std::size_t j = 0; j < before.size(); ++j) changed += before[i][j] != after[i][j] ? 1 : 0;
  }
  EXPECT_EQ(changed, 1);
}

TEST(AddingAPair, IsNotKnownToTheEngineWithoutTheList) {
  const Entity hole = ellipse(0.10, 0.05, Role::hole);
  EXPECT_EQ(recognize_by<Recognizers>(hole, ellipse(0.09, 0.048, Role::pin), Tolerances()).kind, ConstraintKind::none);
}

}  // namespace
}  // namespace verisim::add_a_pair_test
