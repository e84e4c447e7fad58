// Which part of a surface belongs to a face: a raster over the surface's chart whose cells are outside the face, inside
// it, or near its border. Near the border a cell names the edges that pass; the search then looks at the faces beyond
// them (exact_link.hpp), so that the raster decides nothing finer than a cell.
//
// engine/voxel/trim.hpp knows the same of a face by other means, for it answers another question. The association asks
// once per voxel, when a body is loaded: yes or no, to rounding, of points that no bound is near, by counting how often
// a path crosses the bounds in closed form (10 ns per bound that is crossed). A contact asks in every step, wherever
// its foot slides to, and wants to know more near a border (which edges pass, so that the face beyond can be asked) and
// to be told in 10 ns whatever the number of bounds; an edge without an equation has to be as good as a circle. A
// raster could not give the first its sharpness, and the path could not give the second its neighbours. What both need
// of the surface, its chart and its turns, is engine/geometry/analytic_surface.hpp's.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "engine/geometry/analytic_surface.hpp"
#include "engine/geometry/mesh.hpp"

namespace verisim::exact {

class Trim {
 public:
  /// border: edges pass through the cell; a place that none of them limits is inside. beside: they pass by it, and the
  /// cell itself is outside; a place that none of them limits is outside, because the edge that does limit it may be
  /// too far away to be named.
  enum class Where : std::uint8_t { outside, inside, border, beside };
  /// How fine the raster is. BodyOptions says why.
  struct Cells {
    double size;       ///< wanted [m]
    int count_max;     ///< along each side of the chart
    double near_pole;  ///< sine of a latitude beyond which a border is near on all sides of a ball's pole
  };

  /// @param triangles  the face's, as indices into mesh.triangles: they say on which side of its borders it lies
  /// @param borders    numbers and points of its bounding edges (seams left out); neighbouring points as near as a cell
  /// @param cells      how fine the raster is
  struct Border {
    std::uint32_t edge;
    std::span<const Vector3d> points;
  };
  Trim(const AnalyticSurface& surface, const TriangleMesh& mesh, std::span<const std::uint32_t> triangles,
       std::span<const Border> borders, const Cells& cells);

  struct Answer {
    Where where;
    std::span<const std::uint32_t> edges;  ///< border and beside: edges that pass within a cell or two, ascending
  };
  /// Where a point of the surface lies. About 10 ns.
  [[nodiscard]] Answer find(const AnalyticSurface& surface, const Vector3d& foot) const;

  /// m, of a plane: a foot that is outside now and moves by no more comes to no place that find() answers with inside
  /// or border. 0 of other surfaces.
  [[nodiscard]] double reach_outside() const { return a_.around || b_.around ? 0 : std::min(a_.cell, b_.cell); }

  /// Is every point of the surface inside? Of a ball or a ring with no border.
  [[nodiscard]] bool is_whole() const { return is_whole_; }

  /// For engine/base/archive.hpp.
  static void fields(auto& archive, Trim& self) {
    for (auto* axis : {&self.a_, &self.b_}) archive(axis->from, axis->cell, axis->per_cell, axis->count, axis->around);
    archive(self.is_whole_, self.cells_, self.first_edge_, self.edges_);
  }

 private:
  friend class verisim::ArchiveReader;
  Trim() = default;

  struct Axis {
    double from = 0, cell = 1, per_cell = 1;
    int count = 1;
    bool around = false;  ///< the last cell's neighbour is the first
    [[nodiscard]] int index(double x) const;
    [[nodiscard]] int neighbour(int i, int step) const;  ///< -1: none
    /// Steps from the cell of x to the first and the last cell in which x lies: what lies on the limit of two cells, to
    /// rounding, is in both.
    [[nodiscard]] std::array<int, 2> cells_of(double x) const;
  };
  /// Of cells and edges that pass through them or beside them, ascending; crossed: through them.
  void name_edges(std::span<const std::pair<std::uint32_t, std::uint32_t>> passes, const std::vector<bool>& crossed);
  [[nodiscard]] int cell_at(const std::array<double, 2>& chart) const;

  Axis a_, b_;
  bool is_whole_ = false;
  std::vector<Where> cells_;
  std::vector<std::uint32_t> first_edge_;  ///< (cells + 1): where a cell's edges begin
  std::vector<std::uint32_t> edges_;
};

}  // namespace verisim::exact
