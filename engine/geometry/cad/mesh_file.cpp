// STL, OBJ, PLY and glTF files through assimp, with every step off that would change geometry. In this program because
// some damaged files make assimp crash or read for ever.
#include "engine/geometry/cad/kernel.hpp"

#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <cctype>
#include <cstdlib>
#include <cstring>
#include <new>
#include <sstream>

#include "engine/base/error.hpp"
#include "engine/geometry/model_format.hpp"

namespace verisim::cad {
namespace {

/// A model is what its one file holds: whatever else it names (materials, buffers) would be read from disk unseen by
/// the run file, so it does not exist.
class NoOtherFiles : public Assimp::IOSystem {
 public:
  bool Exists(const char*) const override { return false; }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char*, const char*) override { return nullptr; }
  void Close(Assimp::IOStream*) override {}
};

/// Assimp takes what it gets of a truncated STL: the end is looked for here.
void check_stl(const std::string& path, const std::string& content) {
  constexpr std::size_t kHeader = 84;
  constexpr std::size_t kTriangle = 50;
  std::uint32_t count = 0;
  if (content.size() >= kHeader) std::memcpy(&count, content.data() + 80, sizeof count);
  const std::size_t expected = kHeader + kTriangle * std::size_t{count};
  if (content.size() >= kHeader && content.size() == expected) return;
  const bool ascii = content.starts_with("solid") && content.find("facet") != std::string::npos;
  if (ascii) {
    if (content.find("endsolid") == std::string::npos) {
      fail(ErrorKind::input, "{}: the file is truncated, 'endsolid' is missing; copy or export it again", path);
    }
    return;
  }
  if (content.size() < kHeader) fail(ErrorKind::input, "{}: this is no STL file; export it again", path);
  if (content.size() > expected) return;  // some programs append attributes
  fail(ErrorKind::input,
       "{}: truncated or no STL file: {} triangles need {} bytes and it has {}; copy or export it again", path, count,
       expected, content.size());
}

void check_obj(const std::string& path, const std::string& content) {
  const bool printable =
      std::none_of(content.begin(), content.end(), [](unsigned char c) { return c < 0x20 && std::isspace(c) == 0; });
  if (!printable) fail(ErrorKind::input, "{}: this is no OBJ file, it holds binary bytes; export it again", path);
}

/// Assimp reads a PLY that ends early for ever: at least one line or four bytes are there for each element it
/// announces.
void check_ply(const std::string& path, const std::string& content) {
  const std::size_t end = content.find("end_header");
  if (end == std::string::npos)
    fail(ErrorKind::input, "{}: truncated or no PLY file ('end_header' is missing); copy or export it again", path);
  std::size_t announced = 0;
  std::istringstream head(content.substr(0, end));
  for (std::string line; std::getline(head, line);) {
    if (line.starts_with("element ")) announced += std::strtoull(line.c_str() + line.rfind(' '), nullptr, 10);
  }
  const bool ascii = content.find("format ascii") < end;
  const auto lines =
      static_cast<std::size_t>(std::count(content.begin() + static_cast<long>(end), content.end(), '\n'));
  const bool unfinished = content.back() != '\n';
  const std::size_t present = ascii ? lines - 1 + (unfinished ? 1 : 0) : (content.size() - end) / 4;
  if (lines > 0 && present >= announced) return;
  fail(ErrorKind::input, "{}: the file is truncated, it announces {} elements and ends before; copy or export it again",
       path, announced);
}

void append(const aiMesh& source, const aiMatrix4x4& placement, double scale, TriangleMesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (unsigned i = 0; i < source.mNumVertices; ++i) {
    const aiVector3D p = placement * source.mVertices[i];
    mesh.vertices.emplace_back(scale * double{p.x}, scale * double{p.y}, scale * double{p.z});
  }
  for (unsigned i = 0; i < source.mNumFaces; ++i) {
    const aiFace& face = source.mFaces[i];
    if (face.mNumIndices != 3) continue;
    mesh.triangles.push_back({first + face.mIndices[0], first + face.mIndices[1], first + face.mIndices[2]});
  }
}

void set_color(const aiScene& scene, const aiMesh& mesh, std::array<float, 4>& color) {
  aiColor4D diffuse;
  if (mesh.mMaterialIndex >= scene.mNumMaterials) return;
  if (scene.mMaterials[mesh.mMaterialIndex]->Get(AI_MATKEY_COLOR_DIFFUSE, diffuse) == aiReturn_SUCCESS) {
    color = {diffuse.r, diffuse.g, diffuse.b, diffuse.a};
  }
}

void collect(const aiScene& scene, const aiNode& node, const aiMatrix4x4& above, double scale,
             std::vector<Part>& parts) {
  const aiMatrix4x4 placement = above * node.mTransformation;
  if (node.mNumMeshes > 0) {
    Part part;
    part.name = node.mName.C_Str();
    for (unsigned i = 0; i < node.mNumMeshes; ++i) append(*scene.mMeshes[node.mMeshes[i]], placement, scale, part.mesh);
    set_color(scene, *scene.mMeshes[node.mMeshes[0]], part.color);
    if (!part.mesh.triangles.empty()) parts.push_back(std::move(part));
  }
  for (unsigned i = 0; i < node.mNumChildren; ++i) collect(scene, *node.mChildren[i], placement, scale, parts);
}

void check_finite(const std::string& path, const std::vector<Part>& parts) {
  for (const Part& part : parts) {
    const auto bad = std::find_if(part.mesh.vertices.begin(), part.mesh.vertices.end(),
                                  [](const Vector3d& p) { return !p.allFinite(); });
    if (bad == part.mesh.vertices.end()) continue;
    fail(ErrorKind::input, "{}: vertex {} is ({}, {}, {}): not a finite place; export the model again", path,
         bad - part.mesh.vertices.begin(), bad->x(), bad->y(), bad->z());
  }
}

}  // namespace

std::vector<Part> read_mesh(const std::string& content, const Options& options) {
  const std::string& path = options.path;
  const std::string format = extension_of(path);
  if (format == "stl") check_stl(path, content);
  if (format == "obj") check_obj(path, content);
  if (format == "ply") check_ply(path, content);
  Assimp::Importer importer;
  importer.SetIOHandler(new NoOtherFiles);  // the importer owns it
  const aiScene* scene = importer.ReadFileFromMemory(
      content.data(), content.size(), aiProcess_Triangulate | aiProcess_ValidateDataStructure, format.c_str());
  if (scene == nullptr && std::string(importer.GetErrorString()).find("bad_alloc") != std::string::npos)
    throw std::bad_alloc();
  if (scene == nullptr || scene->mRootNode == nullptr || (scene->mFlags & AI_SCENE_FLAGS_INCOMPLETE) != 0) {
    fail(ErrorKind::input,
         "{}: it cannot be read as {} ({}); it is truncated, damaged or of another format, export it again", path,
         format, scene == nullptr ? importer.GetErrorString() : "incomplete");
  }
  std::vector<Part> parts;
  collect(*scene, *scene->mRootNode, aiMatrix4x4(), options.scale, parts);
  if (parts.empty())
    fail(ErrorKind::input, "{}: there are no triangles in it; export the model as a surface mesh", path);
  check_finite(path, parts);
  return parts;
}

}  // namespace verisim::cad
