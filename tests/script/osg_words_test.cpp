// osg.Vec3, osg.Quat, osg.Matrix mean what they mean in OpenSceneGraph: row vectors, products from left to right.
#include <gtest/gtest.h>

#include "tests/script/written_scenario.hpp"

namespace verisim::osg_words_test {
namespace {

TEST(Vectors, HaveOpenSceneGraphsOperators) {
  EXPECT_EQ(refusal_of(R"lua(
    local a, b = osg.Vec3(1, 2, 3), osg.Vec3d(4, 5, 6)
    assert(a + b == osg.Vec3(5, 7, 9) and b - a == osg.Vec3(3, 3, 3) and -a == osg.Vec3(-1, -2, -3))
    assert(a * b == 32 and a * 2 == osg.Vec3(2, 4, 6) and 2 * a == a * 2 and a / 2 == osg.Vec3(0.5, 1, 1.5))
    assert(a ^ b == osg.Vec3(-3, 6, -3))
    assert(a:x() == 1 and a:y() == 2 and a:z() == 3 and a[1] == 1 and a[3] == 3 and a[4] == nil)
    assert(osg.Vec3(3, 4, 0):length() == 5 and osg.Vec3(3, 4, 0):length2() == 25)
    local n = osg.Vec3(0, 0, 5)
    assert(n:normalize() == 5 and n == osg.Vec3(0, 0, 1))
    assert(osg.Vec3() == osg.Vec3(0, 0, 0) and osg.Vec3(a) == a and Vec(1, 2, 3) == a and osg.Vec3{1, 2, 3} == a)
    assert(tostring(a) == "(1, 2, 3)"))lua"),
            "");
  EXPECT_NE(refusal_of("osg.Vec3(1, 'x', 2)").find("osg.Vec3: y must be a number"), std::string::npos);
  EXPECT_NE(refusal_of("local v = osg.Vec3() v.lenght()").find("did you mean 'length'?"), std::string::npos);
}

TEST(Rotations, ApplyTheLeftFactorFirst) {
  EXPECT_EQ(refusal_of(R"(
    local function near(a, b) return (a - b):length() < 1e-14 end
    local x, y, z = osg.Vec3(1, 0, 0), osg.Vec3(0, 1, 0), osg.Vec3(0, 0, 1)
    local qz, qx = AngleAxis(Degrees(90), Axis{0, 0, 1}), osg.Quat(math.pi / 2, x)
    assert(near(qz * x, y) and near(qx * y, z))
    assert(near((qz * qx) * x, qx * (qz * x)) and near((qz * qx) * x, z))
    assert(near(qz:inverse() * y, x) and near(qz:conj() * y, x))
    local half = osg.Quat()
    half:slerp(0.5, osg.Quat(), qz)
    assert(near(half * x, osg.Vec3(math.sqrt(0.5), math.sqrt(0.5), 0)))
    local from_to = osg.Quat()
    from_to:makeRotate(x, y)
    assert(near(from_to * x, y))
    assert(math.abs(qz:getAngle() - math.pi / 2) < 1e-14 and near(qz:getAxis(), z))
    assert(qz:w() > 0.7 and qz:z() > 0.7 and qz:x() == 0))"),
            "");
  EXPECT_NE(refusal_of("addObject{ orientation = {0, 0, 0, 0}, Solid.box{1, 1, 1} }").find("no rotation"),
            std::string::npos);
}

TEST(Matrices, ActOnRowVectorsFromTheLeft) {
  EXPECT_EQ(refusal_of(R"(
    local function near(a, b) return (a - b):length() < 1e-14 end
    local x, y = osg.Vec3(1, 0, 0), osg.Vec3(0, 1, 0)
    local T, R = osg.Matrix.translate(1, 2, 3), osg.Matrix.rotate(math.pi / 2, osg.Vec3(0, 0, 1))
    assert(near(x * T, osg.Vec3(2, 2, 3)) and T:getTrans() == osg.Vec3(1, 2, 3) and T(3, 0) == 1)
    assert(near(x * R, y) and near(R:preMult(x), y) and near(R:postMult(x), -y))
    assert(near(x * (R * T), osg.Vec3(1, 3, 3)) and near(x * (T * R), osg.Vec3(-2, 2, 3)))
    assert(near(x * (T * R):inverse() * (T * R), x))
    local M = osg.Matrixd()
    M:makeTranslate(osg.Vec3(1, 2, 3))
    assert(M == T)
    M:preMult(R)
    assert(M == R * T)
    M:mult(T, R)
    assert(M == T * R)
    M:setTrans(0, 0, 0)
    assert(near(M:getRotate() * x, y) and near(osg.Matrix.scale(2, 3, 4):getScale(), osg.Vec3(2, 3, 4)))
    assert(osg.Matrix.identity() == osg.Matrix() and osg.Matrix(T) == T))"),
            "");
  EXPECT_NE(refusal_of("osg.Matrix.scale(0, 1, 1):inverse()").find("no inverse"), std::string::npos);
}

TEST(MatrixTransform, TakesSimilaritiesOnly) {
  WrittenScenario written(
      "addObject{ voxelsize = 0.1, MatrixTransform{ matrix = osg.Matrix.scale(2, 2, 2) * osg.Matrix.translate(1, 2, "
      "3), "
      "Solid.box{1, 1, 1} } }");
  const BodyDescription& body = written.build().bodies[0];
  EXPECT_EQ(body.X_WB.position, Vector3d(1, 2, 3));
  EXPECT_NEAR(body.parts[0].mass.volume, 8, 1e-9);
  EXPECT_NE(refusal_of("MatrixTransform{ matrix = osg.Matrix.scale(1, 2, 1), Solid.box{1, 1, 1} }").find("stretches"),
            std::string::npos);
}

}  // namespace
}  // namespace verisim::osg_words_test
