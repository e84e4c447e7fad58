// Mesh files, good and bad. Every format is written here by hand, so that a test shows what it reads.
#include "engine/geometry/loader.hpp"

#include <array>
#include <cstring>

#include "engine/geometry/write_file.hpp"
#include "tests/geometry/models.hpp"

namespace verisim::mesh_file_test {
namespace {

using testing::box_mesh;
using testing::error_of;

const TriangleMesh kBox = box_mesh({0, 0, 0}, {1, 2, 3});

std::string ascii_stl(const TriangleMesh& mesh) {
  std::string text = "solid box\n";
  for (const auto& triangle : mesh.triangles) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const std::uint32_t i : triangle) {
      text += fmt::format("vertex {} {} {}\n", mesh.vertices[i].x(), mesh.vertices[i].y(), mesh.vertices[i].z());
    }
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid box\n";
}

std::string obj(const TriangleMesh& mesh, const std::string& name = {}, std::uint32_t first = 1) {
  std::string text = name.empty() ? "" : "o " + name + "\n";
  for (const Vector3d& v : mesh.vertices) text += fmt::format("v {} {} {}\n", v.x(), v.y(), v.z());
  for (const auto& [i, j, k] : mesh.triangles) text += fmt::format("f {} {} {}\n", first + i, first + j, first + k);
  return text;
}

std::string ply(const TriangleMesh& mesh) {
  std::string text = fmt::format(
      "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
      "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
      mesh.vertices.size(), mesh.triangles.size());
  for (const Vector3d& v : mesh.vertices) text += fmt::format("{} {} {}\n", v.x(), v.y(), v.z());
  for (const auto& [i, j, k] : mesh.triangles) text += fmt::format("3 {} {} {}\n", i, j, k);
  return text;
}

/// glTF 2 in one binary file: a JSON head, then indices and positions; the node doubles and shifts the mesh.
std::string glb(const TriangleMesh& mesh) {
  std::string data;
  for (const auto& triangle : mesh.triangles) data.append(reinterpret_cast<const char*>(triangle.data()), 12);
  const std::size_t indices = data.size();
  for (const Vector3d& v : mesh.vertices) {
    const Vector3f f = v.cast<float>();
    data.append(reinterpret_cast<const char*>(f.data()), 12);
  }
  std::string json =
      fmt::format(R"({{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],)"
                  R"("nodes":[{{"mesh":0,"name":"box","scale":[2,2,2],"translation":[1,0,0]}}],)"
                  R"("meshes":[{{"primitives":[{{"attributes":{{"POSITION":1}},"indices":0}}]}}],)"
                  R"("buffers":[{{"byteLength":{0}}}],"bufferViews":[{{"buffer":0,"byteOffset":0,"byteLength":{1}}},)"
                  R"({{"buffer":0,"byteOffset":{1},"byteLength":{2}}}],)"
                  R"("accessors":[{{"bufferView":0,"componentType":5125,"count":{3},"type":"SCALAR"}},)"
                  R"({{"bufferView":1,"componentType":5126,"count":{4},"type":"VEC3","min":[0,0,0],"max":[1,2,3]}}]}})",
                  data.size(), indices, data.size() - indices, 3 * mesh.triangles.size(), mesh.vertices.size());
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const auto put = [](std::string& out, std::uint32_t n) { out.append(reinterpret_cast<const char*>(&n), 4); };
  std::string out = "glTF";
  put(out, 2);
  put(out, static_cast<std::uint32_t>(28 + json.size() + data.size()));
  put(out, static_cast<std::uint32_t>(json.size()));
  out += "JSON" + json;
  put(out, static_cast<std::uint32_t>(data.size()));
  out += std::string("BIN\0", 4) + data;
  return out;
}

std::string binary_stl(const TriangleMesh& mesh, double units_per_metre = 1) {
  std::string out(80, ' ');  // the head, which says nothing
  const auto put = [&](const auto& value) { out.append(reinterpret_cast<const char*>(&value), sizeof value); };
  put(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& triangle : mesh.triangles) {
    put(std::array<float, 3>{});  // the normal, left to the reader
    for (const std::uint32_t corner : triangle) {
      put(Eigen::Vector3f((units_per_metre * mesh.vertices[corner]).cast<float>()));
    }
    out.append(2, '\0');
  }
  return out;
}

Part load_one(const std::string& path, const std::string& content, const LoadOptions& options = {}) {
  std::vector<Part> parts = load_model(path, content, options);
  EXPECT_EQ(parts.size(), 1U);
  return std::move(parts.front());
}

std::string refusal(const std::string& path, const std::string& content) {
  const std::string error = error_of(ErrorKind::input, [&] { static_cast<void>(load_model(path, content, {})); });
  EXPECT_TRUE(error.starts_with(path + ":")) << error;
  EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  return error;
}

TEST(EveryMeshFormat, GivesTheSameBox) {
  const std::vector<std::pair<std::string, std::string>> files = {
      {"box.stl", ascii_stl(kBox)}, {"BOX.STL", binary_stl(kBox)}, {"box.obj", obj(kBox)}, {"box.ply", ply(kBox)}};
  for (const auto& [path, content] : files) {
    SCOPED_TRACE(path);
    const Part part = load_one(path, content);
    EXPECT_TRUE(part.watertight);
    EXPECT_EQ(part.mesh.vertices.size(), 8U);
    EXPECT_EQ(part.mesh.triangles.size(), 12U);
    EXPECT_NEAR(part.mass.volume, 6, 1e-12);
    EXPECT_NEAR(part.area, 22, 1e-12);
    EXPECT_FALSE(part.exact);
    EXPECT_TRUE(part.notes.empty());
  }
}

TEST(Gltf, IsPlacedAsItsNodesSay) {
  const Part part = load_one("box.glb", glb(kBox));
  EXPECT_TRUE(part.watertight);
  EXPECT_NEAR(part.mass.volume, 48, 1e-12);
  EXPECT_EQ(bounds_of(part.mesh).min, Vector3d(1, 0, 0));
}

TEST(Scale, MultipliesCoordinates) {
  EXPECT_NEAR(load_one("box.stl", ascii_stl(kBox), {.scale = 1e-3}).mass.volume, 6e-9, 1e-21);
  EXPECT_NEAR(load_one("box.stl", binary_stl(kBox, 1000), {.scale = 1e-3}).mass.volume, 6, 1e-12);
}

TEST(Scale, ThatIsNoneIsRefused) {
  for (const double scale : {-1.0, std::nan(""), HUGE_VAL}) {
    EXPECT_THROW(static_cast<void>(load_model("box.obj", obj(kBox), {.scale = scale})), Error) << scale;
  }
}

TEST(Objects, ThatAreEachClosedArePartsOfTheirOwn) {
  const TriangleMesh other = box_mesh({5, 0, 0}, {6, 1, 1});
  const std::vector<Part> parts = load_model("two.obj", obj(kBox, "pin") + obj(other, "block", 9), {});
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_EQ(parts[0].name, "pin");
  EXPECT_EQ(parts[1].name, "block");
  EXPECT_NEAR(parts[1].mass.volume, 1, 1e-12);
}

TEST(Objects, ThatArePiecesOfOneSurfaceAreOnePart) {
  std::string text = obj(kBox, "lower");
  const std::size_t middle = text.find("f ", text.size() / 2);
  text.insert(middle, "o upper\n");
  const Part part = load_one("pieces.obj", text);
  EXPECT_EQ(part.name, "pieces");
  EXPECT_TRUE(part.watertight);
}

TEST(Polygons, AreCutIntoTriangles) {
  const Part part = load_one("quads.obj",
                             "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
                             "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
  EXPECT_TRUE(part.watertight);
  EXPECT_NEAR(part.mass.volume, 1, 1e-12);
}

// --- bad files
// --------------------------------------------------------------------------------------------------------

TEST(BadFile, EmptyIsRefused) {
  for (const char* path : {"a.stl", "a.obj", "a.ply", "a.glb", "a.step", "a.brep"}) {
    EXPECT_NE(refusal(path, "").find("empty"), std::string::npos) << path;
  }
}

TEST(BadFile, OfAnUnknownFormatIsRefusedWithThoseThatAreKnown) {
  EXPECT_NE(refusal("part.osg", "x").find(".step"), std::string::npos);
  EXPECT_NE(refusal("part", "x").find(".step"), std::string::npos);
}

TEST(BadFile, OfBinaryGarbageIsRefused) {
  std::string garbage;
  for (std::uint32_t i = 0; i < 4096; ++i) garbage += static_cast<char>((i * 2654435761U) >> 24U);
  for (const char* path : {"a.stl", "a.obj", "a.ply", "a.glb", "a.gltf", "a.step", "a.stp", "a.brep"}) {
    SCOPED_TRACE(path);
    static_cast<void>(refusal(path, garbage));
    static_cast<void>(refusal(path, garbage.substr(0, 100)));
    static_cast<void>(refusal(path, std::string(500, '\0')));
  }
}

TEST(BadFile, TruncatedIsRefused) {
  const std::vector<std::pair<std::string, std::string>> files = {
      {"a.stl", ascii_stl(kBox)}, {"b.stl", binary_stl(kBox)}, {"a.ply", ply(kBox)}, {"a.glb", glb(kBox)}};
  for (const auto& [path, whole] : files) {
    for (const double share : {0.02, 0.3, 0.5, 0.9}) {
      SCOPED_TRACE(fmt::format("{} cut to {}", path, share));
      static_cast<void>(
          refusal(path, whole.substr(0, static_cast<std::size_t>(share * static_cast<double>(whole.size())))));
    }
  }
}

// An OBJ has no end that could be missing: cut between two lines it is a smaller mesh, and an open one.
TEST(BadFile, TruncatedObjIsRefusedOrOpen) {
  const std::string whole = obj(kBox);
  for (std::size_t n = 1; n < whole.size() - 1; n += 7) {
    try {
      const std::vector<Part> parts = load_model("a.obj", whole.substr(0, n), {});
      EXPECT_FALSE(parts.front().watertight) << n;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
    }
  }
}

TEST(BadFile, WithoutTrianglesIsRefused) {
  static_cast<void>(refusal("a.stl", "solid nothing\nendsolid nothing\n"));
  static_cast<void>(refusal("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"));
  static_cast<void>(refusal("a.ply", ply({})));
  static_cast<void>(refusal("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"));
}

TEST(BadFile, WithAPlaceThatIsNotFiniteIsRefused) {
  TriangleMesh mesh = kBox;
  mesh.vertices[3].y() = std::nan("");
  static_cast<void>(refusal("a.stl", binary_stl(mesh)));
  static_cast<void>(refusal("a.stl", ascii_stl(mesh)));
  static_cast<void>(refusal("a.obj", obj(mesh)));
  static_cast<void>(refusal("a.ply", ply(mesh)));
}

TEST(BadFile, OfASizeThatNoPartHasIsRefused) {
  EXPECT_EQ(load_one("a.obj", obj(kBox)).name, "a");
  for (const double scale : {1e-12, 1e12, 1e100, 1e200, 1e308}) {
    const LoadOptions options{.scale = scale};
    EXPECT_THROW((void)load_model("a.obj", obj(kBox), options), Error) << scale;
  }
  TriangleMesh far = kBox;
  for (Vector3d& p : far.vertices) p.x() += 1e10;
  static_cast<void>(refusal("a.obj", obj(far)));
}

TEST(BadFile, WithAnIndexBeyondItsVerticesIsRefused) {
  static_cast<void>(refusal("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"));
}

TEST(BadMesh, ThatIsOpenLoadsWithANoteThatSaysWhere) {
  TriangleMesh open = kBox;
  open.triangles.resize(10);
  const Part part = load_one("open.obj", obj(open));
  EXPECT_FALSE(part.watertight);
  ASSERT_EQ(part.notes.size(), 1U);
  EXPECT_NE(part.notes[0].find("open along 4 edges near (1.000, "), std::string::npos) << part.notes[0];
}

TEST(BadMesh, ThatCrossesItselfLoadsWithANote) {
  TriangleMesh mesh = kBox;
  testing::append(mesh, box_mesh({0.5, 0.5, 0.5}, {1.5, 1.5, 1.5}));
  const Part part = load_one("crossing.obj", obj(mesh));
  EXPECT_FALSE(part.watertight);
  ASSERT_EQ(part.notes.size(), 1U);
  EXPECT_NE(part.notes[0].find("cross each other near"), std::string::npos) << part.notes[0];
}

TEST(BadMesh, ThatIsInsideOutIsTurnedWithANote) {
  const Part part = load_one("inside_out.obj", obj(testing::turned_inside_out(kBox)));
  EXPECT_TRUE(part.watertight);
  EXPECT_NEAR(part.mass.volume, 6, 1e-12);
  EXPECT_EQ(part.notes.size(), 1U);
}

TEST(WriteFile, SaysWhenItCannotWrite) {
  const std::string error = error_of(ErrorKind::io, [] { write_file("/nowhere/a.stl", "solid"); });
  EXPECT_NE(error.find("/nowhere/a.stl"), std::string::npos);
  EXPECT_THROW(write_file("/dev/full", "solid"), Error);
}

}  // namespace
}  // namespace verisim::mesh_file_test
