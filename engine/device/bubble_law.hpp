// Rate control of the bubble: how fast it moves when the handle is a distance x outside of it (dissertation eq. 4.1 to
// 4.6; ORACLES section 3, slip 1).
#pragma once

#include <array>

namespace verisim {

enum class BubbleLawKind {
  linear,               ///< V = K x
  quadratic,            ///< V = K x^2
  cubic,                ///< V = K x^3, eq. 4.3
  peak_ring,            ///< peak rate v* at x = R x*, then down to beta v*
  peak_ring_as_printed  ///< eq. 4.4 divides by x*^2 where it needs (R x*)^2: its peak is v* R^2, and it jumps there
};
inline constexpr std::array kBubbleLawNames = {"linear", "quadratic", "cubic", "peak-ring", "peak-ring-as-printed"};

struct BubbleLaw {
  BubbleLawKind kind = BubbleLawKind::cubic;
  double scale = 3;    ///< K [1/s, 1/(m s), 1/(m^2 s)]; of the peak rings v* [m/s]
  double peak = 0.15;  ///< x*: distance of the peak, of the radius
  double taper = 0.3;  ///< beta: what is left of v* far outside

  /// Rate of a bubble of radius R [m/s]; 0 on its surface and inside. All laws but the printed one are continuous.
  /// @param x  m, outside of its surface
  [[nodiscard]] double rate(double x, double R) const;
};

}  // namespace verisim
