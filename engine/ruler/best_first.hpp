// Branch and bound: the search for the deepest place of a surface that both rulers make. Of the pieces that wait, the
// one that may hold the deepest place is divided first. One at a time, in an order that the pieces' numbers make
// strict.
#pragma once

#include <algorithm>
#include <queue>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/ruler/depth.hpp"

namespace verisim::ruler {

/// @tparam Piece has `limit` [m], which no place on it is deeper than, `number`, and an order: the deepest limit last
template <typename Piece>
class BestFirst {
 public:
  explicit BestFirst(const Accuracy& accuracy) : accuracy_(accuracy) {
    VERISIM_ASSERT(is_not_negative(accuracy.absolute));
    VERISIM_ASSERT(is_not_negative(accuracy.relative));
  }

  /// A new piece's number.
  std::uint32_t next_number() { return ++found_.pieces; }
  /// A place was found. Only deeper ones count.
  void found(double depth, const Vector3d& place) {
    if (depth <= found_.depth) return;
    found_.depth = depth;
    found_.place = place;
  }
  [[nodiscard]] double depth() const { return found_.depth; }
  /// m; a piece that may not be deeper than this is not worth dividing
  [[nodiscard]] double enough() const {
    return found_.depth + std::max(accuracy_.absolute, accuracy_.relative * found_.depth);
  }
  /// Lets the piece wait, or leaves it as it is: what it may hide counts into the bound.
  void add(const Piece& piece) {
    if (piece.limit > enough())
      waiting_.push(piece);
    else
      leave(piece);
  }

  /// Until nothing is worth dividing, or the pieces allowed are spent, beside those with which it began. @param split
  /// adds parts of the piece that it gets
  template <typename Split>
  Depth run(const Split& split) {
    const std::uint32_t pieces_max = found_.pieces + accuracy_.pieces_max;
    while (!waiting_.empty() && waiting_.top().limit > enough() && found_.pieces < pieces_max) {
      const Piece piece = waiting_.top();
      waiting_.pop();
      split(piece);
    }
    if (!waiting_.empty()) leave(waiting_.top());
    found_.bound = std::max(0.0, dropped_ - found_.depth);
    return found_;
  }

 private:
  void leave(const Piece& piece) { dropped_ = std::max(dropped_, piece.limit); }

  const Accuracy& accuracy_;
  std::priority_queue<Piece> waiting_;
  Depth found_;
  double dropped_ = 0;
};

}  // namespace verisim::ruler
