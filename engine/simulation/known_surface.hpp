// What a body's models tell hybrid methods of its surface, and from that why voxels answer contacts of a pair under a
// method: no fallback is silent. Facts of a description, kept when its models are gone.
#pragma once

#include <cstddef>
#include <string>

#include "engine/simulation/hybrid_method.hpp"

namespace verisim {

struct BodyDescription;
struct World;

struct KnownSurface {
  std::size_t parts = 0, parts_without_brep = 0;
  std::size_t faces = 0;     ///< of all parts
  std::size_t unknown = 0;   ///< of these, drawn ones of kind `other`
  std::size_t declined = 0;  ///< of these, pieces of a mesh in which the recovery found no surface
  bool refused = false;      ///< brep = false at the object
  bool declared = false;     ///< faces were declared by hand

  /// Is every piece of the surface on a face of a model that is known?
  [[nodiscard]] bool is_whole() const { return !refused && parts_without_brep == 0 && unknown + declined == 0; }
};

[[nodiscard]] KnownSurface known_surface(const BodyDescription& description);

/// What is not known of the surfaces of two bodies and a method would need, and who said so: "3 of 12 faces of 'rod'
/// are of a kind that is not known". Empty: nothing. Allocates: between frames.
[[nodiscard]] std::string gaps_of(const Body& first, const Body& second, Hybrid asked);

/// Why no method acts on two bodies although the scene names one, for them or for all. Empty: it names none, or one
/// acts.
[[nodiscard]] std::string why_off(const World& world, const Body& first, const Body& second);

/// Why voxels answer contacts of two bodies for which a method was asked. Empty: they do not.
[[nodiscard]] std::string why_voxels(const Body& first, const Body& second, Hybrid asked);

}  // namespace verisim
