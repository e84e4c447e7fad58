#include "engine/ruler/ruler.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/ruler/solid_depth.hpp"

namespace verisim::ruler {
namespace {

const NamedArray* table(const PartData& part, const char* name) {
  const auto found =
      std::find_if(part.tables.begin(), part.tables.end(), [&](const NamedArray& t) { return t.name == name; });
  return found == part.tables.end() ? nullptr : &*found;
}

template <typename T, typename Row>
std::vector<Row> rows_of(const PartData& part, const char* name) {
  const NamedArray* found = table(part, name);
  if (found == nullptr)
    fail(ErrorKind::input, "part '{}' has no table '{}'; what holds it is damaged", part.name, name);
  const std::vector<T> flat = found->as<T>();
  std::vector<Row> rows(flat.size() / 3);
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) rows[i][static_cast<Eigen::Index>(k)] = flat[3 * i + k];
  return rows;
}

Triangles triangles_of(const PartData& part) {
  auto vertices = rows_of<double, Vector3d>(part, "vertices");
  const auto rows = rows_of<std::uint32_t, Eigen::Matrix<std::uint32_t, 3, 1>>(part, "triangles");
  std::vector<std::array<std::uint32_t, 3>> triangles;
  triangles.reserve(rows.size());
  for (const auto& row : rows) {
    if (row.maxCoeff() >= vertices.size())
      fail(ErrorKind::input, "part '{}': a triangle has a corner that there is not; what holds it is damaged",
           part.name);
    triangles.push_back({row[0], row[1], row[2]});
  }
  return {std::move(vertices), std::move(triangles)};
}

bool is_closed(const PartData& part) {
  const NamedArray* flags = table(part, "flags");
  return flags != nullptr && flags->count() > 0 && flags->as<std::uint8_t>().front() != 0;
}

}  // namespace

Shape::Shape(const std::vector<PartData>& parts) {
  for (const PartData& part : parts) {
    Piece piece{part.name, {}, {}};
    if (!part.solid.empty()) piece.solid.emplace(part.solid);
    if (is_closed(part)) piece.mesh.emplace(triangles_of(part));
    pieces_.push_back(std::move(piece));
  }
}

std::string why_not(const Shape& a, const Shape& b) {
  for (const auto& [one, other] : {std::pair{&a, &b}, {&b, &a}}) {
    const bool other_is_solid = std::all_of(other->pieces_.begin(), other->pieces_.end(),
                                            [](const Shape::Piece& piece) { return piece.solid.has_value(); });
    for (const Shape::Piece& piece : one->pieces_)
      if (!piece.mesh && !(piece.solid && other_is_solid))
        return "'" + piece.name + "' is not closed, so that nothing says where its inside is; close it";
  }
  return {};
}

/// Pairs of parts, one after the other; the deepest counts.
struct Measurer {
  const Pose& X_WA;
  const Pose& X_WB;
  const Accuracy& accuracy;
  Overlap worst{};
  double limit = 0;  ///< no pair so far is deeper

  void take(const Depth& depth, const Pose& X_W, Source source) {
    limit = std::max(limit, depth.depth + depth.bound);
    if (depth.depth > worst.depth) {
      worst.depth = depth.depth;
      worst.place_W = X_W * depth.place;
    }
    if (source == Source::triangles) worst.source = source;
  }
  void measure(const Shape& a, const Shape& b) {
    const Pose X_BA = X_WB.inverse() * X_WA;
    for (const Shape::Piece& first : a.pieces_)
      for (const Shape::Piece& second : b.pieces_) {
        if (first.solid && second.solid) {
          const Csg placed = first.solid->placed(X_BA);
          take(depth_in(placed, *second.solid, accuracy), X_WB, Source::solids);
          take(depth_in(*second.solid, placed, accuracy), X_WB, Source::solids);
        } else {
          VERISIM_ASSERT(first.mesh && second.mesh);
          take(depth_in(*first.mesh, X_BA, *second.mesh, accuracy), X_WB, Source::triangles);
          take(depth_in(*second.mesh, X_BA.inverse(), *first.mesh, accuracy), X_WA, Source::triangles);
        }
      }
    worst.bound = std::max(0.0, limit - worst.depth);
  }
};

Overlap overlap(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, const Accuracy& accuracy) {
  VERISIM_ASSERT(why_not(a, b).empty());
  VERISIM_ASSERT(is_placement(X_WA));
  VERISIM_ASSERT(is_placement(X_WB));
  Measurer measurer{X_WA, X_WB, accuracy};
  measurer.measure(a, b);
  return measurer.worst;
}

}  // namespace verisim::ruler
