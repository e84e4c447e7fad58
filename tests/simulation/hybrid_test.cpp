// The hybrid methods in the loop: which one acts on a pair, that it can be switched while the simulation runs, what
// happens where nothing is known, and what is counted. A pin stands in its hole, nobody holds it, every frame sees the
// same contacts: so a method is told by the force that it leaves.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "engine/base/error.hpp"
#include "tests/simulation/hybrid_scenes.hpp"

namespace verisim::hybrid_test {
namespace {

constexpr std::size_t kBlock = 0, kPin = 1;

/// Voxels of 4.5 mm touch while there is still half a millimetre of clearance: fully aligned, and a contact.
const Pose kBesideTheWall = {{0.0045, 0.001, 0.06}, Quaterniond::Identity()};

/// The bodies are made once: the CAD kernel takes longer than all else here.
Scene standing_pin(Hybrid hybrid = hybrid::restore) {
  static const Scene made = [] {
    Scene scene = scenes::brep_pin_in_hole(hybrid::restore);
    scene.grasps.clear();
    scene.grasp_distance = 1e-9;
    scene.bodies[kPin].X_WB = kBesideTheWall;
    scene.parameters.integrator = Integrator::implicit;  // what `exact` needs: so all methods are comparable
    scene.parameters.passive_contacts = false;           // it is put there: whole depths act at once
    return scene;
  }();
  Scene scene = made;
  scene.devices = {scenes::hand_of_brep_pin()};
  scene.parameters.hybrid = hybrid;
  return scene;
}

/// What one frame of a simulation says.
class Frame {
 public:
  explicit Frame(Simulation& simulation) {
    simulation.step();
    simulation.describe(schema_);
    row_.assign(simulation.table_rows().begin(), simulation.table_rows().end());
    force = simulation.body_force(kPin).force;
    torque = simulation.body_force(kPin).torque;
  }
  template <typename T>
  [[nodiscard]] T of_link(const std::string& name) const {
    const auto& columns = schema_.table();
    const auto at =
        std::find_if(columns.begin(), columns.end(), [&](const Column& c) { return c.path == "/state/links/" + name; });
    T value{};
    if (at == columns.end() || at->bytes() != sizeof value) throw Error(ErrorKind::usage, "no column " + name);
    if (row_.empty()) return value;  // the bodies are not near
    std::memcpy(&value, row_.data() + at->offset, sizeof value);
    return value;
  }
  [[nodiscard]] ConstraintKind constraint() const { return of_link<ConstraintKind>("constraint"); }
  [[nodiscard]] bool same_response(const Frame& other) const {
    return force == other.force && torque == other.torque && constraint() == other.constraint();
  }

  Vector3d force, torque;

 private:
  Schema schema_;
  std::vector<std::byte> row_;  ///< of the one link
};

Frame frame_of(const Scene& scene) {
  Simulation simulation(scene, {});
  return Frame(simulation);
}

std::vector<std::string> hybrid_events(const Scene& scene) {
  Simulation simulation(scene, {});
  std::vector<std::string> texts;
  for (const Event& event : simulation.events())
    if (event.kind == "hybrid") texts.push_back(event.text);
  return texts;
}

TEST(Hybrid, OffLooksNothingUp) {
  const Frame off = frame_of(standing_pin(hybrid::off));
  EXPECT_GT(off.of_link<std::uint32_t>("contacts"), 0U);
  EXPECT_EQ(off.of_link<std::uint32_t>("cache_hits") + off.of_link<std::uint32_t>("cache_misses"), 0U);
  EXPECT_EQ(off.constraint(), ConstraintKind::none);
}

// The voxels' steps push along the axis; a cylindrical constraint leaves the slide free. Alpha is 1 within the
// clearance, so what is left along the axis is the rounding of a sum of floats.
TEST(Hybrid, RestoreTakesAwayTheForceAlongTheAxis) {
  const Frame restore = frame_of(standing_pin(hybrid::restore));
  EXPECT_EQ(restore.constraint(), ConstraintKind::cylindrical);
  EXPECT_EQ(restore.of_link<double>("alignment"), 1);
  EXPECT_GT(restore.force.head<2>().norm(), 1) << "the wall does not push any more";
  EXPECT_LE(std::abs(restore.force.z()), 1e-6 * restore.force.norm());
  EXPECT_GT(std::abs(frame_of(standing_pin(hybrid::off)).force.z()), 1) << "nothing to be restored";
}

// Normals are restored before there are forces, in implicit and explicit steps: one law. Nobody holds the pin,
// so both take the full stiffness. Normals, forces and what is left of them are floats: three roundings of 2^-24 in
// each force, none of which exceeds two layers of voxels times the stiffness; arms are below 0.15 m.
TEST(Hybrid, RestoresNormalsAsItRestoresForces) {
  for (const double x : {0.0, 0.0045, 0.0052}) {
    for (const double height : {0.06, 0.1, 0.14}) {  // the last: standing half in the rim
      Scene scene = standing_pin(hybrid::restore);
      scene.bodies[kPin].X_WB.position = {x, 0.001, height};
      scene.devices = {scenes::hand_along({{1, 0, 1}}, 0.5)};  // out of reach: nobody holds the pin
      const Frame normals = frame_of(scene);
      scene.parameters.integrator = Integrator::semi_implicit;
      const Frame forces = frame_of(scene);
      const double most = 2 * 0.0045 * scene.parameters.contact_stiffness;
      const double rounding = forces.of_link<std::uint32_t>("contacts") * most * 3 * 0x1p-24;
      EXPECT_LE((normals.force - forces.force).norm(), rounding);
      EXPECT_LE((normals.torque - forces.torque).norm(), 0.15 * rounding);
      EXPECT_EQ(normals.constraint(), forces.constraint());
      EXPECT_GT(forces.of_link<std::uint32_t>("contacts"), 0U);
    }
  }
}

/// Coaxial in a hole that is 50 um wider: nothing touches, but voxels of 4.5 mm are up to two layers deep in the wall.
Scene coaxial_pin(Hybrid hybrid, double turn) {
  static const BodyDescription thick = [] {
    return scenes::body_of("pin", *scenes::solid(Solid::Kind::cylinder, {0.07495, 0.2}), 0.0045);
  }();
  Scene scene = standing_pin(hybrid);
  scene.bodies[kPin] = thick;
  scene.bodies[kPin].X_WB = {{0, 0, 0.06}, rotation_from_vector({0, 0, turn})};
  return scene;
}

// ORACLES section 2, "Free spin": the error of the voxels, what restoration leaves of it (rounding of single
// precision), and what precise surfaces say. Every contact counts: one of ten has its point behind the surface voxels.
TEST(Hybrid, OfACoaxialPinNothingTurnsIt) {
  double worst_off = 0, worst_restored = 0;
  for (const double turn : {0.2, 0.35, 0.8, 1.2}) {
    SCOPED_TRACE(turn);
    const Frame restore = frame_of(coaxial_pin(hybrid::restore, turn));
    const Frame exact = frame_of(coaxial_pin(hybrid::exact, turn));
    worst_off = std::max(worst_off, std::abs(frame_of(coaxial_pin(hybrid::off, turn)).torque.z()));
    worst_restored = std::max(worst_restored, std::abs(restore.torque.z()));
    EXPECT_EQ(restore.constraint(), ConstraintKind::cylindrical);
    EXPECT_EQ(exact.torque, Vector3d::Zero());
    EXPECT_EQ(exact.force, Vector3d::Zero());
  }
  EXPECT_GT(worst_off, 1);
  EXPECT_LE(worst_restored, 1e-6 * worst_off);
}

TEST(Hybrid, OfAPairIsTheLesserMethodOfTheTwo) {
  const Hybrid all[] = {hybrid::off, hybrid::restore, hybrid::blend};  // in the order of their precedence
  for (std::size_t of_block = 0; of_block < 3; ++of_block) {
    for (std::size_t of_pin = 0; of_pin < 3; ++of_pin) {
      Scene scene = standing_pin();
      scene.bodies[kBlock].hybrid = all[of_block];
      scene.bodies[kPin].hybrid = all[of_pin];
      EXPECT_TRUE(frame_of(scene).same_response(frame_of(standing_pin(all[std::min(of_block, of_pin)]))))
          << all[of_block]->name() << " " << all[of_pin]->name();
    }
  }
}

TEST(Hybrid, OfAPreciseBodyAndAnotherIsTheOthers) {
  Scene scene = standing_pin(hybrid::exact);
  scene.bodies[kBlock].hybrid = hybrid::restore;
  EXPECT_TRUE(frame_of(scene).same_response(frame_of(standing_pin(hybrid::restore))));
}

TEST(Hybrid, MethodsDiffer) {
  const Frame off = frame_of(standing_pin(hybrid::off));
  const Frame restore = frame_of(standing_pin(hybrid::restore));
  const Frame blend = frame_of(standing_pin(hybrid::blend));
  EXPECT_FALSE(off.same_response(restore));
  EXPECT_FALSE(off.same_response(blend));
  EXPECT_FALSE(restore.same_response(blend));
}

TEST(Hybrid, IsSwitchedOffAndOnWhileItRuns) {
  const Frame off = frame_of(standing_pin(hybrid::off));
  for (const Hybrid method : {hybrid::restore, hybrid::blend}) {
    const Frame on = frame_of(standing_pin(method));
    Simulation simulation(standing_pin(method), {});
    for (const std::size_t body : {kBlock, kPin}) {
      EXPECT_TRUE(Frame(simulation).same_response(on));
      simulation.set_hybrid_enabled(body, false);
      EXPECT_TRUE(Frame(simulation).same_response(off));
      simulation.set_hybrid_enabled(body, true);
    }
    EXPECT_TRUE(Frame(simulation).same_response(on));
  }
}

// Precise contacts are not counted as voxels' look-ups; off, the same pair answers with its voxels.
TEST(Hybrid, OfPreciseBodiesIsSwitchedToTheirVoxels) {
  Simulation simulation(standing_pin(hybrid::exact), {});
  EXPECT_EQ(Frame(simulation).of_link<std::uint32_t>("contacts"), 0U) << "half a millimetre of clearance is no contact";
  EXPECT_EQ(simulation.cost().points_tested, 0U);
  EXPECT_EQ(simulation.cost().bytes_touched, 0U);
  simulation.set_hybrid_enabled(kPin, false);
  EXPECT_TRUE(Frame(simulation).same_response(frame_of(standing_pin(hybrid::off))));
  EXPECT_GE(simulation.cost().bytes_touched, 3 * sizeof(float) * simulation.cost().points_tested);
}

TEST(Hybrid, MayBeginSwitchedOff) {
  Scene scene = standing_pin();
  scene.bodies[kPin].hybrid_enabled = false;
  EXPECT_TRUE(frame_of(scene).same_response(frame_of(standing_pin(hybrid::off))));
}

TEST(Hybrid, WithOneBodyWithoutABRepStaysWithTheVoxelsAndSaysSo) {
  for (const Hybrid method : {hybrid::restore, hybrid::blend, hybrid::exact}) {
    Scene scene = standing_pin(method);
    scene.bodies[kPin].use_brep = false;
    EXPECT_TRUE(frame_of(scene).same_response(frame_of(standing_pin(hybrid::off))));
    EXPECT_EQ(hybrid_events(scene),
              std::vector<std::string>{"'pin' has no b-rep: its contacts with 'block' stay with the voxels"});
  }
}

TEST(Hybrid, SaysNothingWhereItIsNotAskedForOrEverythingIsKnown) {
  EXPECT_EQ(hybrid_events(standing_pin(hybrid::restore)), std::vector<std::string>{});
  Scene off = standing_pin(hybrid::off);
  off.bodies[kPin].use_brep = false;
  EXPECT_EQ(hybrid_events(off), std::vector<std::string>{});
}

// Freeform faces count as `other`: no recognizer takes them, and the voxels' answer stands, bit for bit.
TEST(Hybrid, LeavesFreeformFacesToTheVoxels) {
  for (const Hybrid method : {hybrid::restore, hybrid::blend}) {
    Scene scene = standing_pin(method);
    for (Face& face : scene.bodies[kPin].parts[0].faces) face.surface = OtherSurface();
    for (Edge& edge : scene.bodies[kPin].parts[0].edges) edge.curve = OtherCurve();
    EXPECT_TRUE(frame_of(scene).same_response(frame_of(standing_pin(hybrid::off))));
  }
}

TEST(Hybrid, LooksEveryContactUpOnceAndRecognizesInTheFirstFrameOnly) {
  for (const Hybrid method : {hybrid::restore, hybrid::blend}) {
    Simulation simulation(standing_pin(method), {});
    const Frame first(simulation);
    const auto contacts = first.of_link<std::uint32_t>("contacts");
    EXPECT_EQ(first.of_link<std::uint32_t>("cache_hits") + first.of_link<std::uint32_t>("cache_misses"), contacts);
    EXPECT_GT(first.of_link<std::uint32_t>("cache_misses"), 0U);
    EXPECT_GT(simulation.cost().recognitions, 0U);
    const Frame second(simulation);
    EXPECT_EQ(second.of_link<std::uint32_t>("cache_hits"), contacts);
    EXPECT_EQ(second.of_link<std::uint32_t>("cache_misses"), 0U);
    EXPECT_EQ(simulation.cost().recognitions, 0U);
    EXPECT_EQ(simulation.cost().lookups, contacts);
    EXPECT_TRUE(second.same_response(first)) << "what is remembered is what was recognized";
  }
}

TEST(Hybrid, TotalsAreTheSumsOfTheFrames) {
  Scene scene = scenes::brep_pin_in_hole(hybrid::restore);
  scene.parameters.duration = 0.5;
  Simulation simulation(scene, {});
  std::uint64_t hits = 0, misses = 0, cylindrical = 0;
  while (simulation.frame() < simulation.frames_planned()) {
    const Frame frame(simulation);
    hits += frame.of_link<std::uint32_t>("cache_hits");
    misses += frame.of_link<std::uint32_t>("cache_misses");
    cylindrical += frame.constraint() == ConstraintKind::cylindrical ? 1 : 0;
  }
  const Totals& totals = simulation.totals();
  EXPECT_EQ(totals.cache_hits, hits);
  EXPECT_EQ(totals.cache_misses, misses);
  EXPECT_EQ(totals.cache_hits + totals.cache_misses, totals.contacts);
  EXPECT_LE(totals.null_misses, totals.cache_misses);
  EXPECT_GT(cylindrical, 0U);
  EXPECT_EQ(totals.constraint_frames[static_cast<std::size_t>(ConstraintKind::cylindrical)], cylindrical);
}

// A part used twice: two bodies of one part stand in two pairs, and neither knows of the other.
TEST(Hybrid, GivesTwoBodiesOfOnePartTheSameAnswer) {
  Scene scene = standing_pin();
  BodyDescription twin = scene.bodies[kPin];
  BodyDescription hole = scene.bodies[kBlock];
  twin.name = "twin";
  hole.name = "second block";
  hole.X_WB.position = {1, 0, 0};
  twin.X_WB.position.x() += 1;
  scene.bodies.push_back(std::move(hole));
  scene.bodies.push_back(std::move(twin));
  Simulation simulation(scene, {});
  simulation.step();
  const Vector3d force = simulation.body_force(kPin).force;
  EXPECT_GT(force.norm(), 1);
  // The two poses are 1 m apart, and 1.0045 - 1 is not 0.0045: places differ by a rounding of 2e-16 m, depths of half a
  // millimetre by as much, and forces are sums of floats.
  EXPECT_LE((simulation.body_force(3).force - force).norm(), 1e-5 * force.norm());
}

// The measure and the policy of the scene reach the pair: by the dissertation's policy a rim voxel, which holds three
// entities, has no constraint.
TEST(Hybrid, FollowsTheScenesMeasureAndReduction) {
  Scene scene = standing_pin();
  const Frame by_type = frame_of(scene);
  scene.parameters.alignment = AlignmentMeasure::pavlik;
  const Frame pavlik = frame_of(scene);
  EXPECT_LT(pavlik.of_link<double>("alignment"), by_type.of_link<double>("alignment"));
  scene = standing_pin();
  scene.parameters.reduction = Reduction::exactly_one;
  EXPECT_FALSE(frame_of(scene).same_response(by_type));
}

}  // namespace
}  // namespace verisim::hybrid_test
