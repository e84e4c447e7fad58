// The contacts of one pair of bodies in one frame as rows of a convex problem (convex_step.hpp). World coordinates.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/error.hpp"
#include "engine/base/pose.hpp"

namespace verisim::exact {

/// One place where two bodies touch or may touch by the end of the step.
struct ContactRow {
  Vector3d normal;       ///< unit, pushes the second body
  Vector3d point;        ///< where the force acts [m]
  double gap;            ///< m, < 0: the bodies overlap by that much along the normal
  double stiffness;      ///< N/m
  std::uint32_t source;  ///< identifies body, sample and face or edge; the same in the next frame
  double curving = 0;    ///< m: by so much the gap ends above its linear change, if the bodies move on as they did
};

/// Rows up to a capacity. Rows beyond it are counted and left out.
class RowList {
 public:
  explicit RowList(std::size_t capacity) { rows_.reserve(capacity); }
  /// Room for twice as many as there were, if that is more. It allocates: between steps.
  void make_room() {
    const std::size_t wanted = 2 * (rows_.size() + left_out_);
    if (wanted > rows_.capacity()) rows_.reserve(wanted);
  }
  void clear() {
    rows_.clear();
    left_out_ = 0;
  }
  void add(const ContactRow& row) {
    if (rows_.size() < rows_.capacity()) {
      rows_.push_back(row);
    } else {
      ++left_out_;
    }
  }
  [[nodiscard]] const std::vector<ContactRow>& rows() const { return rows_; }
  [[nodiscard]] std::size_t left_out() const { return left_out_; }

 private:
  std::vector<ContactRow> rows_;
  std::size_t left_out_ = 0;
};

}  // namespace verisim::exact
