// What the dividers of a solid are on a patch: their models, and from these their least and largest values on what is
// left of it. Private to this folder.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "engine/ruler/coaxial.hpp"
#include "engine/ruler/values.hpp"

namespace verisim::ruler {

class Ranges {
 public:
  explicit Ranges(const Csg& csg) : csg_(csg), models_(csg.dividers().size()) {
    low_.resize(models_.size());
    high_.resize(models_.size());
    sides_.resize(models_.size());
  }

  /// On all of the patch. @pre `values` are those at its middle
  void of(const Patch& patch, const Values& values) {
    const double radius = patch.radius();
    for (std::uint32_t i = 0; i < models_.size(); ++i) {
      low_[i] = values[i] - radius;
      high_[i] = values[i] + radius;
      if (low_[i] <= 0 && high_[i] >= 0) {
        models_[i] = best_model_of(csg_.dividers()[i], patch);
        const double wide = std::abs(models_[i].linear.du) + std::abs(models_[i].linear.dv);
        low_[i] = std::max(low_[i], models_[i].linear.at - wide - models_[i].below);
        high_[i] = std::min(high_[i], models_[i].linear.at + wide + models_[i].above);
      }
      sides_[i] = side(i);
    }
  }
  /// On what is left of it. @pre polygon is not empty
  void narrow(const Polygon& polygon) {
    for (std::uint32_t i = 0; i < models_.size(); ++i) {
      if (sides_[i] != 0) continue;
      low_[i] = std::max(low_[i], -largest((-models_[i]).linear, polygon) - models_[i].below);
      high_[i] = std::min(high_[i], largest(models_[i].linear, polygon) + models_[i].above);
      sides_[i] = side(i);
    }
  }

  [[nodiscard]] std::size_t size() const { return models_.size(); }
  [[nodiscard]] double low(std::size_t i) const { return low_[i]; }
  [[nodiscard]] double high(std::size_t i) const { return high_[i]; }
  /// Above 0 where all of the patch is above the divider, below 0 where it is below, 0 if there may be both.
  [[nodiscard]] std::vector<std::int8_t>& sides() { return sides_; }
  /// @pre once there may have been both
  [[nodiscard]] const Model& model(std::size_t i) const { return models_[i]; }

 private:
  [[nodiscard]] std::int8_t side(std::size_t i) const {
    return static_cast<std::int8_t>(low_[i] > 0 ? 1 : high_[i] < 0 ? -1 : 0);
  }

  const Csg& csg_;
  std::vector<Model> models_;
  std::vector<double> low_, high_;
  std::vector<std::int8_t> sides_;
};

}  // namespace verisim::ruler
