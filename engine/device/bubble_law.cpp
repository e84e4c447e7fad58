#include "engine/device/bubble_law.hpp"

namespace verisim {

double BubbleLaw::rate(double x, double R) const {
  if (!(x > 0)) return 0;
  const double p = R * peak;
  const double far = taper * scale;
  const auto ring = [&](double per) {
    const double f = -scale / (per * per) * x * (x - 2 * p);
    return x < p || f > far ? f : far;
  };
  switch (kind) {
    case BubbleLawKind::linear:
      return scale * x;
    case BubbleLawKind::quadratic:
      return scale * x * x;
    case BubbleLawKind::cubic:
      return scale * x * x * x;
    case BubbleLawKind::peak_ring:
      return ring(p);
    case BubbleLawKind::peak_ring_as_printed:
      return ring(peak);
  }
  return 0;
}

}  // namespace verisim
