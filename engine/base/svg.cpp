#include "engine/base/svg.hpp"

#include <fmt/format.h>

#include <array>

#include "engine/base/error.hpp"

namespace verisim::svg {

const char* colour(std::size_t i) {
  static constexpr std::array kColours = {"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                          "#E69F00", "#56B4E9", "#000000", "#999999"};
  return kColours[i % kColours.size()];
}

std::string line(double x1, double y1, double x2, double y2, const char* stroke, double width) {
  return fmt::format("<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\" stroke=\"{}\" stroke-width=\"{}\"/>\n", x1, y1, x2, y2,
                     stroke, width);
}

std::string polyline(const std::vector<std::pair<double, double>>& points, const char* stroke) {
  VERISIM_ASSERT(!points.empty());
  std::string d;
  for (const auto& [x, y] : points) d += fmt::format("{}{:.1f} {:.1f}", d.empty() ? 'M' : 'L', x, y);
  return fmt::format("<path d=\"{}\" stroke=\"{}\" stroke-width=\"1.5\"/>\n", d, stroke);
}

std::string dot(double x, double y, const char* fill) {
  return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2.5\" fill=\"{}\"/>\n", x, y, fill);
}

std::string text(double x, double y, const char* anchor, const std::string& words, const char* fill) {
  VERISIM_ASSERT(words.find_first_of("<&") == std::string::npos);
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" fill=\"{}\">{}</text>\n", x, y, anchor, fill,
                     words);
}

std::string legend(const std::vector<std::string>& names, double x, double y) {
  std::string svg;
  for (std::size_t i = 0; i < names.size(); ++i) {
    svg += line(x, y - 4, x + 18, y - 4, colour(i), 3) + text(x + 23, y, "start", names[i]);
    x += 40 + 6.2 * static_cast<double>(names[i].size());
  }
  return svg;
}

std::string picture(double width, double height, const std::string& content) {
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
      "font-family=\"sans-serif\" font-size=\"11\" fill=\"none\">\n"
      "<rect width=\"{0:.0f}\" height=\"{1:.0f}\" fill=\"#fff\"/>\n{2}</svg>\n",
      width, height, content);
}

}  // namespace verisim::svg
