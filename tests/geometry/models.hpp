// Helpers of the geometry tests: files, small meshes and checks that hold for every part.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>

#include "engine/geometry/loader.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/paths.hpp"

namespace verisim::testing {

using test::append;
using test::turned_inside_out;

inline std::string read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error("cannot read " + path);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline std::string model_path(const std::string& name) {
  return paths::in_shared_data("models/") + name;
}

inline bool models_are_here() {
  return std::filesystem::exists(model_path(""));
}

inline std::vector<Part> load(const std::string& path, const LoadOptions& options = {}) {
  return load_model(path, read_file(path), options);
}

/// The message of the Error(kind) that `action` throws; a failure if it throws none.
template <typename Action>
std::string error_of(ErrorKind kind, Action&& action) {
  try {
    action();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), kind) << error.what();
    return error.what();
  }
  ADD_FAILURE() << "no error was thrown";
  return {};
}

inline std::map<std::string, int> face_counts(const Part& part) {
  std::map<std::string, int> counts;
  for (const Face& face : part.faces) ++counts[kSurfaceNames[face.surface.index()]];
  return counts;
}

/// A box from a to b: 8 corners, 12 triangles, counter-clockwise seen from outside.
inline TriangleMesh box_mesh(const Vector3d& a, const Vector3d& b) {
  TriangleMesh mesh;
  for (unsigned i = 0; i < 8; ++i) {
    mesh.vertices.emplace_back((i & 1U) != 0 ? b.x() : a.x(), (i & 2U) != 0 ? b.y() : a.y(),
                               (i & 4U) != 0 ? b.z() : a.z());
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

inline Solid make(Solid::Kind kind, std::vector<double> sizes) {
  return {kind, std::move(sizes), {}, {}};
}
inline Solid make(Solid::Kind kind, const Solid& a, const Solid& b) {
  return {kind, {}, {std::make_shared<const Solid>(a), std::make_shared<const Solid>(b)}, {}};
}
inline Solid placed(const Solid& child, const Vector3d& position,
                    const Quaterniond& rotation = Quaterniond::Identity()) {
  return {Solid::Kind::placed, {}, {std::make_shared<const Solid>(child)}, {position, rotation}};
}

}  // namespace verisim::testing
