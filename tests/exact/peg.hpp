// The pin and the block of ../shared/reference/exact and peers: hole of radius 75 mm through a block of
// 375 x 375 x 200 mm, pin 400 mm long whose radius is smaller by the clearance. Origins in the middle, axis z.
#pragma once

#include <memory>

#include "engine/exact/exact_body.hpp"
#include "engine/geometry/loader.hpp"

namespace verisim::exact::test {

inline constexpr double kHoleRadius = 0.075, kPinLength = 0.4, kBlockHeight = 0.2;

[[nodiscard]] inline Solid make(Solid::Kind kind, std::vector<double> sizes) {
  return {.kind = kind, .sizes = std::move(sizes), .children = {}, .placement = {}};
}
[[nodiscard]] inline Solid combine(Solid::Kind kind, const Solid& a, const Solid& b) {
  return {
      .kind = kind, .sizes = {}, .children = {std::make_shared<Solid>(a), std::make_shared<Solid>(b)}, .placement = {}};
}
[[nodiscard]] inline Solid placed(const Solid& solid, const Pose& at) {
  return {.kind = Solid::Kind::placed, .sizes = {}, .children = {std::make_shared<Solid>(solid)}, .placement = at};
}

[[nodiscard]] inline Solid pin_solid(double clearance) {
  return make(Solid::Kind::cylinder, {kHoleRadius - clearance, kPinLength});
}

/// `chamfer`: m, at 45 degrees around the hole's upper rim; 0: sharp.
[[nodiscard]] inline Solid block_solid(double chamfer = 0) {
  const Solid block = combine(Solid::Kind::difference, make(Solid::Kind::box, {0.375, 0.375, kBlockHeight}),
                              make(Solid::Kind::cylinder, {kHoleRadius, 1.5 * kBlockHeight}));
  if (chamfer == 0) return block;
  const Solid tool = make(Solid::Kind::cone, {kHoleRadius, kHoleRadius + 2 * chamfer, 2 * chamfer});
  return combine(Solid::Kind::difference, block, placed(tool, {{0, 0, kBlockHeight / 2}, Quaterniond::Identity()}));
}

[[nodiscard]] inline std::shared_ptr<const ExactBody> body_of(const Solid& solid, double spacing,
                                                              const LoadOptions& load = {}, BodyOptions options = {}) {
  const Part part = load_solid(solid, load);
  options.spacing = spacing;
  return std::make_shared<const ExactBody>(std::span(&part, 1), options);
}

}  // namespace verisim::exact::test
