// Pictures as SVG text: no fonts, scripts or times in it, so that equal figures give equal files. Coordinates are
// pixels, y down.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace verisim::svg {

/// The i-th of Okabe and Ito's colours, told apart by everybody; after the eighth the first again.
[[nodiscard]] const char* colour(std::size_t i);
[[nodiscard]] std::string line(double x1, double y1, double x2, double y2, const char* stroke, double width);
/// Through all points, open. @pre there is one
[[nodiscard]] std::string polyline(const std::vector<std::pair<double, double>>& points, const char* stroke);
[[nodiscard]] std::string dot(double x, double y, const char* fill);
/// @param anchor  "start", "middle", "end"  @pre words holds no '<' or '&'
[[nodiscard]] std::string text(double x, double y, const char* anchor, const std::string& words,
                               const char* fill = "#222");
/// Names beside each other, each with its colour.
[[nodiscard]] std::string legend(const std::vector<std::string>& names, double x, double y);
/// The whole file, on white.
[[nodiscard]] std::string picture(double width, double height, const std::string& content);

}  // namespace verisim::svg
