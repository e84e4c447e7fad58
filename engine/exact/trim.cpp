#include "engine/exact/trim.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/pinned_math.hpp"

namespace verisim::exact {
namespace {

using Chart = std::array<double, 2>;

constexpr int kCellsMax = 48;
constexpr double kTurn = 4;  ///< once around, in turns of AnalyticSurface::chart

/// How the chart's two coordinates run for a kind of surface.
struct Layout {
  bool a_around, b_around;
  double a_metres, b_metres;  ///< metres per unit of the coordinate, the largest on the surface
};

Layout layout_of(const PreciseSurface& s, double widest_radius) {
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

double distance_from_axis(const PreciseSurface& s, const Vector3d& p) {
  return profile_of(p, s.point(), s.axis(), [] { return Vector3d::Zero(); }).rho;
}

/// Calls visit(point) at places of the triangle no farther apart than `step`, corners included.
template <typename Visit>
void for_each_place(std::array<Vector3d, 3> corner, double step, Visit&& visit) {
  const auto opposite = [&](int i) { return (corner[(i + 1) % 3] - corner[(i + 2) % 3]).squaredNorm(); };
  int apex = 0;
  for (int i = 1; i < 3; ++i) apex = opposite(i) > opposite(apex) ? i : apex;
  std::rotate(corner.begin(), corner.begin() + apex, corner.end());
  const Vector3d base = corner[2] - corner[1];  // the longest side
  const Vector3d side = corner[0] - corner[1];
  const double length = base.norm();
  const double height = length > 0 ? base.cross(side).norm() / length : side.norm();
  const int rows = 1 + static_cast<int>(std::ceil(height / step));
  for (int i = 0; i <= rows; ++i) {
    const double h = static_cast<double>(i) / rows;
    const int columns = 1 + static_cast<int>(std::ceil((1 - h) * length / step));
    for (int j = 0; j <= columns; ++j) visit(corner[1] + h * side + (1 - h) * static_cast<double>(j) / columns * base);
  }
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

std::array<int, 2> Trim::Axis::around_of(double x) const {
  constexpr double kRounding = 1e-6;  // of a cell
  const double i = (x - from) * per_cell;
  const double within = i - std::floor(i);
  return {within < kRounding ? -2 : -1, within > 1 - kRounding ? 2 : 1};
}

int Trim::cell_at(const std::array<double, 2>& chart) const {
  const int a = a_.index(chart[0]);
  const int b = b_.index(chart[1]);
  return a < 0 || b < 0 ? -1 : b * a_.count + a;
}

Trim::Trim(const PreciseSurface& surface, const TriangleMesh& mesh, std::span<const std::uint32_t> triangles,
           std::span<const Border> borders, double cell) {
  // The chart's extent.
  Chart low{1e300, 1e300};
  Chart high{-1e300, -1e300};
  double widest = surface.meridian().radius;
  const auto include = [&](const Vector3d& p) {
    const Chart c = surface.chart(p);
    for (std::size_t i = 0; i < 2; ++i) {
      low[i] = std::min(low[i], c[i]);
      high[i] = std::max(high[i], c[i]);
    }
    widest = std::max(widest, distance_from_axis(surface, p));
  };
  for (const std::uint32_t t : triangles)
    for (const std::uint32_t v : mesh.triangles[t]) include(mesh.vertices[v]);
  for (const Border& border : borders)
    for (const Vector3d& p : border.points) include(p);

  const Layout layout = layout_of(surface, widest);
  const auto make_axis = [&](bool around, double metres, double from, double to) {
    Axis axis;
    axis.around = around;
    const double extent = around ? kTurn : to - from;
    const int inner = static_cast<int>(std::clamp(std::ceil(extent * metres / cell), 1.0, double{kCellsMax}));
    axis.cell = std::max(extent / inner, cell / metres * 0x1p-10);
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
  const double step = 0.45 * std::min(a_.cell * layout.a_metres, b_.cell * layout.b_metres);
  for (const std::uint32_t t : triangles) {
    const auto& v = mesh.triangles[t];
    for_each_place({mesh.vertices[v[0]], mesh.vertices[v[1]], mesh.vertices[v[2]]}, step, [&](const Vector3d& p) {
      const int at = cell_at(surface.chart(p));
      if (at >= 0) cells_[static_cast<std::size_t>(at)] = Where::inside;
    });
  }

  // A ball's pole is one place of all the last cells, and to rounding of those beyond them, which are nowhere else.
  const auto row = [&](int b) { return cells_.begin() + std::ptrdiff_t{b} * a_.count; };
  constexpr double kPole = 1 - 1e-9;
  if (surface.kind() == SurfaceKind::sphere) {
    if (low[1] < -kPole) std::copy_n(row(1), a_.count, row(0));
    if (high[1] > kPole) std::copy_n(row(b_.count - 2), a_.count, row(b_.count - 1));
  }

  // Cells that an edge passes, and their neighbours.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> passes;  // cell, edge
  const bool has_poles = surface.kind() == SurfaceKind::sphere;
  const auto mark = [&](const Vector3d& p, std::uint32_t edge) {
    const Chart chart = surface.chart(p);
    const int at = cell_at(chart);
    if (at < 0) return;
    const int a = at % a_.count;
    const int b = at / a_.count;
    const bool near_pole = has_poles && std::abs(chart[1]) > 0.9;  // turns are short there: all of them are near
    const int half = a_.count / 2;
    const auto [a_first, a_last] = near_pole ? std::array{-half, half} : a_.around_of(chart[0]);
    const auto [b_first, b_last] = b_.around_of(chart[1]);
    for (int db = b_first; db <= b_last; ++db) {
      for (int da = a_first; da <= a_last; ++da) {
        const int na = a_.neighbour(a, da);
        const int nb = b_.neighbour(b, db);
        if (na >= 0 && nb >= 0) passes.emplace_back(static_cast<std::uint32_t>(nb * a_.count + na), edge);
      }
    }
  };
  for (const Border& border : borders) {
    for (std::size_t i = 0; i < border.points.size(); ++i) {
      const Vector3d& from = border.points[i == 0 ? 0 : i - 1];
      const Vector3d& to = border.points[i];
      const int pieces = 1 + static_cast<int>((to - from).norm() / step);
      for (int j = 0; j <= pieces; ++j) mark(from + static_cast<double>(j) / pieces * (to - from), border.edge);
    }
    std::sort(passes.begin(), passes.end());
    passes.erase(std::unique(passes.begin(), passes.end()), passes.end());
  }
  first_edge_.assign(cell_count + 1, 0);
  for (const auto& [at, edge] : passes) {
    cells_[at] = Where::border;
    ++first_edge_[at + 1];
    edges_.push_back(edge);
  }
  for (std::size_t i = 0; i < cell_count; ++i) first_edge_[i + 1] += first_edge_[i];
}

Trim::Answer Trim::find(const PreciseSurface& surface, const Vector3d& foot) const {
  const int at = cell_at(surface.chart(foot));
  if (at < 0) return {Where::outside, {}};
  const auto cell = static_cast<std::size_t>(at);
  return {cells_[cell], std::span(edges_).subspan(first_edge_[cell], first_edge_[cell + 1] - first_edge_[cell])};
}

}  // namespace verisim::exact
