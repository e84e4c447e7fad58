#include "engine/geometry/part.hpp"

#include "tests/geometry/models.hpp"

namespace verisim::part_test {
namespace {

using testing::error_of;
using testing::make;
using Kind = Solid::Kind;

Part with_cylinders(const std::string& name, std::vector<std::pair<double, bool>> radius_and_hole) {
  Part part;
  part.name = name;
  for (const auto& [radius, hole] : radius_and_hole) {
    part.faces.push_back({Cylinder{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, radius, hole}, {}, {}, 0, {}});
  }
  return part;
}

TEST(MatingCandidates, AreHolesAndPinsOfDifferentPartsWithNearlyEqualRadii) {
  const std::vector<Part> parts = {with_cylinders("plate", {{0.010, true}, {0.020, true}, {0.030, false}}),
                                   with_cylinders("pin", {{0.009, false}, {0.0199, false}, {0.010, true}})};
  const std::vector<Mate> mates = mating_candidates(parts);
  ASSERT_EQ(mates.size(), 2U);
  EXPECT_EQ(mates[0].part_a, "plate");
  EXPECT_EQ(mates[0].part_b, "pin");
  EXPECT_NEAR(mates[0].clearance(), 0.0001, 1e-12);
  EXPECT_NEAR(mates[1].clearance(), 0.001, 1e-12);
}

TEST(MatingCandidates, EndAtTheTolerance) {
  const std::vector<Part> parts = {with_cylinders("a", {{1, true}}), with_cylinders("b", {{0.75, false}})};
  EXPECT_EQ(mating_candidates(parts, 0.25).size(), 1U);
  EXPECT_EQ(mating_candidates(parts, 0.2499).size(), 0U);
}

// A bore is often two half cylinders, and the same bolt occurs often.
TEST(MatingCandidates, AreListedOnceEach) {
  const std::vector<Part> parts = {with_cylinders("a", {{1, true}, {1, true}}),
                                   with_cylinders("b", {{0.9, false}, {0.9, false}})};
  EXPECT_EQ(mating_candidates(parts).size(), 1U);
}

TEST(Tables, RoundTripIsExactToTheBit) {
  const Solid block = make(Kind::difference, make(Kind::box, {0.2, 0.2, 0.2}), make(Kind::cone, {0.05, 0.03, 0.4}));
  Part part = load_solid(make(Kind::sum, block, testing::placed(make(Kind::sphere, {0.06}), {0.1, 0.05, 0})), {});
  part.name = "block";
  part.color = {0.1F, 0.2F, 0.3F, 0.4F};
  part.notes = {"one thing", "another, with ü"};
  const std::vector<NamedArray> tables = to_tables(part);
  const Part back = from_tables("block", tables);
  const std::vector<NamedArray> again = to_tables(back);
  ASSERT_EQ(tables.size(), again.size());
  for (std::size_t i = 0; i < tables.size(); ++i) {
    EXPECT_EQ(tables[i].bytes, again[i].bytes) << tables[i].name;
    EXPECT_EQ(tables[i].shape, again[i].shape) << tables[i].name;
  }
  EXPECT_EQ(back.name, part.name);
  EXPECT_EQ(back.notes, part.notes);
  EXPECT_EQ(back.color, part.color);
  EXPECT_EQ(back.watertight, part.watertight);
  EXPECT_EQ(back.exact, part.exact);
  EXPECT_EQ(back.faces.size(), part.faces.size());
  EXPECT_EQ(back.mesh.vertices, part.mesh.vertices);
  EXPECT_EQ(testing::face_counts(back), testing::face_counts(part));
}

// Every number of a table's shape is that of its bytes: whoever stores it can trust it.
TEST(Tables, HaveShapesThatFitTheirBytes) {
  for (const NamedArray& table : to_tables(load_solid(make(Kind::tube, {0.05, 0.03, 0.2}), {}))) {
    std::size_t values = 1;
    for (const std::size_t n : table.shape) values *= n;
    EXPECT_EQ(values * size_of(table.dtype), table.bytes.size()) << table.name;
    EXPECT_FALSE(table.description.empty()) << table.name;
    EXPECT_FALSE(table.units.empty()) << table.name;
  }
}

TEST(Tables, OfAPartWithoutABrepComeBackWithoutOne) {
  Part part;
  part.mesh = testing::box_mesh({0, 0, 0}, {1, 1, 1});
  const Part back = from_tables("box", to_tables(part));
  EXPECT_FALSE(back.has_brep());
  EXPECT_EQ(back.mesh.triangles, part.mesh.triangles);
}

// Each table lost, and each shortened by its last byte: never a crash, always an error or (a note less) a sound part.
TEST(Tables, DamagedAreRefused) {
  const std::vector<NamedArray> sound = to_tables(load_solid(make(Kind::cylinder, {0.05, 0.4}), {}));
  for (std::size_t i = 0; i < sound.size(); ++i) {
    std::vector<NamedArray> damaged = sound;
    damaged.erase(damaged.begin() + static_cast<long>(i));
    const std::string error = error_of(ErrorKind::input, [&] { static_cast<void>(from_tables("pin", damaged)); });
    EXPECT_NE(error.find("'pin'"), std::string::npos) << error;
  }
  for (const char* name : {"triangles", "face_of_triangle", "face_edges", "edge_faces"}) {
    std::vector<NamedArray> damaged = sound;
    for (NamedArray& table : damaged) {
      if (table.name == name) table.bytes[2] = std::byte{0x7F};  // an index of millions
    }
    EXPECT_THROW(static_cast<void>(from_tables("pin", damaged)), Error) << name;
  }
  for (const char* name : {"face_kind", "edge_kind"}) {  // a kind that there is not
    std::vector<NamedArray> damaged = sound;
    for (NamedArray& table : damaged) {
      if (table.name == name) table.bytes[0] = std::byte{0x7F};
    }
    const std::string error = error_of(ErrorKind::input, [&] { static_cast<void>(from_tables("pin", damaged)); });
    EXPECT_NE(error.find("has kind 127"), std::string::npos) << error;
  }
}

TEST(Questions, AreAskedAboutAPart750MetresWide) {
  Part part;
  part.name = "peg";
  part.mesh = testing::box_mesh({0, 0, 0}, {750, 20, 30});
  const std::vector<std::string> questions = warnings_about(part);
  ASSERT_EQ(questions.size(), 1U);
  EXPECT_NE(questions[0].find("'peg' is 750 m wide"), std::string::npos) << questions[0];
  EXPECT_NE(questions[0].find("0.001"), std::string::npos) << questions[0];
}

TEST(Questions, AreAskedAboutAPartThinnerThanAHair) {
  Part part;
  part.mesh = testing::box_mesh({0, 0, 0}, {5e-6, 1e-6, 1e-6});
  EXPECT_EQ(warnings_about(part).size(), 1U);
}

TEST(Questions, AreNotAskedAboutUsualParts) {
  for (const double size : {1e-4, 0.05, 1.0, 50.0}) {
    Part part;
    part.mesh = testing::box_mesh({0, 0, 0}, {size, size, size});
    EXPECT_TRUE(warnings_about(part).empty()) << size;
  }
}

}  // namespace
}  // namespace verisim::part_test
