// How much results hang on the heuristic numbers of engine/exact: each is halved and doubled, alone, in the driven
// insertion with a clearance of 0.1 mm, in a cone's seat, and where a pin leans over its hole's rim.
#include <gtest/gtest.h>

#include "tests/exact/driven_insertion.hpp"
#include "tests/exact/scenes.hpp"
#include "tests/exact/seated_cone.hpp"
#include "tests/length.hpp"

namespace verisim::exact::test::exact_thresholds_test {
namespace {

constexpr double kClearance = 1e-4;

struct Numbers {
  BodyOptions options;
  SearchThresholds thresholds;
};
struct Threshold {
  const char* name;
  void (*scale)(Numbers&, double factor);
};

const Threshold kThresholds[] = {
    {"own",
     [](Numbers& n, double factor) { n.thresholds.own_face_full *= factor, n.thresholds.own_face_none *= factor; }},
    {"coincident", [](Numbers& n, double factor) { n.thresholds.coincident *= factor; }},
    {"cone", [](Numbers& n, double factor) { n.thresholds.cone_full *= factor, n.thresholds.cone_none *= factor; }},
    {"cone_of_edges", [](Numbers& n, double factor) { n.thresholds.cone_of_edges *= factor; }},
    {"slow", [](Numbers& n, double factor) { n.thresholds.slow *= factor; }},
    {"kink", [](Numbers& n, double factor) { n.thresholds.kink *= factor; }},
    {"touching", [](Numbers& n, double factor) { n.thresholds.touching *= factor; }},
    {"weight_enough", [](Numbers& n, double factor) { n.thresholds.weight_enough *= factor; }},
    {"smooth", [](Numbers& n, double factor) { n.options.smooth *= factor; }},
    {"group_angle", [](Numbers& n, double factor) { n.options.group_angle *= factor; }},
    {"cells_max",
     [](Numbers& n, double factor) { n.options.cells_max = static_cast<int>(factor * n.options.cells_max); }},
    {"sagitta", [](Numbers& n, double factor) { n.options.sagitta *= factor; }},
    {"beyond_end", [](Numbers& n, double factor) { n.options.beyond_end *= factor; }},
    {"convex_corner", [](Numbers& n, double factor) { n.options.convex_corner *= factor; }},
    {"same_corner", [](Numbers& n, double factor) { n.options.same_corner *= factor; }},
    {"end_apart", [](Numbers& n, double factor) { n.thresholds.end_apart *= factor; }},
    {"lead_enough", [](Numbers& n, double factor) { n.thresholds.lead_enough *= factor; }},
    {"held", [](Numbers& n, double factor) { n.thresholds.held *= factor; }},
    {"blade", [](Numbers& n, double factor) { n.thresholds.blade *= factor; }},
};

Numbers scaled(const Threshold& threshold, double factor) {
  Numbers numbers;
  threshold.scale(numbers, factor);
  return numbers;
}

/// How far two poses of a body are apart, seen at `arm` [m] from its middle.
double apart(const Pose& a, const Pose& b, double arm) {
  return (a.position - b.position).norm() + arm * vector_from_rotation(a.rotation * b.rotation.conjugate()).norm();
}

/// How far a cone is from where it fits its seat, about whose axis it may turn; seen as by apart().
double pressed_in(const Pose& cone, double arm) {
  const Vector3d turn = vector_from_rotation(cone.rotation);
  return cone.position.norm() + arm * std::sqrt(turn.x() * turn.x() + turn.y() * turn.y());
}

/// Where the cone is after each tenth of a second, and the largest force.
struct Seated {
  std::vector<Pose> poses;
  double force_max = 0;
};
Seated seat(const Numbers& numbers) {
  HeldBody cone = seated_cone(0, 0.002, numbers.options, numbers.thresholds);
  Seated seated;
  for (int i = 0; i < kSeatSteps; ++i) {
    cone.step(hand_over_seat(i * cone.dt));
    seated.force_max = std::max(seated.force_max, cone.contact_force.norm());
    if (i % 100 == 99) seated.poses.push_back(cone.X_WB);
  }
  return seated;
}

class ExactThresholds : public ::testing::TestWithParam<std::tuple<Threshold, double>> {
 protected:
  [[nodiscard]] static Numbers numbers() { return scaled(std::get<0>(GetParam()), std::get<1>(GetParam())); }
};
INSTANTIATE_TEST_SUITE_P(HalfAndDouble, ExactThresholds,
                         ::testing::Combine(::testing::ValuesIn(verisim::test::some_of(kThresholds, 18)),
                                            ::testing::Values(0.5, 2.0)),
                         [](const auto& number) {
                           const std::string name = std::get<0>(number.param).name;
                           return name + (std::get<1>(number.param) < 1 ? "Halved" : "Doubled");
                         });

// The forces and the pose that the peers of driven_insertion_test agree on do not hang on any of them.
TEST_P(ExactThresholds, HardlyChangeADrivenInsertion) {
  static const Outcome usual = run({.clearance = kClearance});
  const Numbers n = numbers();
  const Outcome o = run({.clearance = kClearance, .options = n.options, .thresholds = n.thresholds});
  EXPECT_LE(apart(o.pose, usual.pose, kPinLength / 2), 1e-8 * kClearance);
  EXPECT_LE(std::abs(o.force_max - usual.force_max), 1e-5 * usual.force_max);
  EXPECT_LE(o.overlap_max, 0.0125 * kClearance);
}

/// What a pin feels that leans by up to 5 degrees over the rim of its hole or in it, pressed in by up to 0.2 mm: the
/// sum of the springs that act, and the deepest overlap.
struct Felt {
  double stiffness = 0, depth = 0;
};
Felt feel(ExactLink& link, std::uint64_t seed) {
  Draw draw(seed);
  const Vector3d lean = 0.087 * draw.between(0, 1) * Vector3d(std::cos(draw.between(0, 6.28)), 1, 0).normalized();
  Pose X{{draw.between(-0.003, 0.003), draw.between(-0.003, 0.003), draw.between(0, 0.3)}, rotation_from_vector(lean)};
  const auto gap = [&](double margin) {
    link.find({}, {X, X.position, {}}, 0.001, margin);
    double least = margin;
    for (const ContactRow& row : link.rows().rows()) least = std::min(least, row.gap);
    return least;
  };
  X.position.z() -= gap(0.02) + draw.between(0, 2e-4);  // down onto the rim, if it is over it
  Felt felt;
  felt.depth = -gap(1e-3);
  for (const ContactRow& row : link.rows().rows()) felt.stiffness += row.gap < 0 ? row.stiffness : 0;
  return felt;
}
ExactLink link_of(const Numbers& n) {
  return {body_of(block_solid(), 0.0045, {}, n.options), body_of(pin_solid(1e-3), 0.0045, {}, n.options), 4096,
          n.thresholds};
}

// Two change anything by 1 %. `cone`: at twice its sines, 57 degrees and more, normals that lean so far are let in, and
// 12 places of 299 feel another contact. `end_apart`: whether an end that is near has a row of its own changes how
// many springs share the force, by up to half; not how deep the pin is, nor where it comes to rest (above and below).
TEST_P(ExactThresholds, HardlyChangeWhatALeaningPinFeels) {
  static ExactLink usual = link_of({});
  ExactLink varied = link_of(numbers());
  int touching = 0;
  int other = 0;
  int deeper = 0;
  double most = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const Felt a = feel(usual, seed);
    const Felt b = feel(varied, seed);
    if (a.stiffness == 0) continue;
    ++touching;
    const double change = std::abs(b.stiffness - a.stiffness) / a.stiffness;
    most = std::max(most, change);
    deeper += b.depth == a.depth ? 0 : 1;
    other += change <= 0.01 && b.depth == a.depth ? 0 : 1;
  }
  EXPECT_GT(touching, 250);
  const std::string name = std::get<0>(GetParam()).name;
  if (name == "end_apart") {
    EXPECT_EQ(deeper, 0);
    EXPECT_LE(most, 0.5);
    return;
  }
  const bool lets_more_in = name == "cone" && std::get<1>(GetParam()) > 1;
  EXPECT_LE(other, lets_more_in ? 0.05 * touching : 0);
}

// In the seat the numbers move the cone by no more than closest places are off. Normal cones twice as wide let rims
// have rows with rims: these carry a part of the load on one side, and move the cone by no more than the load presses
// it in.
TEST_P(ExactThresholds, HardlyChangeHowAConeSits) {
  static const Seated usual = seat({});
  const Seated s = seat(numbers());
  const bool wider = std::string(std::get<0>(GetParam()).name) == "cone" && std::get<1>(GetParam()) > 1;
  for (std::size_t i = 0; i < usual.poses.size(); ++i)
    EXPECT_LE(apart(s.poses[i], usual.poses[i], 0.03), 1e-10 + (wider ? pressed_in(usual.poses[i], 0.03) : 0))
        << "after " << 0.1 * static_cast<double>(i + 1) << " s";
  EXPECT_LE(std::abs(s.force_max - usual.force_max), 1e-7 * usual.force_max);
}

}  // namespace
}  // namespace verisim::exact::test::exact_thresholds_test
