// The functions of the CAD program, without types of its libraries. main.cpp calls them; only their source files
// include OpenCASCADE or assimp. All lengths [m]. Not thread-safe, like the kernel.
//
// Errors: Error(input) with `path` in front; the kernel's own exceptions pass (see describe_exception).
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "engine/geometry/part.hpp"
#include "engine/geometry/solid.hpp"

namespace verisim::cad {

struct Options {
  std::string path;               ///< for messages
  double scale = 1;               ///< multiplies what a CAD file says; metres per unit of a mesh file
  double deflection = 0;          ///< m; 0: 1/2000 of each part's diagonal
  double angular_deflection = 0;  ///< rad
};

/// Every solid of the file in its order. `content_path` names a readable copy of its bytes.
[[nodiscard]] std::vector<Part> read_step(const std::string& content_path, const Options& options);
[[nodiscard]] std::vector<Part> read_brep(const std::string& content_path, const Options& options);

/// The named objects of an STL, OBJ, PLY or glTF file (options.path tells which), placed as its nodes say: triangles,
/// name and colour alone. Polygons are cut into triangles; lines and points are left out; corners are not shared.
[[nodiscard]] std::vector<Part> read_mesh(const std::string& content, const Options& options);

[[nodiscard]] Part build(const Solid& solid, const Options& options);

/// Writes AP214 in millimetres to `target_path`; the same solids give the same bytes.
void write_step(const std::string& target_path, const std::vector<std::pair<std::string, Solid>>& solids);

/// Silences the kernel's own messages. Once, before anything else.
void initialize();

/// The text of the exception that is being handled, if it is one of the kernel's; empty otherwise.
[[nodiscard]] std::string describe_exception();

}  // namespace verisim::cad
