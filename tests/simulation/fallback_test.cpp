// No silent fallback: every pair for which a hybrid method was asked says which share of its contacts voxels answered,
// and why. The pin stands in its hole; what is known of its surface, and who may use it, is what changes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <functional>

#include "engine/simulation/declaring.hpp"
#include "tests/simulation/hybrid_scenes.hpp"

namespace verisim::fallback_test {
namespace {

constexpr std::size_t kBlock = 0, kPin = 1;
constexpr const char* kRemedy = "(Model{ FILE, brep = true } looks for faces)";

/// The pin is 0.1 mm in the wall: a contact for voxels and for precise surfaces.
Scene pressed_pin(Hybrid hybrid) {
  static const Scene made = [] {
    Scene scene = scenes::brep_pin_in_hole(hybrid::restore);
    scene.grasps.clear();
    scene.devices.clear();
    scene.parameters.integrator = Integrator::implicit;
    scene.parameters.all_bodies_are_dynamic = true;
    scene.bodies[kPin].X_WB = {{0.0051, 0, 0.02}, Quaterniond::Identity()};
    return scene;
  }();
  Scene scene = made;
  scene.parameters.hybrid = hybrid;
  return scene;
}

void forget_brep(Part& part) {
  part.faces.clear();
  part.edges.clear();
  part.mesh.face_of_triangle.clear();
  part.exact = false;
}

void forget_surfaces(Part& part) {
  for (Face& face : part.faces) face.surface = OtherSurface();
}

std::uint32_t sum_of(const Simulation& simulation, const std::string& name) {
  Schema schema;
  simulation.describe(schema);
  std::uint32_t sum = 0;
  for (const Column& column : schema.table()) {
    if (column.path != "/state/links/" + name) continue;
    const std::span<const std::byte> rows = simulation.table_rows();
    for (std::size_t at = 0; at < rows.size(); at += schema.table_row_bytes()) {
      std::uint32_t value = 0;
      std::memcpy(&value, rows.data() + at + column.offset, sizeof value);
      sum += value;
    }
  }
  return sum;
}

/// A few frames of a scene: what its pair said when it met, and what it came to.
struct Said {
  std::vector<std::string> met;
  PairAnswers answers;
  std::string end;
  Totals totals;
};

Said said_by(const Scene& scene, const std::function<void(Simulation&, int)>& between = {}) {
  Simulation simulation(scene, {});
  Said said;
  for (const Event& event : simulation.events())
    if (event.kind == "hybrid") said.met.push_back(event.text);
  std::uint64_t contacts = 0, by_voxels = 0;
  for (int frame = 0; frame < 4; ++frame) {
    if (between) between(simulation, frame);
    simulation.step();
    contacts += sum_of(simulation, "contacts");
    by_voxels += sum_of(simulation, "by_voxels");
  }
  said.totals = simulation.totals();
  EXPECT_EQ(said.totals.contacts, contacts);
  EXPECT_EQ(said.totals.by_voxels, by_voxels);
  const std::vector<PairAnswers> answers = simulation.answers();
  const std::vector<Event> events = simulation.last_events();
  EXPECT_EQ(answers.size(), events.size());
  if (answers.size() != 1) {
    ADD_FAILURE() << answers.size() << " pairs";
    return said;
  }
  said.answers = answers.front();
  EXPECT_EQ(said.answers.contacts, contacts);
  EXPECT_EQ(said.answers.by_voxels, by_voxels);
  EXPECT_EQ(events.front().kind, "voxels");
  said.end = events.front().text;
  EXPECT_NE(said.end.find(said.answers.why), std::string::npos);
  return said;
}

using Texts = std::vector<std::string>;

TEST(Fallback, OfTwoKnownBodiesThereIsNoneUnderExact) {
  const Said said = said_by(pressed_pin(hybrid::exact));
  EXPECT_EQ(said.met, Texts{});
  EXPECT_GT(said.answers.contacts, 0U);
  EXPECT_EQ(said.answers.by_voxels, 0U);
  EXPECT_EQ(said.answers.why, "");
  EXPECT_EQ(said.end, fmt::format("voxels answered 0 of {} contacts (0 %) of 'block' and 'pin' under exact",
                                  said.answers.contacts));
  EXPECT_EQ(said.totals.exact_frames, said.totals.collision_frames);
  EXPECT_EQ(said.totals.exact_frames_by_voxels, 0U);
}

/// What is said of a method itself, before its pairs meet.
Texts said_of(Hybrid method) {
  if (method != hybrid::blend) return {};
  return {"'blend' pulls as a hand does: where no hand holds one of two bodies it acts as 'off'"};
}

TEST(Fallback, RestoreAndBlendSayThatTheyActOnVoxels) {
  for (const Hybrid method : {hybrid::restore, hybrid::blend}) {
    const Said said = said_by(pressed_pin(method));
    EXPECT_EQ(said.met, said_of(method));
    EXPECT_EQ(said.answers.fraction(), 1);
    EXPECT_EQ(said.answers.why, fmt::format("'{}' acts on the voxels' contacts", method->name()));
    EXPECT_EQ(said.totals.exact_frames, 0U) << "nobody asked for it";
  }
}

TEST(Fallback, WhereNobodyNamedAMethodNothingIsSaid) {
  for (const ContactMethod contact : {ContactMethod::voxmap, ContactMethod::fcl}) {
    Scene scene = pressed_pin(hybrid::off);
    scene.parameters.contact = contact;
    Simulation simulation(scene, {});
    simulation.step();
    EXPECT_GT(simulation.totals().contacts, 0U);
    EXPECT_TRUE(simulation.answers().empty());
    EXPECT_TRUE(simulation.last_events().empty());
  }
}

// The contacts of triangles belong to no voxel whose faces would be known: the method that was named does not act.
TEST(Fallback, OfTrianglesIsTold) {
  for (const Hybrid method : {hybrid::restore, hybrid::blend, hybrid::exact}) {
    Scene scene = pressed_pin(method);
    scene.parameters.contact = ContactMethod::fcl;
    const Said said = said_by(scene);
    EXPECT_EQ(said.answers.method, "off");
    EXPECT_EQ(said.answers.fraction(), 1);
    EXPECT_EQ(said.answers.why, "contact = \"fcl\": triangles answered, as with hybrid = \"off\"");
    EXPECT_EQ(said.totals.exact_frames, 0U) << "the scene was told before its first frame";
  }
}

TEST(Fallback, OfABodyThatIsOffIsTold) {
  Scene scene = pressed_pin(hybrid::exact);
  scene.bodies[kPin].hybrid = hybrid::off;
  Said said = said_by(scene);
  EXPECT_EQ(said.answers.method, "off");
  EXPECT_EQ(said.answers.fraction(), 1);
  EXPECT_EQ(said.answers.why, "'pin' has hybrid = \"off\"");
  EXPECT_EQ(said.totals.exact_frames, 0U) << "nobody asked for it";

  scene = pressed_pin(hybrid::off);  // of the simulation, and one body has a method
  scene.bodies[kPin].hybrid = hybrid::restore;
  EXPECT_EQ(said_by(scene).answers.why, "'block' has hybrid = \"off\"");

  scene = pressed_pin(hybrid::restore);
  for (BodyDescription& body : scene.bodies) body.hybrid = hybrid::off;
  scene.parameters.contact = ContactMethod::fcl;
  EXPECT_EQ(said_by(scene).answers.why,
            "'block' has hybrid = \"off\"; 'pin' has hybrid = \"off\"; contact = \"fcl\": triangles answered, as with "
            "hybrid = \"off\"");
}

TEST(Fallback, OfTwoMeshesIsTold) {
  for (const Hybrid method : {hybrid::restore, hybrid::blend, hybrid::exact}) {
    Scene scene = pressed_pin(method);
    for (BodyDescription& body : scene.bodies) forget_brep(body.parts[0]);
    const Said said = said_by(scene);
    Texts told = said_of(method);
    told.emplace_back("'block' and 'pin' have no b-rep: their contacts stay with the voxels");
    EXPECT_EQ(said.met, told);
    EXPECT_EQ(said.answers.fraction(), 1);
    EXPECT_EQ(said.answers.why, std::string("no b-rep: 'block' and 'pin' are of bare triangles ") + kRemedy);
    EXPECT_EQ(said.totals.exact_frames_by_voxels, method == hybrid::exact ? said.totals.collision_frames : 0U);
  }
}

TEST(Fallback, OfOneMeshIsTold) {
  Scene scene = pressed_pin(hybrid::exact);
  forget_brep(scene.bodies[kPin].parts[0]);
  const Said said = said_by(scene);
  EXPECT_EQ(said.met, Texts{"'pin' has no b-rep: its contacts with 'block' stay with the voxels"});
  EXPECT_EQ(said.answers.why, std::string("no b-rep: 'pin' is of bare triangles ") + kRemedy);
  EXPECT_EQ(said.answers.fraction(), 1);
}

TEST(Fallback, OfBRepsThatMayNotBeUsedNamesTheObject) {
  Scene scene = pressed_pin(hybrid::exact);
  for (BodyDescription& body : scene.bodies) body.use_brep = false;
  EXPECT_EQ(said_by(scene).answers.why,
            "no b-rep: 'block' was added with brep = false; no b-rep: 'pin' was added with brep = false");
}

// Of the pin's three faces the wall is not known: its contacts are the voxels', told apart from a mesh's.
TEST(Fallback, OfFacesOfAnUnknownKindCountsThem) {
  for (const bool drawn : {true, false}) {
    Scene scene = pressed_pin(hybrid::exact);
    Part& pin = scene.bodies[kPin].parts[0];
    pin.exact = drawn;
    for (Face& face : pin.faces)
      if (std::holds_alternative<Cylinder>(face.surface)) face.surface = OtherSurface();
    const std::string why =
        drawn ? "1 of 3 faces of 'pin' is of a kind that is not known" : "recovery declined 1 of 3 faces of 'pin'";
    const Said said = said_by(scene);
    EXPECT_EQ(said.met, Texts{why + ": contacts of 'block' and 'pin' there stay with the voxels"});
    EXPECT_EQ(said.answers.why, why);
    EXPECT_EQ(said.answers.fraction(), 1) << "the wall is where they touch";
    EXPECT_GT(said.totals.exact_frames_by_voxels, 0U);
  }
}

TEST(Fallback, WithoutAnyKnownFaceExactIsRestore) {
  Scene scene = pressed_pin(hybrid::exact);
  forget_surfaces(scene.bodies[kPin].parts[0]);
  const Said said = said_by(scene);
  EXPECT_EQ(said.answers.why, "3 of 3 faces of 'pin' are of a kind that is not known; 'restore' acts on them");
  EXPECT_EQ(said.answers.fraction(), 1);
}

TEST(Fallback, OfUnknownFacesIsToldUnderRestoreToo) {
  Scene scene = pressed_pin(hybrid::restore);
  forget_surfaces(scene.bodies[kPin].parts[0]);
  EXPECT_EQ(said_by(scene).answers.why,
            "3 of 3 faces of 'pin' are of a kind that is not known; 'restore' acts on the voxels' contacts");
}

// Faces declared by hand belong to voxels: `restore` uses them, `exact` cannot.
TEST(Fallback, OfFacesDeclaredByHandIsTold) {
  for (const Hybrid method : {hybrid::restore, hybrid::exact}) {
    Scene scene = pressed_pin(method);
    BodyDescription& pin = scene.bodies[kPin];
    pin.use_brep = false;
    pin.declared = std::make_shared<DeclaredFeatures>();
    const Face wall = [&] {
      for (const Face& face : pin.parts[0].faces)
        if (std::holds_alternative<Cylinder>(face.surface)) return face;
      return Face();
    }();
    const Declaring declaring(pin);
    const DeclaredFeatures::Entity entity = wall;
    for (std::uint32_t voxel = 0; voxel < declaring.surface_voxels(); ++voxel) {
      const Vector3d center = declaring.center(voxel);
      if (center.head<2>().norm() > 0.068) (void)declaring.give(pin, center, std::span(&entity, 1));
    }
    const std::string why = said_by(scene).answers.why;
    EXPECT_EQ(why, method == hybrid::restore
                       ? "'restore' acts on the voxels' contacts"
                       : "the faces of 'pin' were declared by hand: voxels know them, 'exact' does not; 'restore' acts "
                         "on them");
  }
}

// A body of two parts, one of which is a bare mesh: contacts of that one were lost, because all *faces* were known.
TEST(Fallback, OfAPartThatIsAMeshActsAndIsTold) {
  Scene scene = pressed_pin(hybrid::exact);
  BodyDescription& block = scene.bodies[kBlock];
  block.parts.push_back(scenes::part_of("stop", shapes::box({-0.02, -0.02, -0.14}, {0.02, 0.02, -0.0801})));
  scene.bodies[kPin].X_WB.position = {0, 0, 0.0159};  // its end is 4 mm in the stop
  const Said said = said_by(scene);
  const std::string why = "no b-rep: 1 of 2 parts of 'block' is of bare triangles (Model{ FILE, brep = true })";
  EXPECT_EQ(said.met, Texts{why + ": contacts of 'block' and 'pin' there stay with the voxels"});
  EXPECT_EQ(said.answers.why, why);
  EXPECT_GT(said.answers.by_voxels, 0U);
}

// What a script has switched off counts as what cannot be exact.
TEST(Fallback, SwitchedOffByAScriptIsTold) {
  const Said said = said_by(pressed_pin(hybrid::exact),
                            [](Simulation& simulation, int frame) { simulation.set_hybrid_enabled(kPin, frame != 0); });
  EXPECT_GT(said.answers.by_voxels, 0U);
  EXPECT_NE(said.answers.why.find("switched off in 1 of "), std::string::npos) << said.answers.why;
  EXPECT_EQ(said.totals.exact_frames_by_voxels, 1U);
  EXPECT_EQ(said.totals.exact_frames, said.totals.collision_frames);
}

TEST(Fallback, OfTheLesserOfTwoMethodsIsNone) {
  Scene scene = pressed_pin(hybrid::exact);
  scene.bodies[kPin].hybrid = hybrid::restore;
  const Said said = said_by(scene);
  EXPECT_EQ(said.answers.method, "restore");
  EXPECT_EQ(said.totals.exact_frames, 0U);
}

std::vector<Event> events_of(Scene scene, const std::string& kind, int frames) {
  Simulation simulation(std::move(scene), {});
  for (int i = 0; i < frames; ++i) simulation.step();
  std::vector<Event> events = simulation.events();
  std::erase_if(events, [&](const Event& event) { return event.kind != kind; });
  return events;
}

TEST(Gravity, ThatActsOnNothingIsTold) {
  Scene scene = scenes::pin_in_hole();
  EXPECT_TRUE(events_of(scene, "gravity", 1).empty()) << "there is none";
  scene.devices = scenes::pin_in_hole().devices;
  scene.parameters.gravity = {0, 0, -9.81};
  const std::vector<Event> held = events_of(scene, "gravity", 1);
  ASSERT_EQ(held.size(), 1U);
  EXPECT_EQ(held[0].text,
            "gravity (0, 0, -9.81) m/s^2 acts on no body, held ones neither: it does with allBodiesAreDynamic = true");
  scene.devices = scenes::pin_in_hole().devices;
  scene.parameters.all_bodies_are_dynamic = true;
  EXPECT_TRUE(events_of(scene, "gravity", 1).empty());
}

// A box of 60 mm on voxels of 5 mm has some 12 x 12 contacts: at 10 kN/m each they carry 7.2 kN a voxel deep. 0.5 kg
// weigh 4.9 N; contacts of 2 N/m carry 1.4 N.
TEST(Sinking, IsToldOfABodyThatIsTooHeavyForItsContacts) {
  for (const Integrator integrator : {Integrator::semi_implicit, Integrator::implicit}) {
    Scene scene = scenes::falling_boxes(1, integrator);
    scene.bodies[1].density = 2300;
    EXPECT_TRUE(events_of(scene, "sinking", 500).empty());
    scene.parameters.contact_stiffness = 2;
    const std::vector<Event> soft = events_of(scene, "sinking", 500);
    ASSERT_EQ(soft.size(), 1U) << "once for each body";
    EXPECT_NE(soft[0].text.find("'box0' weighs 4.87 N and sinks"), std::string::npos) << soft[0].text;
    EXPECT_NE(soft[0].text.find("raise contactStiffness (now 2 N/m)"), std::string::npos) << soft[0].text;
  }
}

}  // namespace
}  // namespace verisim::fallback_test
