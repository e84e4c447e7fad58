#include "engine/geometry/part.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/geometry/loader.hpp"

namespace verisim {
namespace {

auto order_of(const Mate& mate) {
  return std::tuple(mate.clearance(), std::tie(mate.part_a, mate.part_b, mate.radius_hole, mate.radius_pin));
}

/// The distinct radii of a part's holes, or of its pins. A bore is often two half cylinders: one row for both.
std::vector<double> radii(const Part& part, bool holes) {
  std::vector<double> found;
  for (const Face& face : part.faces) {
    const auto* cylinder = std::get_if<Cylinder>(&face.surface);
    if (cylinder != nullptr && cylinder->hole == holes) found.push_back(cylinder->radius);
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

}  // namespace

std::vector<Mate> mating_candidates(const std::vector<Part>& parts, double tolerance) {
  VERISIM_ASSERT(is_not_negative(tolerance));
  std::vector<Mate> mates;
  for (const Part& a : parts) {
    const std::vector<double> holes = radii(a, true);
    for (const Part& b : parts) {
      if (&a == &b) continue;
      for (const double pin : radii(b, false)) {
        for (const double hole : holes) {
          if (std::abs(hole - pin) <= tolerance * hole) mates.push_back({a.name, b.name, hole, pin});
        }
      }
    }
  }
  const auto before = [](const Mate& x, const Mate& y) { return order_of(x) < order_of(y); };
  const auto equal = [](const Mate& x, const Mate& y) { return order_of(x) == order_of(y); };
  std::sort(mates.begin(), mates.end(), before);
  mates.erase(std::unique(mates.begin(), mates.end(), equal), mates.end());
  return mates;
}

std::vector<std::string> warnings_about(const Part& part) {
  constexpr double kSuspiciouslyLarge = 100;    // m: larger than a ship's engine
  constexpr double kSuspiciouslySmall = 10e-6;  // m: smaller than a hair is wide
  std::vector<std::string> warnings;
  if (part.mesh.triangles.empty()) return warnings;
  const double longest = bounds_of(part.mesh).size().maxCoeff();
  if (longest > kSuspiciouslyLarge) {
    warnings.push_back(
        fmt::format("'{}' is {:.4g} m wide; if its file is in millimetres, make its scale a thousandth (scale = 0.001 "
                    "where none is given)",
                    part.name, longest));
  }
  if (longest < kSuspiciouslySmall) {
    warnings.push_back(fmt::format("'{}' is {:.4g} m wide; if its file is in metres, make its scale a thousandfold",
                                   part.name, longest));
  }
  return warnings;
}

}  // namespace verisim
