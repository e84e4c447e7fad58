#include "engine/exact/trim.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/pinned_math.hpp"

namespace verisim::exact {
namespace {

using Chart = std::array<double, 2>;

constexpr double kTurn = 4;  ///< once around, in turns of AnalyticSurface::chart

/// How the chart's two coordinates run for a kind of surface.
struct Layout {
  bool a_around, b_around;
  double a_metres, b_metres;  ///< metres per unit of the coordinate, the largest on the surface
};

Layout layout_of(const AnalyticSurface& s, double widest_radius) {
  const double per_turn = 2 * pinned::kPi / kTurn;
  const double radius = s.meridian().radius;
  switch (s.kind()) {
    case SurfaceKind::plane:
      return {false, false, 1, 1};
    case SurfaceKind::cylinder:
    case SurfaceKind::cone:
      return {true, false, per_turn * widest_radius, 1};
    case SurfaceKind::sphere:
      return {true, false, per_turn * radius, radius};
    case SurfaceKind::torus:
      break;
  }
  return {true, true, per_turn * (s.meridian().ring + radius), per_turn * radius};
}

double distance_from_axis(const AnalyticSurface& s, const Vector3d& p) {
  return profile_of(p, s.point(), s.axis(), [] { return Vector3d::Zero(); }).rho;
}

double wrapped(double turn) {
  return turn - kTurn * std::floor(turn / kTurn);
}

/// Does a triangle lie over the place of a ball beyond its centre in a direction? To the rounding of its corners.
bool lies_over(const std::array<Vector3d, 3>& corner, const Vector3d& center, const Vector3d& direction) {
  constexpr double kRounding = 1e-6;  // of the triangle
  const Vector3d a = corner[0] - center, b = corner[1] - center, c = corner[2] - center;
  const Vector3d weights(direction.dot(b.cross(c)), direction.dot(c.cross(a)), direction.dot(a.cross(b)));
  const double sum = weights.sum();
  if (sum == 0 || (weights.array() / sum < -kRounding).any()) return false;
  return direction.dot(weights.x() * a + weights.y() * b + weights.z() * c) / sum > 0;
}

/// Are the poles of a ball, against its axis and along it, within a face? They need not be corners of a triangle.
std::array<bool, 2> poles_within(const AnalyticSurface& ball, const TriangleMesh& mesh,
                                 std::span<const std::uint32_t> triangles) {
  std::array<bool, 2> within = {false, false};
  for (const std::uint32_t t : triangles) {
    const auto& v = mesh.triangles[t];
    const std::array<Vector3d, 3> corner = {mesh.vertices[v[0]], mesh.vertices[v[1]], mesh.vertices[v[2]]};
    within[0] = within[0] || lies_over(corner, ball.point(), -ball.axis());
    within[1] = within[1] || lies_over(corner, ball.point(), ball.axis());
  }
  return within;
}

/// A place of a triangle or a bound, and where it is in the chart. Between two of them a flat triangle leaves the
/// surface, and its chart there is not the surface's: near a ball's pole, and across a torus's tube if its facets are
/// wide. So midpoints are brought back to the ball, and taken in the chart of a torus.
struct ChartPlace {
  Vector3d point;
  Chart chart;
};
ChartPlace place_of(const AnalyticSurface& s, const Vector3d& point) {
  return {point, s.chart(point)};
}
double way_of(double from, double to, bool around) {
  const double way = to - from;
  return around ? way - kTurn * std::round(way / kTurn) : way;
}
ChartPlace between(const AnalyticSurface& s, const ChartPlace& a, const ChartPlace& b, double share) {
  const Vector3d point = a.point + share * (b.point - a.point);
  if (s.kind() == SurfaceKind::sphere) return place_of(s, s.foot(point));
  if (s.kind() != SurfaceKind::torus) return place_of(s, point);
  ChartPlace place{point, {}};
  for (std::size_t i = 0; i < 2; ++i)
    place.chart[i] = wrapped(a.chart[i] + share * way_of(a.chart[i], b.chart[i], true));
  return place;
}

/// Calls visit(chart) along a bound, at places no farther apart than `step` [m].
template <typename Visit>
void walk(const AnalyticSurface& surface, std::span<const Vector3d> points, double step, Visit&& visit) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const ChartPlace from = place_of(surface, points[i == 0 ? 0 : i - 1]);
    const ChartPlace to = place_of(surface, points[i]);
    const int pieces = 1 + static_cast<int>((to.point - from.point).norm() / step);
    for (int j = 0; j <= pieces; ++j) visit(between(surface, from, to, static_cast<double>(j) / pieces).chart);
  }
}

/// Calls visit(chart) at places of a triangle that are no farther apart than half a cell, corners included: it halves
/// the side that is longest in the chart until all are short there. Beside a pole or an apex, where turns are
/// everywhere, until they are short in space.
template <typename Visit>
class TrianglePlaces {
 public:
  /// @param per_unit  cells per unit of the chart   @param shortest  m
  TrianglePlaces(const AnalyticSurface& surface, const Layout& layout, const Chart& per_unit, double shortest,
                 Visit visit)
      : surface_(surface), layout_(layout), per_unit_(per_unit), shortest_(shortest), visit_(visit) {}

  void run(const TriangleMesh& mesh, std::uint32_t triangle) {
    const auto& v = mesh.triangles[triangle];
    const std::array<ChartPlace, 3> corner = {place_of(surface_, mesh.vertices[v[0]]),
                                              place_of(surface_, mesh.vertices[v[1]]),
                                              place_of(surface_, mesh.vertices[v[2]])};
    for (const ChartPlace& place : corner) visit_(place.chart);
    halve(corner);
  }

 private:
  void halve(const std::array<ChartPlace, 3>& corner) {
    std::size_t longest = 0;
    double cells = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double here = cells_between(corner[i], corner[(i + 1) % 3]);
      if (here <= cells) continue;
      cells = here;
      longest = i;
    }
    if (cells <= 0.45) return;  // two such steps are less than a cell
    const ChartPlace &a = corner[longest], &b = corner[(longest + 1) % 3], &c = corner[(longest + 2) % 3];
    const ChartPlace middle = between(surface_, a, b, 0.5);
    visit_(middle.chart);
    halve({a, middle, c});
    halve({middle, b, c});
  }

  [[nodiscard]] double cells_between(const ChartPlace& a, const ChartPlace& b) const {
    if ((a.point - b.point).squaredNorm() <= shortest_ * shortest_) return 0;
    return std::max(std::abs(way_of(a.chart[0], b.chart[0], layout_.a_around)) * per_unit_[0],
                    std::abs(way_of(a.chart[1], b.chart[1], layout_.b_around)) * per_unit_[1]);
  }
  const AnalyticSurface& surface_;
  const Layout& layout_;
  Chart per_unit_;
  double shortest_;
  Visit visit_;
};

/// What a face covers of its chart, and how far it reaches from the axis [m].
struct Extent {
  Chart low{1e300, 1e300};
  Chart high{-1e300, -1e300};
  double widest;
};

Extent extent_of(const AnalyticSurface& surface, const TriangleMesh& mesh, std::span<const std::uint32_t> triangles,
                 std::span<const Trim::Border> borders) {
  Extent extent{.widest = surface.meridian().radius};
  const auto include = [&](const Vector3d& p) {
    const Chart c = surface.chart(p);
    for (std::size_t i = 0; i < 2; ++i) {
      extent.low[i] = std::min(extent.low[i], c[i]);
      extent.high[i] = std::max(extent.high[i], c[i]);
    }
    extent.widest = std::max(extent.widest, distance_from_axis(surface, p));
  };
  for (const std::uint32_t t : triangles)
    for (const std::uint32_t v : mesh.triangles[t]) include(mesh.vertices[v]);
  for (const Trim::Border& border : borders)
    for (const Vector3d& p : border.points) include(p);
  if (surface.kind() == SurfaceKind::sphere) {
    const auto [south, north] = poles_within(surface, mesh, triangles);
    if (south) extent.low[1] = -1;
    if (north) extent.high[1] = 1;
  }
  return extent;
}

bool are_all_inside(std::span<const Trim::Where> cells) {
  return std::all_of(cells.begin(), cells.end(), [](Trim::Where cell) { return cell == Trim::Where::inside; });
}

}  // namespace

int Trim::Axis::index(double x) const {
  const double i = (x - from) * per_cell;
  if (around) return std::clamp(static_cast<int>(i), 0, count - 1);
  return i >= 0 && i < count ? static_cast<int>(i) : -1;
}

int Trim::Axis::neighbour(int i, int step) const {
  const int n = i + step;
  if (around) return (n + count) % count;
  return n >= 0 && n < count ? n : -1;
}

std::array<int, 2> Trim::Axis::cells_of(double x) const {
  constexpr double kRounding = 1e-6;  // of a cell
  const double i = (x - from) * per_cell;
  const double within = i - std::floor(i);
  return {within < kRounding ? -1 : 0, within > 1 - kRounding ? 1 : 0};
}

int Trim::cell_at(const std::array<double, 2>& chart) const {
  const int a = a_.index(chart[0]);
  const int b = b_.index(chart[1]);
  return a < 0 || b < 0 ? -1 : b * a_.count + a;
}

Trim::Trim(const AnalyticSurface& surface, const TriangleMesh& mesh, std::span<const std::uint32_t> triangles,
           std::span<const Border> borders, const Cells& cells) {
  const double cell = cells.size;
  const Extent extent = extent_of(surface, mesh, triangles, borders);
  const Chart& low = extent.low;
  const Chart& high = extent.high;
  const bool has_poles = surface.kind() == SurfaceKind::sphere;
  const Layout layout = layout_of(surface, extent.widest);
  const auto make_axis = [&](bool around, double metres, double from, double to) {
    Axis axis;
    axis.around = around;
    const double span = around ? kTurn : to - from;
    const int inner = static_cast<int>(std::clamp(std::ceil(span * metres / cell), 1.0, double(cells.count_max)));
    axis.cell = std::max(span / inner, cell / metres * 0x1p-10);
    axis.count = around ? inner : inner + 2;  // a cell more on either side: near the border, but beyond it
    axis.from = around ? 0 : from - axis.cell;
    axis.per_cell = 1 / axis.cell;
    return axis;
  };
  a_ = make_axis(layout.a_around, layout.a_metres, low[0], high[0]);
  b_ = make_axis(layout.b_around, layout.b_metres, low[1], high[1]);
  const auto cell_count = static_cast<std::size_t>(a_.count) * static_cast<std::size_t>(b_.count);
  cells_.assign(cell_count, Where::outside);

  // What triangles cover is inside, before borders have their say.
  const double smallest = std::min(a_.cell * layout.a_metres, b_.cell * layout.b_metres);
  TrianglePlaces places(surface, layout, {a_.per_cell, b_.per_cell}, 0x1p-14 * smallest, [&](const Chart& chart) {
    const int at = cell_at(chart);
    if (at >= 0) cells_[static_cast<std::size_t>(at)] = Where::inside;
  });
  for (const std::uint32_t t : triangles) places.run(mesh, t);

  // A ball's pole is one place of all the last cells, and to rounding of those beyond them, which are nowhere else.
  const auto row = [&](int b) { return cells_.begin() + std::ptrdiff_t{b} * a_.count; };
  if (has_poles) {
    if (low[1] <= -1) std::copy_n(row(1), a_.count, row(0));
    if (high[1] >= 1) std::copy_n(row(b_.count - 2), a_.count, row(b_.count - 1));
  }

  // Cells that an edge passes, and their neighbours.
  const double step = 0.45 * smallest;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> passes;  // cell, edge
  std::vector<bool> crossed(cell_count, false);
  const auto mark = [&](const Chart& chart, std::uint32_t edge) {
    const int at = cell_at(chart);
    if (at < 0) return;
    const int a = at % a_.count;
    const int b = at / a_.count;
    const bool near_pole =
        has_poles && std::abs(chart[1]) > cells.near_pole;  // turns are short there: all of them are near
    const int half = a_.count / 2;
    const auto [a_first, a_last] = near_pole ? std::array{1 - half, half - 1} : a_.cells_of(chart[0]);
    const auto [b_first, b_last] = b_.cells_of(chart[1]);
    for (int db = b_first - 1; db <= b_last + 1; ++db) {
      for (int da = a_first - 1; da <= a_last + 1; ++da) {
        const int na = a_.neighbour(a, da);
        const int nb = b_.neighbour(b, db);
        if (na < 0 || nb < 0) continue;
        const auto cell_number = static_cast<std::uint32_t>(nb * a_.count + na);
        passes.emplace_back(cell_number, edge);
        const bool is_within = near_pole || (da >= a_first && da <= a_last);
        if (is_within && db >= b_first && db <= b_last) crossed[cell_number] = true;
      }
    }
  };
  for (const Border& border : borders) {
    walk(surface, border.points, step, [&](const Chart& chart) { mark(chart, border.edge); });
    std::sort(passes.begin(), passes.end());
    passes.erase(std::unique(passes.begin(), passes.end()), passes.end());
  }
  name_edges(passes, crossed);
  is_whole_ = a_.around && (b_.around || (has_poles && low[1] <= -1 && high[1] >= 1)) && are_all_inside(cells_);
}

void Trim::name_edges(std::span<const std::pair<std::uint32_t, std::uint32_t>> passes,
                      const std::vector<bool>& crossed) {
  first_edge_.assign(cells_.size() + 1, 0);
  for (const auto& [at, edge] : passes) {
    Where& cell_is = cells_[at];
    const bool is_out = cell_is == Where::outside || cell_is == Where::beside;
    cell_is = is_out && !crossed[at] ? Where::beside : Where::border;
    ++first_edge_[at + 1];
    edges_.push_back(edge);
  }
  for (std::size_t i = 0; i < cells_.size(); ++i) first_edge_[i + 1] += first_edge_[i];
}

Trim::Answer Trim::find(const AnalyticSurface& surface, const Vector3d& foot) const {
  const int at = cell_at(surface.chart(foot));
  if (at < 0) return {Where::outside, {}};
  const auto cell = static_cast<std::size_t>(at);
  return {cells_[cell], std::span(edges_).subspan(first_edge_[cell], first_edge_[cell + 1] - first_edge_[cell])};
}

}  // namespace verisim::exact
