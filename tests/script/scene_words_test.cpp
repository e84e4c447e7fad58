// defineSimulationParameters and addObject: what a script says is what the scene holds, and what it says wrong is
// refused with place, reason and remedy.
#include <gtest/gtest.h>

#include "engine/base/pinned_math.hpp"
#include "tests/script/written_scenario.hpp"

namespace verisim::scene_words_test {
namespace {

TEST(DefineSimulationParameters, SetsEveryNameOfTheInterface) {
  WrittenScenario written(R"(defineSimulationParameters{
    timestep = 0.002, gravity = {0, 0, -9.81}, seed = 7, duration = 3, frameRate = 30, integrator = "implicit",
    hybrid = "off", contact = "fcl", alignment = "pavlik", reduction = "exactly-one", maxStiffness = 1000, maxAngularStiffness = 0.2, allBodiesAreDynamic = true,
    limitCouplerDampingForce = true, precision = 1, contactStiffness = 5000, contactDampingRatio = 0.7, exactStiffness = 1e9, exactFriction = 1e-3, restitution = 0.4,
    restitutionSpeed = 0.02, passiveContacts = false, graspDistance = 0.2 })");
  const Scene& scene = written.build();
  const SimulationParameters& p = scene.parameters;
  EXPECT_EQ(p.timestep, 0.002);
  EXPECT_EQ(p.gravity, Vector3d(0, 0, -9.81));
  EXPECT_EQ(p.seed, 7u);
  EXPECT_EQ(p.duration, 3);
  EXPECT_EQ(p.frame_rate, 30);
  EXPECT_EQ(p.integrator, Integrator::implicit);
  EXPECT_EQ(p.hybrid, hybrid::off);
  EXPECT_EQ(p.contact, ContactMethod::fcl);
  EXPECT_EQ(p.alignment, AlignmentMeasure::pavlik);
  EXPECT_EQ(p.reduction, Reduction::exactly_one);
  EXPECT_EQ(p.max_stiffness, 1000);
  EXPECT_EQ(p.max_angular_stiffness, 0.2);
  EXPECT_TRUE(p.all_bodies_are_dynamic);
  EXPECT_EQ(p.contact_stiffness, 5000);
  EXPECT_EQ(p.contact_damping_ratio, 0.7);
  EXPECT_EQ(p.exact_stiffness, 1e9);
  EXPECT_EQ(p.exact_friction, 1e-3);
  EXPECT_EQ(p.restitution, 0.4);
  EXPECT_EQ(p.restitution_speed, 0.02);
  EXPECT_FALSE(p.passive_contacts);
  EXPECT_EQ(scene.grasp_distance, 0.2);
}

TEST(DefineSimulationParameters, GivesWayToTheCommandLine) {
  WrittenScenario written("defineSimulationParameters{seed = 7, duration = 3}");
  written.options.seed = 9;
  written.options.duration = 0.5;
  const Scene& scene = written.build();
  EXPECT_EQ(scene.parameters.seed, 9u);
  EXPECT_EQ(scene.parameters.duration, 0.5);
}

TEST(DefineSimulationParameters, RefusesWhatIsWrongWithPlaceAndRemedy) {
  const std::string unknown = refusal_of("\ndefineSimulationParameters{maxStifness = 300}");
  EXPECT_EQ(
      unknown.rfind("pin.lua:2: defineSimulationParameters has no 'maxStifness'; did you mean 'maxStiffness'? (", 0),
      0u)
      << unknown;
  EXPECT_EQ(refusal_of("defineSimulationParameters{timestep = 'fast'}"),
            "pin.lua:1: defineSimulationParameters: timestep must be a number, not a text ('fast')");
  EXPECT_EQ(refusal_of("defineSimulationParameters{timestep = 0}"),
            "pin.lua:1: defineSimulationParameters: timestep is 0 but must be above 0");
  EXPECT_NE(refusal_of("defineSimulationParameters{gravity = {0, 0/0, 0}}").find("gravity[2] is"), std::string::npos);
  EXPECT_NE(refusal_of("defineSimulationParameters{maxStiffness = 1/0}").find("must be finite"), std::string::npos);
  EXPECT_NE(refusal_of("defineSimulationParameters{integrator = 'implicit-euler'}").find("did you mean 'implicit'?"),
            std::string::npos);
  EXPECT_NE(refusal_of("defineSimulationParameters{hybrid = 'blended'}").find("did you mean 'blend'?"),
            std::string::npos);
  EXPECT_NE(refusal_of("defineSimulationParameters{contact = 'bullet'}").find("; known: fcl, voxmap"),
            std::string::npos);
  EXPECT_NE(refusal_of("defineSimulationParameters{alignment = 'bytype'}").find("did you mean 'by-type'?"),
            std::string::npos);
  EXPECT_NE(
      refusal_of("defineSimulationParameters{restitution = 1.5}").find("restitution is 1.5 but must be from 0 to 1"),
      std::string::npos);
  EXPECT_NE(refusal_of("defineSimulationParameters{restitution = 0/0}"), "");
  EXPECT_NE(refusal_of("defineSimulationParameters{exactFriction = -1}").find("exactFriction is -1 but must be from 0"),
            std::string::npos);
  EXPECT_NE(
      refusal_of("defineSimulationParameters{exactStiffness = 0}").find("exactStiffness is 0 but must be above 0"),
      std::string::npos);
  EXPECT_NE(refusal_of("defineSimulationParameters{reduction = 'one'}").find("; known: common-freedom, exactly-one"),
            std::string::npos);
  EXPECT_EQ(
      refusal_of("defineSimulationParameters(3)"),
      "pin.lua:1: defineSimulationParameters is called with 3; call it with a table: defineSimulationParameters{ … }");
}

TEST(AddObject, DescribesABody) {
  WrittenScenario written(R"(
    local pin = addObject{ name = "pin", position = {1, 2, 3}, orientation = AngleAxis(Degrees(90), Axis{0, 0, 1}),
      density = 10, voxelsize = 0.01, pointspacing = 0.02, brep = false, fixed = true, selectable = false, hybrid = "off",
      velocity = {0, 0, 1}, angularVelocity = {1, 0, 0}, Solid.box{0.1, 0.2, 0.3} }
    assert(pin.name == "pin" and pin.voxelsize.value == 0.01)
    assert(math.abs(pin.mass - 0.06) < 1e-12)
    assert(pin.position == osg.Vec3(1, 2, 3) and pin.pose.position[2] == 2)
    assert((pin.orientation * osg.Vec3(1, 0, 0) - osg.Vec3(0, 1, 0)):length() < 1e-15)
    assert((osg.Vec3(0.5, 0, 0) * pin.matrix - osg.Vec3(1, 2.5, 3)):length() < 1e-15)
    assert(tostring(pin) == "body 'pin'"))");
  const Scene& scene = written.build();
  ASSERT_EQ(scene.bodies.size(), 1u);
  const BodyDescription& body = scene.bodies[0];
  EXPECT_EQ(body.name, "pin");
  EXPECT_EQ(body.X_WB.position, Vector3d(1, 2, 3));
  EXPECT_EQ(body.density, 10);
  EXPECT_EQ(body.voxel_size, 0.01);
  EXPECT_EQ(body.point_spacing, 0.02);
  EXPECT_FALSE(body.use_brep);
  EXPECT_TRUE(body.fixed);
  EXPECT_FALSE(body.selectable);
  EXPECT_EQ(body.hybrid, hybrid::off);
  EXPECT_EQ(body.twist.linear, Vector3d(0, 0, 1));
  EXPECT_EQ(body.twist.angular, Vector3d(1, 0, 0));
}

// A model with one placement: scale goes into the geometry, the placement into the start pose, below the object's own.
TEST(AddObject, PutsOnePlacementIntoThePose) {
  WrittenScenario written(R"(
    addObject{ position = {1, 0, 0}, orientation = AngleAxis(math.pi / 2, Axis{0, 0, 1}), voxelsize = 0.01,
      Transform{ scale = 2, Transform{ position = {0.5, 0, 0}, Solid.box{0.1, 0.1, 0.1} } } })");
  const BodyDescription& body = written.build().bodies[0];
  // 2 * 0.5 along x of the object, which points along y of the world.
  EXPECT_LT((body.X_WB.position - Vector3d(1, 1, 0)).norm(), 1e-15);
  const Bounds bounds = bounds_of(body.parts[0].mesh);
  EXPECT_LT((bounds.size() - Vector3d(0.2, 0.2, 0.2)).norm(), 1e-9);
  EXPECT_LT(bounds.center().norm(), 1e-9);
}

TEST(AddObject, MakesOneBodyOfSeveralPlacedSolids) {
  WrittenScenario written(R"(
    local body = addObject{ name = "dumbbell", position = {0, 0, 5}, voxelsize = 0.01,
      Transform{ position = {-1, 0, 0}, orientation = AngleAxis(math.pi / 2, Axis{0, 1, 0}), Solid.cylinder{radius = 0.1, height = 0.2} },
      Group{ Transform{ position = {1, 0, 0}, Solid.box{0.2, 0.2, 0.2} } } })");
  const BodyDescription& body = written.build().bodies[0];
  EXPECT_EQ(body.X_WB.position, Vector3d(0, 0, 5));
  ASSERT_EQ(body.parts.size(), 2u);
  EXPECT_LT((body.parts[0].mass.centroid - Vector3d(-1, 0, 0)).norm(), 1e-9);
  EXPECT_LT((bounds_of(body.parts[1].mesh).center() - Vector3d(1, 0, 0)).norm(), 1e-9);
  // The cylinder's axis is turned with its mesh: from z to x.
  int cylinders = 0;
  for (const Face& face : body.parts[0].faces)
    if (const auto* cylinder = std::get_if<Cylinder>(&face.surface)) {
      ++cylinders;
      EXPECT_NEAR(std::abs(cylinder->direction.x()), 1, 1e-12);
      EXPECT_NEAR(cylinder->point.z(), 0, 1e-12);
    }
  EXPECT_EQ(cylinders, 1);
  const Matrix3d inertia = body.parts[0].mass.inertia;
  EXPECT_LT(inertia(0, 0), inertia(2, 2) + 1e-12);
}

TEST(Solids, AreCutJoinedAndMoved) {
  WrittenScenario written(R"(
    local block = Solid.box{1, 1, 1} - Solid.cylinder{radius = 0.25, height = 1}
    local both = Solid.box{1, 1, 1} + Solid.box{1, 1, 1}:translate{0.5, 0, 0}
    local common = Solid.box{1, 1, 1} * Solid.box{1, 1, 1}:translate(0.5, 0, 0)
    local turned = Solid.box{2, 1, 1}:rotate(AngleAxis(math.pi / 2, Axis{0, 0, 1}))
    for _, solid in ipairs{block, both, common, turned} do addObject{ voxelsize = 0.05, solid } end)");
  const Scene& scene = written.build();
  const double volumes[] = {1 - pinned::kPi / 16, 1.5, 0.5, 2};
  ASSERT_EQ(scene.bodies.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(scene.bodies[i].parts[0].mass.volume, volumes[i], 1e-9) << i;
  EXPECT_NEAR(bounds_of(scene.bodies[3].parts[0].mesh).size().y(), 2, 1e-9);
  EXPECT_EQ(scene.bodies[0].name, "body");
  EXPECT_EQ(scene.bodies[3].name, "body4");
}

TEST(Solids, OfImpossibleSizesAreRefusedAtTheirLine) {
  EXPECT_EQ(refusal_of("\nlocal s = Solid.sphere{radius = -1}").rfind("pin.lua:2: ", 0), 0u);
  EXPECT_NE(refusal_of("Solid.torus{ringRadius = 1, radius = 1}"), "");
  EXPECT_EQ(refusal_of("Solid.torus{ringRadius = 2, radius = 1}"), "");
  EXPECT_NE(refusal_of("Solid.tube{outer = 1, inner = 2, height = 1}"), "");
  EXPECT_NE(refusal_of("Solid.cylinder{radius = 1}").find("Solid.cylinder needs height"), std::string::npos);
  EXPECT_NE(refusal_of("Solid.cylinder{radius = 1, hieght = 2}"), "");
  EXPECT_NE(refusal_of("local x = Solid.box{1, 1, 1} - 3"), "");
}

TEST(AddObject, RefusesWhatIsWrongWithPlaceAndRemedy) {
  EXPECT_EQ(refusal_of("\n\naddObject{ name = 'hole', voxelsize = 0, Solid.box{0.15, 0.1, 0.1} }"),
            "pin.lua:3: voxelsize is 0 m but must be above 0; 'hole' measures 0.15 m, mm(3) is usual");
  EXPECT_NE(refusal_of("addObject{ densty = 3, Solid.box{1, 1, 1} }")
                .find("addObject has no 'densty'; did you mean 'density'?"),
            std::string::npos);
  EXPECT_NE(refusal_of("addObject{ density = -1, Solid.box{1, 1, 1} }").find("density is -1 but must be above 0"),
            std::string::npos);
  EXPECT_NE(refusal_of("addObject{ name = 'pin' }").find("has no geometry"), std::string::npos);
  EXPECT_NE(refusal_of("addObject{ position = {1, 2}, Solid.box{1, 1, 1} }").find("three numbers"), std::string::npos);
  EXPECT_NE(refusal_of("addObject{ name = 'a', Solid.box{1, 1, 1} } addObject{ name = 'a', Solid.box{1, 1, 1} }")
                .find("already"),
            std::string::npos);
  EXPECT_EQ(refusal_of("\naddObject{ Model 'gone.stl' }").rfind("pin.lua:2: gone.stl: there is no such file", 0), 0u);
  EXPECT_NE(refusal_of("addObject{ 3 }").find("addObject: child 1 must be a node, not 3"), std::string::npos);
}

// Sharing and nesting make few nodes stand for very many: each of these would fill the machine or its stack.
TEST(Nodes, ThatMultiplyThemselvesAreRefused) {
  EXPECT_NE(refusal_of("local s = Solid.box{1, 1, 1} for i = 1, 100 do s = s + s end").find("more than 1000 pieces"),
            std::string::npos);
  EXPECT_NE(refusal_of("local s = Solid.box{1, 1, 1} for i = 1, 1e6 do s = s:translate{1, 0, 0} end")
                .find("more than 1000 pieces"),
            std::string::npos);
  EXPECT_NE(
      refusal_of("local g = Group{} for i = 1, 60 do g = Group{g, g} end addObject{ g }").find("more than 10000 nodes"),
      std::string::npos);
  EXPECT_NE(refusal_of("local g = Group{} g:addChild(g)").find("nothing can hold itself"), std::string::npos);
  EXPECT_NE(refusal_of("local g = Group{} local h = Group{ Group{ g } } g:addChild(h)").find("nothing can hold itself"),
            std::string::npos);
  EXPECT_NE(refusal_of("local g = Group{} for i = 1, 3e5 do g = Group{ g } end addObject{ g }").find("deep; flatten"),
            std::string::npos);
  EXPECT_NE(refusal_of("for i = 1, 1e6 do addObject{ voxelsize = 0.1, Solid.box{1, 1, 1} } end")
                .find("without coming to an end"),
            std::string::npos);
}

// A cube of 2 units as an OBJ file: 8 corners, 12 triangles, outward.
constexpr const char* kCube = R"(v -1 -1 -1
v 1 -1 -1
v 1 1 -1
v -1 1 -1
v -1 -1 1
v 1 -1 1
v 1 1 1
v -1 1 1
f 1 3 2
f 1 4 3
f 5 6 7
f 5 7 8
f 1 2 6
f 1 6 5
f 2 3 7
f 2 7 6
f 3 4 8
f 3 8 7
f 4 1 5
f 4 5 8
)";

TEST(Model, TakesTheScaleOfItsTransform) {
  WrittenScenario written("addObject{ voxelsize = 0.01, Transform{ scale = 0.1, Model 'cube.obj' } }");
  written.write("cube.obj", kCube);
  const BodyDescription& body = written.build().bodies[0];
  EXPECT_EQ(body.name, "cube");
  EXPECT_NEAR(body.parts[0].mass.volume, 0.008, 1e-12);
}

TEST(Model, OfAFormatThatCannotBeReadComesFromItsSibling) {
  WrittenScenario written("addObject{ voxelsize = 0.1, Model [[models\\cube.osg]] }");
  written.write("models/cube.obj", kCube);
  written.build();
  ASSERT_EQ(written.scenario->notices().size(), 1u);
  EXPECT_EQ(written.scenario->notices()[0],
            "pin.lua:1: models\\cube.osg is in a format that cannot be read; models/cube.obj is read in its place");
}

// '/' would make groups within groups of the run file, where nobody looks for them.
TEST(Names, ThatWouldBreakTheRunFileAreReplacedAndSaidSo) {
  for (const std::string word :
       {"addObject{ name = 'a/b', Solid.box{1, 1, 1}, voxelsize = 0.1 }",
        "addDevice(Devices.Hand{ name = 'a/b', path = {{0, 0, 0}} })",
        "addDevice(Devices.Sensable.PhantomOmni{ name = 'a/b' })", "WiiHead{ name = 'a/b' }"}) {
    WrittenScenario written(word);
    written.run(1);
    const auto notices = written.scenario->notices();
    EXPECT_EQ(std::count_if(notices.begin(), notices.end(),
                            [](const std::string& n) { return n.find("name 'a/b' is recorded as 'a_b'") != n.npos; }),
              1)
        << word;
    bool recorded = false;
    Schema schema;
    written.simulation->describe(schema);
    for (const Column& column : schema.columns()) {
      EXPECT_EQ(column.path.find("a/b"), std::string::npos) << column.path;
      recorded = recorded || column.path.find("/a_b/") != std::string::npos;
    }
    EXPECT_TRUE(recorded) << word;
  }
  for (const std::string name : {"''", "'.'"})
    EXPECT_NE(WrittenScenario("addDevice(Devices.Hand{ name = " + name + ", path = {{0, 0, 0}} })").refusal(), "");
}

TEST(ModelParts, ListsWhatAFileHolds) {
  WrittenScenario written(R"(
    local parts = modelParts("cube.obj", {scale = 0.5})
    assert(#parts == 1 and parts[1].index == 1)
    assert(math.abs(parts[1].volume - 1) < 1e-12)
    assert(parts[1].bounds[2][1] == 0.5 and parts[1].bounds.min:x() == -0.5)
    addObject{ voxelsize = 0.1, Model{ "cube.obj", part = 1, scale = 0.5 } })");
  written.write("cube.obj", kCube);
  EXPECT_EQ(written.refusal(), "");
  WrittenScenario beyond("addObject{ voxelsize = 0.1, Model{ 'cube.obj', part = 2 } }");
  beyond.write("cube.obj", kCube);
  EXPECT_NE(beyond.refusal().find("has no part 2; it has 1"), std::string::npos);
}

// The idiom of SPARTA's published scripts: colour a node through its state set, then scale it.
TEST(Drawing, IsIgnoredAndSaidOnce) {
  WrittenScenario written(R"(
    function color(node, c)
      local mat = osg.Material()
      mat:setColorMode(0x1201)
      mat:setAmbient(0x0408, osg.Vec4(c[1], c[2], c[3], 1.0))
      local ss = node:getOrCreateStateSet()
      ss:setAttributeAndModes(mat, osg.StateAttribute.Values.ON + osg.StateAttribute.Values.OVERRIDE)
      return node
    end
    for i = 1, 3 do addObject{ voxelsize = 0.1, Transform{ scale = 0.5, color(Solid.box{1, 1, 1}, {0, 1, 0}) } } end
    RelativeTo.World:addChild(TransparentGroup{ alpha = 0.5, Model "cube.obj" })
    snx.SoundInfo("x.wav"))");
  written.write("cube.obj", kCube);
  ASSERT_EQ(written.refusal(), "");
  int materials = 0;
  for (const std::string& notice : written.scenario->notices())
    materials += notice.find("osg.Material ") != std::string::npos ? 1 : 0;
  EXPECT_EQ(materials, 1);
}

}  // namespace
}  // namespace verisim::scene_words_test
