// Faces and edges declared by hand: what a script says of a body's voxels is what the scene holds, and what it says
// wrong is refused with place, reason and remedy.
#include <gtest/gtest.h>

#include "tests/script/written_scenario.hpp"

namespace verisim::brep_words_test {
namespace {

// A cube of 40 mm in voxels of 5 mm: its sides lie between voxels or in them, its surface is known by |x|, |y|, |z|.
constexpr const char* kCube = "local cube = addObject{name = 'cube', voxelsize = 0.005, Solid.box{0.04, 0.04, 0.04}}\n";

TEST(ForeachSurfaceVoxel, GivesTheCentreOfEveryVoxelThatTheSurfacePassesThrough) {
  WrittenScenario written(std::string(kCube) + R"(
    local count, last = 0, {}
    cube:foreachSurfaceVoxel(function(x, y, z)
      count = count + 1
      local largest = math.max(math.abs(x), math.abs(y), math.abs(z))
      assert(math.abs(largest - 0.02) <= 0.0025 + 1e-12)
      return 0
    end)
    outcome(tostring(count)))");
  written.build();
  const int count = std::stoi(written.scenario->outcome());
  EXPECT_GE(count, 6 * 8 * 8) << "no fewer than a layer of voxels on each side";
}

TEST(AddFeatureSet, GivesAVoxelTheSetAndNumbersSetsFromOne) {
  WrittenScenario written(std::string(kCube) + R"(
    local top = Plane()
    top.point, top.normal = {0, 0, 0.02}, osg.Vec3(0, 0, 3)
    local bore = Cylinder()
    bore.center, bore.normal, bore.radius = {0, 0, 0}, {0, 0, 1}, 0.02
    local one, two = FeatureSet(), FeatureSet()
    one:insert(BoundaryFeature(top))
    two:insert(BoundaryFeature(top))
    two:insert(BoundaryFeature(bore))
    cube:foreachSurfaceVoxel(function(x, y, z)
      if z < 0.016 then return 0 end
      local id = cube:addFeatureSet(x > 0 and two or one, x, y, z)
      assert(id == (x > 0 and 2 or 1) or id == (x > 0 and 1 or 2))
    end)
    assert(cube:getFeatureSet(1).size + cube:getFeatureSet(2).size == 3)
    assert(cube:getFeatureSet(0).size == 0)
    assert(two.size == 2 and one.size == 1))");
  const Scene& scene = written.build();
  ASSERT_TRUE(scene.bodies[0].declared);
  const DeclaredFeatures& declared = *scene.bodies[0].declared;
  EXPECT_EQ(declared.size(), 2U);
  ASSERT_EQ(declared.faces().size(), 2U) << "the plane of both sets is one entity";
  for (const Face& face : declared.faces()) {
    if (const auto* plane = std::get_if<Plane>(&face.surface)) {
      EXPECT_EQ(plane->normal, Vector3d(0, 0, 1));
    }
    if (const auto* cylinder = std::get_if<Cylinder>(&face.surface)) {
      EXPECT_EQ(cylinder->radius, 0.02);
    }
  }
}

TEST(Shapes, HaveTheFieldsOfTheirKind) {
  WrittenScenario written(R"(
    local cone = Cone()
    cone.center, cone.normal, cone.radius, cone.halfAngle = {1, 2, 3}, {0, 1, 0}, 0.02, 0.5
    assert(cone.center == osg.Vec3(1, 2, 3) and cone.halfAngle == 0.5 and cone.normal == osg.Vec3(0, 1, 0))
    local torus = Torus()
    torus.majorRadius, torus.minorRadius = 0.03, 0.01
    local line = Line()
    line.point, line.direction = {0, 0, 1}, {1, 0, 0}
    local circle, ball = Circle(), Sphere()
    circle.radius, ball.radius = 0.1, 0.2
    local set = FeatureSet()
    for _, shape in ipairs{cone, torus, line, circle, ball} do set:insert(shape) end
    assert(set.size == 5))");
  EXPECT_EQ(written.refusal(), "");
}

TEST(BoundaryFeature, TakesAShapeAsItIsThen) {
  WrittenScenario written(std::string(kCube) + R"(
    local c = Circle()
    c.radius = 0.02
    local feature = BoundaryFeature(c)
    c.radius = 0.03
    local set = FeatureSet()
    set:insert(feature)
    cube:foreachSurfaceVoxel(function(x, y, z)
      if math.abs(z) < 0.005 then cube:addFeatureSet(set, osg.Vec3(x, y, z)) end
    end))");
  const DeclaredFeatures& declared = *written.build().bodies[0].declared;
  ASSERT_EQ(declared.edges().size(), 1U);
  EXPECT_EQ(std::get<Circle>(declared.edges()[0].curve).radius, 0.02);
}

TEST(BrepWords, LeaveTheDrawnBallToDrawing) {
  WrittenScenario written("Transform{ position = {0, 0, 0}, Sphere{radius = 1} }");
  EXPECT_EQ(written.refusal(), "");
}

TEST(BrepWords, RefuseWhatIsWrongWithPlaceAndRemedy) {
  const std::string cube(kCube);
  EXPECT_EQ(refusal_of("Cylinder().centre = {0, 0, 0}"),
            "pin.lua:1: a Cylinder has no 'centre'; did you mean 'center'? (center, normal, radius)");
  EXPECT_EQ(refusal_of("Plane{point = {0, 0, 0}}").rfind("pin.lua:1: Plane is called with a table", 0), 0U);
  EXPECT_NE(refusal_of("Circle().radius = 0/0").find("Circle: radius"), std::string::npos);
  EXPECT_NE(refusal_of("FeatureSet():insert(3)").find("must be a shape, not 3"), std::string::npos);
  EXPECT_EQ(refusal_of("local p = Plane()\np.normal = {0, 0, 0}\nFeatureSet():insert(p)"),
            "pin.lua:3: a Plane's normal is {0, 0, 0} but must have a direction");
  EXPECT_EQ(refusal_of(cube + "cube:addFeatureSet(FeatureSet(), 0, 0, 0)"),
            "pin.lua:2: (0, 0, 0) is in no surface voxel of 'cube'; give the centre of one");
  EXPECT_EQ(refusal_of(cube + "cube:getFeatureSet(1)"), "pin.lua:2: getFeatureSet: 'cube' has no set 1; 0 were added");
  EXPECT_NE(refusal_of(cube + "cube:foreachSurfaceVoxel(7)").find("call it with a function of x, y, z"),
            std::string::npos);
  const std::string no_radius = refusal_of(cube + R"(local set = FeatureSet()
    set:insert(Cylinder())
    cube:foreachSurfaceVoxel(function(x, y, z) cube:addFeatureSet(set, x, y, z) end))");
  EXPECT_NE(no_radius.find("'cube': a declared cylinder has a radius of 0 m"), std::string::npos) << no_radius;
}

/// The refusal of a shape that is given to the voxels of the cube's top, whose centres lie in z = top.
std::string given_to_the_top(const std::string& shape) {
  return refusal_of(std::string(kCube) + shape + R"(
    local set = FeatureSet()
    set:insert(shape)
    cube:foreachSurfaceVoxel(function(x, y, z)
      if z > 0.016 then cube:addFeatureSet(set, x, y, z) end
    end))");
}

// Every size of every shape that is none: zero, below zero, or an angle that is no cone's.
TEST(BrepWords, RefuseShapesThatAreNone) {
  struct Row {
    const char* shape;
    const char* refusal;  ///< "": taken
  };
  constexpr const char* kAbove = "but it must be above 0";
  constexpr const char* kAngle = "but it must be above 0 and below pi/2, 90 degrees";
  const Row rows[] = {
      {"Cylinder()\nshape.radius = 0", kAbove},
      {"Cylinder()\nshape.radius = -0.02",
       "'cube': a declared cylinder has a radius of -0.02 m but it must be above 0"},
      {"Cylinder()\nshape.normal, shape.radius = {1, 0, 0}, 0.02", ""},
      {"Sphere()\nshape.radius = 0", kAbove},
      {"Sphere()\nshape.radius = -0.02", "'cube': a declared sphere has a radius of -0.02 m but it must be above 0"},
      {"Sphere()\nshape.radius = 0.03", ""},
      {"Circle()\nshape.radius = 0", kAbove},
      {"Circle()\nshape.radius = -0.02", "'cube': a declared circle has a radius of -0.02 m but it must be above 0"},
      {"Cone()\nshape.radius, shape.halfAngle = -0.001, 0.5",
       "'cube': a declared cone has a radius of -0.001 m but it must be 0 or more"},
      {"Cone()\nshape.center, shape.radius, shape.halfAngle = {0, 0, 0.02}, 0, 1.5", ""},
      {"Cone()\nshape.radius, shape.halfAngle = 0.02, 0", kAngle},
      {"Cone()\nshape.radius, shape.halfAngle = 0.02, -0.5", kAngle},
      {"Cone()\nshape.radius, shape.halfAngle = 0.02, math.pi / 2", kAngle},
      {"Cone()\nshape.radius, shape.halfAngle = 0.02, 2", "'cube': a declared cone has a half angle of 2 rad"},
      {"Cone()\nshape.center, shape.radius, shape.halfAngle = {0, 0, 0.02}, 0.02, 1.5", ""},
      {"Torus()\nshape.majorRadius, shape.minorRadius = 0, 0.01", "a major radius of 0 m but it must be above 0"},
      {"Torus()\nshape.majorRadius, shape.minorRadius = -0.02, 0.01", "a major radius of -0.02 m"},
      {"Torus()\nshape.majorRadius, shape.minorRadius = 0.02, 0", "a minor radius of 0 m but it must be above 0"},
      {"Torus()\nshape.majorRadius, shape.minorRadius = 0.02, -0.01", "a minor radius of -0.01 m"},
      {"Torus()\nshape.majorRadius, shape.minorRadius = 0.02, 0.0201", "a minor radius of 0.0201 m"},
      {"Torus()\nshape.majorRadius, shape.minorRadius = 0.02, 0.02", ""},
  };
  for (const Row& row : rows) {
    const std::string refusal = given_to_the_top("local shape = " + std::string(row.shape));
    if (*row.refusal == '\0') {
      EXPECT_EQ(refusal, "") << row.shape;
    } else {
      EXPECT_NE(refusal.find(row.refusal), std::string::npos) << row.shape << ": " << refusal;
      EXPECT_EQ(refusal.rfind("pin.lua:", 0), 0U) << "names the place: " << refusal;
    }
  }
  for (const char* number : {"0/0", "1/0", "-1/0"}) {  // refused where it is set
    for (const char* field : {"Cylinder().radius", "Cone().radius", "Cone().halfAngle", "Sphere().radius",
                              "Torus().majorRadius", "Torus().minorRadius", "Circle().radius"}) {
      const std::string refusal = refusal_of(std::string(field) + " = " + number);
      EXPECT_EQ(refusal.rfind("pin.lua:1: ", 0), 0U) << field << " = " << number << ": " << refusal;
    }
  }
}

TEST(BrepWords, RefuseAShapeThatPassesNowhereNearTheVoxel) {
  const std::string far = given_to_the_top("local shape = Plane()\nshape.point = {0, 0, 7}");
  EXPECT_NE(far.find("'cube': the plane declared for the voxel at ("), std::string::npos) << far;
  EXPECT_NE(far.find(" mm away from it, 17.3 mm at most are taken"), std::string::npos) << far;
  for (const char* shape :
       {"Cylinder()\nshape.radius = 20", "Sphere()\nshape.radius = 20", "Circle()\nshape.radius = 20",
        "Line()\nshape.point, shape.direction = {0, 7, 0}, {1, 0, 0}"})
    EXPECT_NE(given_to_the_top("local shape = " + std::string(shape)).find(" mm away from it"), std::string::npos)
        << shape;
}

TEST(BrepWords, TakeAShapeThatIsTwoVoxelsOff) {
  for (const char* height : {"0.010", "0.030"})
    EXPECT_EQ(given_to_the_top("local shape = Plane()\nshape.point = {0, 0, " + std::string(height) + "}"), "");
}

TEST(BrepWords, AreForTheTimeInWhichTheSceneIsBuilt) {
  WrittenScenario written(std::string(kCube) + R"(
    defineSimulationParameters{duration = 1}
    Actions.addFrameAction(function() cube:foreachSurfaceVoxel(function() end) end))");
  written.run(20);
  const std::vector<std::string> errors = written.events("script error");
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_NE(errors[0].find("declare features while the scene is built"), std::string::npos) << errors[0];
}

}  // namespace
}  // namespace verisim::brep_words_test
