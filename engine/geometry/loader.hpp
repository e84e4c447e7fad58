// Reads models into parts: STEP, BREP and Solids through OpenCASCADE, STL, OBJ, PLY and glTF through assimp. Both run
// in a child process (program verisim-cad beside this one), because neither is thread-safe, and some files crash the
// one or make the other read for ever. Here that is bad input. 20 to 60 ms for starting the program.
//
// Errors: Error(input) naming the file, what is wrong and what to do: empty, truncated, damaged, no solid or triangle
// in it, NaN. A mesh that stays open, non-manifold or self-intersecting after repair loads: its part is not watertight
// and its notes say what is wrong, where and what to do. Error(io) if verisim-cad is missing or a file cannot be
// written.
#pragma once

#include <string>
#include <vector>

#include "engine/geometry/part.hpp"
#include "engine/geometry/solid.hpp"

namespace verisim {

class CadSession;

struct LoadOptions {
  double scale = 0;       ///< metres per unit of a mesh file; 0: metres for meshes, the file's own unit for STEP/BREP
                          ///< (mm for BREP). Given for STEP it multiplies the file's own.
  double deflection = 0;  ///< chord error of the tessellation [m]; 0: 1/2000 of the bounding box diagonal
  double angular_deflection = 0.1;  ///< rad
  bool recover = false;             ///< faces and edges of mesh files from their triangles (recover.hpp)
};

/// One part per solid, in file order; of a mesh file one part, or one per named object if each of them is closed.
/// Coordinates coming from the CAD kernel are rounded to 2^-36 m and derived numbers to 40 bits, so that the kernel's
/// last-bit differences between CPUs do not reach a state hash.
/// `content` is the file's bytes (already read by the caller, who records them); `path` gives format and error texts.
[[nodiscard]] std::vector<Part> load_model(const std::string& path, const std::string& content,
                                           const LoadOptions& options);

/// `session`: a verisim-cad that goes on with the next one (cad_client.hpp); null: one for this solid alone.
[[nodiscard]] Part load_solid(const Solid& solid, const LoadOptions& options, CadSession* session = nullptr);

/// Writes the solids as one STEP file (AP214, mm) through the same child process: scenes made of files the project
/// wrote.
void write_step(const std::string& path, const std::vector<std::pair<std::string, Solid>>& solids);

/// Warnings, one sentence each, about what is probably a mistake: a part larger than 100 m or smaller than 10 um
/// in its longest direction (a model in millimetres read as metres), with the scale that would make it plausible.
[[nodiscard]] std::vector<std::string> warnings_about(const Part& part);

}  // namespace verisim
