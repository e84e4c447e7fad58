#include "engine/reproduce/reproductions.hpp"

#include <array>

namespace verisim::reproduce {

std::span<const Reproduction> reproductions() {
  static constexpr std::array kAll = {
      Reproduction{"R7", "trackable area and volume", &r7_coverage},
  };
  return kAll;
}

}  // namespace verisim::reproduce
