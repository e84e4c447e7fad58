// Two bodies and what a link finds between them.
#pragma once

#include "engine/base/random.hpp"
#include "engine/exact/exact_link.hpp"
#include "tests/exact/peg.hpp"

namespace verisim::exact::test {

/// A link between two solids; the first stays at the origin.
struct Pair {
  ExactLink link;

  Pair(const Solid& first, const Solid& second, double spacing = 0.002)
      : link(body_of(first, spacing), body_of(second, spacing)) {}

  /// The rows with the second body at X_W2, at rest.
  const std::vector<ContactRow>& rows_at(const Pose& X_W2, double margin) {
    link.find({}, {X_W2, X_W2.position, {}}, 0.001, margin);
    return link.rows().rows();
  }
  /// The smallest gap of them, or `margin` if there is no row.
  double gap_at(const Pose& X_W2, double margin) {
    double least = margin;
    for (const ContactRow& row : rows_at(X_W2, margin)) least = std::min(least, row.gap);
    return least;
  }
};

/// Numbers and directions of one seed.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : stream_(seed, "exact test") {}
  double between(double low, double high) { return low + (high - low) * stream_.uniform(n_++); }
  Vector3d in_box(const Vector3d& half) {
    return {between(-half.x(), half.x()), between(-half.y(), half.y()), between(-half.z(), half.z())};
  }
  Quaterniond rotation() {
    const double angle = between(0, 3);
    const Vector3d axis(between(-1, 1), between(-1, 1), between(-1, 1));
    return rotation_from_vector(angle * axis.normalized());
  }

 private:
  RandomStream stream_;
  std::uint64_t n_ = 0;
};

}  // namespace verisim::exact::test
