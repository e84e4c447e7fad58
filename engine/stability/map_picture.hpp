// A map as a picture: a dot for every cell, in the colour of its outcome, and the curve of theory through it.
#pragma once

#include "engine/stability/row.hpp"

namespace verisim::stability {

/// SVG: x logarithmic, a line of dots for each value of y, a panel for each value of `panel`. Theory: the figure
/// `bound` of the cells. @pre every cell has the figures that the description names, x above 0; there is one
[[nodiscard]] std::string picture_of(const MapDescription& map, const std::vector<Row>& cells);

}  // namespace verisim::stability
