#include "engine/geometry/mesh_file.hpp"

#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <cctype>
#include <cstring>

#include "engine/base/error.hpp"
#include "engine/geometry/model_format.hpp"

namespace verisim {
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

/// The same for OBJ: a face or vertex line without its last number is not told by assimp.
void check_obj(const std::string& path, const std::string& content) {
  const bool printable = std::none_of(content.begin(), content.end(), [](char c) {
    return c == '\0' || (static_cast<unsigned char>(c) < 0x20 && std::isspace(static_cast<unsigned char>(c)) == 0);
  });
  if (!printable) fail(ErrorKind::input, "{}: this is no OBJ file, it holds binary bytes; export it again", path);
  if (content.back() != '\n') {
    const std::size_t last_line = content.rfind('\n') + 1;
    if (content[last_line] == 'f' || content[last_line] == 'v') {
      fail(ErrorKind::input, "{}: the file ends in the middle of a line; copy or export it again", path);
    }
  }
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
             std::vector<MeshObject>& objects) {
  const aiMatrix4x4 placement = above * node.mTransformation;
  if (node.mNumMeshes > 0) {
    MeshObject object;
    object.name = node.mName.C_Str();
    for (unsigned i = 0; i < node.mNumMeshes; ++i)
      append(*scene.mMeshes[node.mMeshes[i]], placement, scale, object.mesh);
    set_color(scene, *scene.mMeshes[node.mMeshes[0]], object.color);
    if (!object.mesh.triangles.empty()) objects.push_back(std::move(object));
  }
  for (unsigned i = 0; i < node.mNumChildren; ++i) collect(scene, *node.mChildren[i], placement, scale, objects);
}

void check_finite(const std::string& path, const std::vector<MeshObject>& objects) {
  for (const MeshObject& object : objects) {
    const auto bad = std::find_if(object.mesh.vertices.begin(), object.mesh.vertices.end(),
                                  [](const Vector3d& p) { return !p.allFinite(); });
    if (bad == object.mesh.vertices.end()) continue;
    fail(ErrorKind::input, "{}: vertex {} is ({}, {}, {}): not a finite place; export the model again", path,
         bad - object.mesh.vertices.begin(), bad->x(), bad->y(), bad->z());
  }
}

}  // namespace

std::vector<MeshObject> read_mesh_file(const std::string& path, const std::string& content, double scale) {
  const std::string format = extension_of(path);
  if (format == "stl") check_stl(path, content);
  if (format == "obj") check_obj(path, content);
  Assimp::Importer importer;
  importer.SetIOHandler(new NoOtherFiles);  // the importer owns it
  const aiScene* scene = importer.ReadFileFromMemory(
      content.data(), content.size(), aiProcess_Triangulate | aiProcess_ValidateDataStructure, format.c_str());
  if (scene == nullptr || scene->mRootNode == nullptr || (scene->mFlags & AI_SCENE_FLAGS_INCOMPLETE) != 0) {
    fail(ErrorKind::input,
         "{}: it cannot be read as {} ({}); it is truncated, damaged or of another format, export it again", path,
         format, scene == nullptr ? importer.GetErrorString() : "incomplete");
  }
  std::vector<MeshObject> objects;
  collect(*scene, *scene->mRootNode, aiMatrix4x4(), scale, objects);
  if (objects.empty())
    fail(ErrorKind::input, "{}: there are no triangles in it; export the model as a surface mesh", path);
  check_finite(path, objects);
  return objects;
}

}  // namespace verisim
