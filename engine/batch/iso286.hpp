// ISO 286-1:2010, table 1 (standard tolerances) and tables 2 to 5 (fundamental deviations): limits of size of the usual
// holes and shafts, nominal sizes from 3 to 120 mm. The same figures as scenarios/iso286.lua; a test compares the two.
#pragma once

#include <string>

namespace verisim::batch {

struct Deviations {
  double lower = 0, upper = 0;  ///< of the diameter from its nominal size [m]
};

/// Of a zone such as "H7" (a hole) or "g6" (a shaft). Error(usage): `what` has a zone or a nominal size [m] that the
/// table does not have.
[[nodiscard]] Deviations deviations(const std::string& what, const std::string& zone, double nominal);

}  // namespace verisim::batch
