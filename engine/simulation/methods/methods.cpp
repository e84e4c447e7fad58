// The hybrid methods that there are, in the order of their precedence.
#include <array>

#include "engine/simulation/hybrid_method.hpp"

namespace verisim::hybrid {

std::span<const Hybrid> all() {
  static const std::array methods = {off, restore, blend, exact};
  return methods;
}

}  // namespace verisim::hybrid
