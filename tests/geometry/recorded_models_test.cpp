// The figures that the READMEs beside the shared models record.
#include <algorithm>
#include <cstring>
#include <set>
#include <sstream>

#include "tests/geometry/models.hpp"

namespace verisim::recorded_models_test {
namespace {

using Counts = std::map<std::string, int>;

#define SKIP_WITHOUT_MODELS() \
  if (!testing::models_are_here()) GTEST_SKIP() << "the shared models are not here: " << testing::model_path("")

struct Recorded {
  const char* file;
  std::size_t solids;
  Counts faces;
  double volume_mm3;
  std::vector<double> radii_mm;  ///< of cylinders, some that must be there; positive pins, negative holes
};

const std::vector<Recorded> kCadFiles = {
    {"freecad_cc0/axis.stp", 1, {{"cone", 1}, {"cylinder", 4}, {"plane", 5}}, 62586, {10, 12.5, 7.5}},
    {"freecad_cc0/bearing_20x37x9.stp",
     16,
     {{"cylinder", 6}, {"plane", 4}, {"sphere", 14}, {"torus", 6}},
     4679,
     {-10, 12.55, -15.95, 18.5}},
    {"freecad_cc0/engine_bushing.stp", 1, {{"cone", 4}, {"cylinder", 2}, {"plane", 2}}, 3364.6, {10, -8}},
    {"freecad_cc0/engine_conrod.stp", 1, {{"cylinder", 11}, {"plane", 22}}, 60545, {-10, -20, -2.5}},
    {"freecad_cc0/engine_conrod_cap.stp", 1, {{"cylinder", 7}, {"plane", 19}}, 23912, {-20, -3.25, -6}},
    {"freecad_cc0/engine_piston.stp", 1, {{"other", 2}, {"cylinder", 24}, {"plane", 28}}, 246733, {45, 42, -12.5}},
    {"freecad_cc0/engine_cylinder.stp", 1, {{"cylinder", 2}, {"plane", 2}}, 261140, {-45}},
    {"freecad_cc0/crank_base.stp", 1, {{"cylinder", 3}, {"plane", 9}}, 271990, {10, 20}},
    {"freecad_cc0/crank_disk.stp", 1, {{"cylinder", 3}, {"plane", 3}}, 455210, {-10.5, 10}},
    {"freecad_cc0/crank_arm.stp", 1, {{"cylinder", 3}, {"plane", 12}}, 133830, {-10}},
    {"occt/mal_vis.brep", 1, {{"cylinder", 2}, {"plane", 3}, {"torus", 1}}, 29177, {9, 20}},
    {"occt/mal_vis.stp", 1, {{"cylinder", 2}, {"plane", 3}, {"torus", 1}}, 29177, {9, 20}},
    {"occt/mal_tige.brep", 1, {{"cylinder", 4}, {"plane", 4}}, 259980, {-10}},
    {"occt/mal_tige.stp", 1, {{"cylinder", 4}, {"plane", 4}}, 259980, {-10}},
    {"occt/mal_ecrou.brep", 1, {{"cylinder", 1}, {"plane", 2}}, 30411, {22}},
    {"occt/mal_ecrou.stp", 1, {{"cylinder", 1}, {"plane", 2}}, 30411, {22}},
    {"occt/Axis_of_bearing.brep",
     17,
     {{"cone", 4}, {"cylinder", 19}, {"plane", 16}, {"sphere", 12}, {"torus", 12}},
     52896,
     {8.5, -8.5, -9.5, -10.5}},
    {"occt/Axis_of_bearing.stp",
     17,
     {{"cone", 4}, {"cylinder", 19}, {"plane", 16}, {"sphere", 12}, {"torus", 12}},
     52896,
     {8.5, -8.5, -9.5, -10.5}},
    {"occt/screw.step", 1, {{"cone", 2}, {"cylinder", 1}, {"plane", 4}, {"torus", 3}}, 3788, {5}},
};

class EveryCadFile : public ::testing::TestWithParam<Recorded> {};

TEST_P(EveryCadFile, HasTheRecordedSolidsFacesVolumeAndRadii) {
  SKIP_WITHOUT_MODELS();
  const Recorded& recorded = GetParam();
  const std::vector<Part> parts = testing::load(testing::model_path(recorded.file), {.angular_deflection = 0.25});
  EXPECT_EQ(parts.size(), recorded.solids);
  Counts faces;
  double volume = 0;
  std::set<double> radii;
  for (const Part& part : parts) {
    EXPECT_TRUE(part.watertight) << part.name;
    volume += part.mass.volume;
    // Of a sphere in steps of 0.25 rad, (1 - 0.25^2 / 6)^2 of the volume is left: 2 % are lost.
    EXPECT_NEAR(mass_properties_of(part.mesh).volume, part.mass.volume, 0.025 * part.mass.volume) << part.name;
    EXPECT_NEAR(area_of(part.mesh), part.area, 0.025 * part.area) << part.name;
    for (const auto& [type, count] : testing::face_counts(part)) faces[type] += count;
    for (const Face& face : part.faces) {
      if (const auto* c = std::get_if<Cylinder>(&face.surface)) radii.insert((c->hole ? -1000 : 1000) * c->radius);
    }
  }
  EXPECT_EQ(faces, recorded.faces);
  EXPECT_NEAR(volume * 1e9, recorded.volume_mm3, 1e-4 * recorded.volume_mm3);  // recorded with four or five digits
  for (const double radius : recorded.radii_mm) {
    EXPECT_TRUE(std::any_of(radii.begin(), radii.end(), [&](double r) { return std::abs(r - radius) < 1e-9; }))
        << "no cylinder of radius " << radius << " mm (negative: hole)";
  }
}

INSTANTIATE_TEST_SUITE_P(Readme, EveryCadFile, ::testing::ValuesIn(kCadFiles), [](const auto& p) {
  std::string name = std::filesystem::path(p.param.file).filename().string();
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return name;
});

/// For what does not depend on the tessellation.
const LoadOptions kCoarse = {.deflection = 1e-3, .angular_deflection = 1};

TEST(Names, OfTheBearingAreMadeUnique) {
  SKIP_WITHOUT_MODELS();
  std::set<std::string> names;
  for (const Part& part : testing::load(testing::model_path("freecad_cc0/bearing_20x37x9.stp"), kCoarse))
    names.insert(part.name);
  EXPECT_EQ(names.size(), 16U);
  EXPECT_TRUE(names.contains("Undefined"));
  EXPECT_TRUE(names.contains("Undefined#16"));
}

// The translator calls each solid "SOLID" below a product with the designer's name.
TEST(Names, ThatATranslatorInventedGiveWayToTheProducts) {
  SKIP_WITHOUT_MODELS();
  EXPECT_EQ(testing::load(testing::model_path("occt/Axis_of_bearing.stp"), kCoarse).front().name, "Axis_of_bearing_1");
}

// README: "already fully inserted in the hole at (30, 30)" mm; R9 in R10.
TEST(Mates, OfScrewAndBarAreTheRecordedPair) {
  SKIP_WITHOUT_MODELS();
  std::vector<Part> parts = testing::load(testing::model_path("occt/mal_tige.stp"));
  parts.push_back(testing::load(testing::model_path("occt/mal_vis.stp")).front());
  const std::vector<Mate> mates = mating_candidates(parts);
  const auto found =
      std::find_if(mates.begin(), mates.end(), [](const Mate& m) { return std::abs(m.clearance() - 0.001) < 1e-12; });
  ASSERT_NE(found, mates.end());
  EXPECT_NEAR(found->radius_hole, 0.010, 1e-13);
  EXPECT_NEAR(found->radius_pin, 0.009, 1e-13);
}

TEST(LoadModel, MultipliesAStepFilesUnitByTheScale) {
  SKIP_WITHOUT_MODELS();
  const std::string path = testing::model_path("occt/mal_vis.stp");
  const Part once = testing::load(path).front();
  const Part tenfold = testing::load(path, {.scale = 10}).front();
  EXPECT_NEAR(tenfold.mass.volume, 1000 * once.mass.volume, 1e-9 * tenfold.mass.volume);
}

// --- meshes
// -----------------------------------------------------------------------------------------------------------

struct RecordedMesh {
  const char* file;
  double scale;
  std::size_t triangles;
  std::size_t open_edges;  ///< of the file, after merging equal coordinates
  Vector3d size_mm;        ///< of the bounding box, 0 = not recorded
};

const std::vector<RecordedMesh> kMeshFiles = {
    {"agh_polygon_pegs/4gon_peg.stl", 1e-3, 12, 0, {0, 0, 100}},
    {"agh_polygon_pegs/4gon_box_t5mm.stl", 1e-3, 32, 0, {60, 60, 0}},
    {"agh_polygon_pegs/8gon_peg.stl", 1e-3, 28, 0, {0, 0, 100}},
    {"agh_polygon_pegs/8gon_box_t5mm.stl", 1e-3, 48, 0, {0, 0, 0}},
    {"factory_pegs/factory_round_peg_8mm_tight.obj", 1, 1152, 0, {7.995, 7.995, 50}},
    {"factory_pegs/factory_round_peg_8mm_loose.obj", 1, 1152, 0, {7.986, 7.986, 50}},
    {"factory_pegs/factory_round_hole_8mm_subdiv_3x.obj", 1, 900, 36, {25, 25, 0}},
    {"factory_pegs/factory_round_peg_16mm_loose.obj", 1, 1152, 0, {15.983, 15.983, 50}},
    {"factory_pegs/factory_round_hole_16mm_subdiv_3x.obj", 1, 900, 36, {0, 0, 0}},
    {"factory_pegs/factory_rectangular_peg_8mm_tight_subdiv_3x.obj", 1, 1792, 0, {8, 7, 50}},
    {"factory_pegs/factory_rectangular_peg_8mm_loose_subdiv_3x.obj", 1, 1792, 0, {7.964, 6.910, 50}},
    {"factory_pegs/factory_rectangular_hole_8mm_subdiv_3x.obj", 1, 1040, 72, {0, 0, 0}},
    {"factory_pegs/industreal_round_peg_8mm.obj", 1, 24192, 0, {7.986, 7.986, 50}},
    {"factory_pegs/industreal_tray_insert_round_peg_8mm.obj", 1, 29622, 0, {40, 40, 28}},
    {"factory_pegs/industreal_rectangular_peg_8mm.obj", 1, 1364, 0, {7.964, 6.910, 50}},
    {"factory_pegs/industreal_tray_insert_rectangular_peg_8mm.obj", 1, 21754, 0, {0, 0, 0}},
    {"nist_boards/taskboard_round_peg-1.STL", 1e-3, 288, 0, {12.66, 12.66, 50.8}},
    {"nist_boards/taskboard_square_peg-1.STL", 1e-3, 28, 0, {12.7, 50.8, 12.7}},
    {"nist_boards/taskboard-pegarray1-1.STL", 1e-3, 916, 20, {88.9, 6.35, 88.9}},
    {"nist_boards/taskboard-pegarray2-1.STL", 1e-3, 788, 20, {88.9, 88.9, 6.35}},
    {"nist_boards/taskboard_arraybase-1.STL", 1e-3, 368, 6, {88.9, 50.8, 139.7}},
    {"nist_boards/taskboard-arrayback-1.STL", 1e-3, 636, 0, {88.9, 95.25, 44.45}},
};

/// The file's triangles with nothing done but merging equal coordinates: not what the loader reads, so that the two
/// check each other. Binary and ASCII STL, OBJ with convex polygons.
TriangleMesh read_merged(const std::string& path) {
  const std::string content = testing::read_file(path);
  TriangleMesh mesh;
  std::map<std::array<float, 3>, std::uint32_t> merged;
  const auto number_of = [&](const std::array<float, 3>& p) {
    const auto [entry, is_new] = merged.try_emplace(p, static_cast<std::uint32_t>(merged.size()));
    if (is_new) mesh.vertices.emplace_back(p[0], p[1], p[2]);
    return entry->second;
  };
  std::vector<std::uint32_t> corners;  // in threes
  if (path.ends_with(".STL")) {
    for (std::size_t at = 84; at + 50 <= content.size(); at += 50) {
      std::array<std::array<float, 3>, 3> triangle;
      std::memcpy(triangle.data(), content.data() + at + 12, sizeof triangle);
      for (const auto& p : triangle) corners.push_back(number_of(p));
    }
  } else {
    std::istringstream lines(content);
    std::vector<std::uint32_t> listed;
    for (std::string line, word; std::getline(lines, line);) {
      std::istringstream words(line);
      words >> word;
      std::array<float, 3> p = {};
      if (word == "v" || word == "vertex") {
        words >> p[0] >> p[1] >> p[2];
        (word == "v" ? listed : corners).push_back(number_of(p));
      }
      if (word != "f") continue;
      std::vector<std::uint32_t> polygon;
      while (words >> word) polygon.push_back(listed.at(std::stoul(word) - 1));
      for (std::size_t i = 2; i < polygon.size(); ++i) {
        corners.insert(corners.end(), {polygon[0], polygon[i - 1], polygon[i]});
      }
    }
  }
  for (std::size_t i = 0; i + 3 <= corners.size(); i += 3) {
    mesh.triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
  }
  return mesh;
}

class EveryMeshFile : public ::testing::TestWithParam<RecordedMesh> {};

TEST_P(EveryMeshFile, HasTheRecordedTrianglesAndOpenEdges) {
  SKIP_WITHOUT_MODELS();
  const TriangleMesh mesh = read_merged(testing::model_path(GetParam().file));
  const MeshReport report = examine(mesh, false);
  EXPECT_EQ(mesh.triangles.size(), GetParam().triangles);
  EXPECT_EQ(report.open_edges, GetParam().open_edges);
  EXPECT_EQ(report.nonmanifold_edges, 0U);
}

TEST_P(EveryMeshFile, IsWatertightOnceLoadedAndSaysWhatWasClosed) {
  SKIP_WITHOUT_MODELS();
  const RecordedMesh& recorded = GetParam();
  const std::vector<Part> parts = testing::load(testing::model_path(recorded.file), {.scale = recorded.scale});
  ASSERT_EQ(parts.size(), 1U) << "the objects in the file are pieces of one surface";
  const Part& part = parts.front();
  SCOPED_TRACE(fmt::format("{}", fmt::join(part.notes, "\n")));
  EXPECT_TRUE(part.watertight);
  const MeshReport report = examine(part.mesh, true);
  EXPECT_EQ(report.open_edges + report.self_intersections, 0U);
  if (recorded.open_edges == 0) {
    EXPECT_TRUE(part.notes.empty());
    EXPECT_EQ(part.mesh.triangles.size(), recorded.triangles);
  } else {
    EXPECT_EQ(report.degenerate_triangles + report.duplicate_triangles, 0U);
    ASSERT_EQ(part.notes.size(), 1U);
    EXPECT_TRUE(part.notes[0].starts_with(fmt::format("{} open edges closed", recorded.open_edges)));
  }
  // A joint moves nothing: the file's own triangles already sum to the volume, joints and all.
  const double volume =
      std::pow(recorded.scale, 3) * mass_properties_of(read_merged(testing::model_path(recorded.file))).volume;
  EXPECT_NEAR(part.mass.volume, volume, 1e-5 * volume);
  EXPECT_FALSE(part.has_brep());
  const Vector3d size = 1000 * bounds_of(part.mesh).size();
  for (int axis = 0; axis < 3; ++axis) {
    if (recorded.size_mm[axis] == 0) continue;
    EXPECT_NEAR(size[axis], recorded.size_mm[axis], 0.006) << axis;
  }
}

INSTANTIATE_TEST_SUITE_P(Readme, EveryMeshFile, ::testing::ValuesIn(kMeshFiles), [](const auto& p) {
  std::string name = std::filesystem::path(p.param.file).filename().string();
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return name;
});

// Square prism, 14.142 mm from flat to axis, 100 mm long: the exact volume of the exact mesh.
TEST(Meshes, HaveTheVolumeOfTheirPrism) {
  SKIP_WITHOUT_MODELS();
  const Part peg = testing::load(testing::model_path("agh_polygon_pegs/4gon_peg.stl"), {.scale = 1e-3}).front();
  EXPECT_NEAR(peg.mass.volume, 0.028284 * 0.028284 * 0.1, 1e-4 * peg.mass.volume);
}

// README: blocks of 25 x 25 mm, holes of R 4.050, R 8.250 and 8.144 x 7.134 mm, circles of 144 sides. The blocks are
// 8.992 mm high, recorded as 9.
TEST(Meshes, WithAHoleHaveTheVolumeOfTheBlockWithoutIt) {
  SKIP_WITHOUT_MODELS();
  const auto circle = [](double r) { return 72 * r * r * std::sin(2 * 3.14159265358979 / 144); };
  const std::pair<const char*, double> holes[] = {
      {"round_hole_8mm", circle(4.050)}, {"round_hole_16mm", circle(8.250)}, {"rectangular_hole_8mm", 8.144 * 7.134}};
  for (const auto& [name, area] : holes) {
    const std::string file = fmt::format("factory_pegs/factory_{}_subdiv_3x.obj", name);
    const Part block = testing::load(testing::model_path(file)).front();
    const double expected = (25 * 25 - area) * 8.992;
    EXPECT_NEAR(block.mass.volume * 1e9, expected, 5e-5 * expected) << name;  // coordinates are in whole micrometres
  }
}

}  // namespace
}  // namespace verisim::recorded_models_test
