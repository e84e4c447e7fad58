// Writes the models that the scenarios ship: make-models FOLDER. The same bytes every time (tests compare them).
#include <fmt/format.h>

#include <cstdio>

#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"
#include "engine/geometry/loader.hpp"

namespace {

using verisim::Quaterniond;
using verisim::Solid;
using verisim::Vector3d;
using NamedSolids = std::vector<std::pair<std::string, Solid>>;

Solid primitive(Solid::Kind kind, std::vector<double> sizes) {
  Solid solid;
  solid.kind = kind;
  solid.sizes = std::move(sizes);
  return solid;
}
Solid cylinder(double radius, double height) {
  return primitive(Solid::Kind::cylinder, {radius, height});
}
Solid combined(Solid::Kind kind, const Solid& a, const Solid& b) {
  Solid solid;
  solid.kind = kind;
  solid.children = {std::make_shared<const Solid>(a), std::make_shared<const Solid>(b)};
  return solid;
}
Solid operator-(const Solid& a, const Solid& b) {
  return combined(Solid::Kind::difference, a, b);
}
Solid operator+(const Solid& a, const Solid& b) {
  return combined(Solid::Kind::sum, a, b);
}
Solid at(const Vector3d& place, const Solid& child) {
  Solid solid;
  solid.kind = Solid::Kind::placed;
  solid.children = {std::make_shared<const Solid>(child)};
  solid.placement = {place, Quaterniond::Identity()};
  return solid;
}

/// The dissertation's trial, section 8.5: block 200 mm with a hole of 75 mm radius, pin of 70 mm radius and 400 mm.
NamedSolids peg_in_hole() {
  return {{"block", primitive(Solid::Kind::box, {0.375, 0.375, 0.2}) - cylinder(0.075, 0.2)},
          {"pin", cylinder(0.07, 0.4)}};
}

// A cylindrical roller bearing with the boundary dimensions of NU 204 (ISO 15: 20 x 47 x 14 mm, corners of 1 mm) and
// its usual raceways (26.5 and 41.5 mm), in the middle of its tolerances: bore 20 mm 0/-10 um, outside 47 mm 0/-11 um
// (ISO 492, normal class), radial internal clearance 32 um. Housing bore 47 H7 (0/+25 um). Axis along z, the bearing's
// middle in the origin; its lower side rests on the housing's shoulder, the shaft's shoulder on its upper side.
constexpr double kWidth = 0.014, kCorner = 0.001;
constexpr double kBore = 0.5 * 0.019995, kOutside = 0.5 * 0.0469945, kSeat = 0.5 * 0.0470125;  // radii
constexpr double kInnerRaceway = 0.5 * 0.0265, kRoller = 0.5 * 0.0075, kRollerLength = 0.009;
constexpr double kOuterRaceway = kInnerRaceway + 2 * kRoller + 0.5 * 32e-6;
constexpr double kRibs = 0.5 * 0.0385;  ///< inner radius of the outer ring's ribs
constexpr int kRollers = 11;

/// What a 45 degree corner takes from a bore of `radius` whose mouth is at `z`; side: 1 if the mouth is its upper end.
Solid countersink(double radius, double z, int side) {
  const Solid lead = side > 0 ? primitive(Solid::Kind::cone, {radius, radius + kCorner, kCorner})
                              : primitive(Solid::Kind::cone, {radius + kCorner, radius, kCorner});
  return at({0, 0, z - 0.5 * side * kCorner}, lead);
}

/// A round bar of `radius` from z = low to high with corners of 45 degrees at both ends.
Solid bar(double radius, double low, double high) {
  const Solid middle = at({0, 0, 0.5 * (low + high)}, cylinder(radius, high - low - 2 * kCorner));
  const Solid lower = primitive(Solid::Kind::cone, {radius - kCorner, radius, kCorner});
  const Solid upper = primitive(Solid::Kind::cone, {radius, radius - kCorner, kCorner});
  return middle + at({0, 0, low + 0.5 * kCorner}, lower) + at({0, 0, high - 0.5 * kCorner}, upper);
}

NamedSolids rollers() {
  NamedSolids all;
  const double pitch = 0.5 * (kInnerRaceway + kOuterRaceway);
  for (int i = 0; i < kRollers; ++i) {
    const double angle = 2 * verisim::pinned::kPi * i / kRollers;
    const Vector3d place(pitch * verisim::pinned::cos(angle), pitch * verisim::pinned::sin(angle), 0);
    all.emplace_back(fmt::format("bearing roller {}", i + 1), at(place, cylinder(kRoller, kRollerLength)));
  }
  return all;
}

/// From the end of its seat, 5 mm below the bearing, to its shoulder, and on as a thicker bar.
Solid shaft(double radius) {
  constexpr double kEnd = -0.5 * kWidth - 0.005, kShoulder = 0.5 * kWidth, kTop = kShoulder + 0.03;
  const Solid thick = at({0, 0, 0.5 * (kShoulder + kTop)}, cylinder(0.0125, kTop - kShoulder));
  return bar(radius, kEnd, kShoulder + 2 * kCorner) + thick;
}

NamedSolids bearing(double shaft_radius) {
  constexpr double kTop = 0.5 * kWidth, kFloor = -0.5 * kWidth - 0.01;
  const Solid wall = at({0, 0, 0.5 * (kTop + kFloor)}, cylinder(0.032, kTop - kFloor));
  const Solid housing =
      wall - at({0, 0, kTop}, cylinder(kSeat, 2 * kWidth)) - cylinder(0.0205, 0.06) - countersink(kSeat, kTop, 1);
  const Solid outer = bar(kOutside, -0.5 * kWidth, 0.5 * kWidth) - cylinder(kRibs, 2 * kWidth) -
                      cylinder(kOuterRaceway, kRollerLength + 0.0001);
  const Solid inner = cylinder(kInnerRaceway, kWidth) - cylinder(kBore, 2 * kWidth) -
                      countersink(kBore, 0.5 * kWidth, 1) - countersink(kBore, -0.5 * kWidth, -1);
  NamedSolids all = {{"housing", housing}, {"bearing outer ring", outer}, {"bearing inner ring", inner}};
  for (auto& roller : rollers()) all.push_back(std::move(roller));
  all.emplace_back("shaft", shaft(shaft_radius));
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: make-models FOLDER\n");
    return 2;
  }
  try {
    const std::string folder = argv[1];
    verisim::write_step(folder + "/peg_in_hole.step", peg_in_hole());
    verisim::write_step(folder + "/bearing.step", bearing(0.5 * 0.0199865));                // 20 g6: -7/-20 um
    verisim::write_step(folder + "/shaft_m6.step", {{"shaft", shaft(0.5 * 0.0200145)}});    // 20 m6: +21/+8 um
    verisim::write_step(folder + "/shaft_loose.step", {{"shaft", shaft(kBore - 0.0007)}});  // 1.1 voxels of 0.64 mm
    return 0;
  } catch (const verisim::Error& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return error.exit_code();
  }
}
