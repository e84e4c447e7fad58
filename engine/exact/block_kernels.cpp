#include "engine/exact/block_kernels.hpp"

#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/exact/block_kernels.cpp"
#include "hwy/foreach_target.h"  // compiles this file once per target
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace verisim::exact::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// The six rows of one column of a block: four and two, or as many vectors as these take.
class Column {
 public:
  HWY_INLINE Column() = default;
  HWY_INLINE explicit Column(const double* from) {
    for (std::size_t i = 0; i < kFour; ++i) four_[i] = hn::LoadU(kD4, from + i * kLanes4);
    for (std::size_t i = 0; i < kTwo; ++i) two_[i] = hn::LoadU(kD2, from + 4 + i * kLanes2);
  }
  HWY_INLINE void store(double* to) const {
    for (std::size_t i = 0; i < kFour; ++i) hn::StoreU(four_[i], kD4, to + i * kLanes4);
    for (std::size_t i = 0; i < kTwo; ++i) hn::StoreU(two_[i], kD2, to + 4 + i * kLanes2);
  }
  /// Subtracts a column times a number.
  HWY_INLINE void subtract(const Column& a, double b) {
    for (std::size_t i = 0; i < kFour; ++i) four_[i] = hn::Sub(four_[i], hn::Mul(a.four_[i], hn::Set(kD4, b)));
    for (std::size_t i = 0; i < kTwo; ++i) two_[i] = hn::Sub(two_[i], hn::Mul(a.two_[i], hn::Set(kD2, b)));
  }
  HWY_INLINE void scale(double b) {
    for (std::size_t i = 0; i < kFour; ++i) four_[i] = hn::Mul(four_[i], hn::Set(kD4, b));
    for (std::size_t i = 0; i < kTwo; ++i) two_[i] = hn::Mul(two_[i], hn::Set(kD2, b));
  }

 private:
  using D4 = hn::CappedTag<double, 4>;
  using D2 = hn::CappedTag<double, 2>;
  static constexpr D4 kD4{};
  static constexpr D2 kD2{};
  static constexpr std::size_t kLanes4 = hn::MaxLanes(D4()), kLanes2 = hn::MaxLanes(D2());
  static constexpr std::size_t kFour = 4 / kLanes4, kTwo = 2 / kLanes2;
  hn::Vec<D4> four_[kFour];
  hn::Vec<D2> two_[kTwo];
};

/// A = L L^T in place of the lower triangle; the diagonal of L is inverted.
HWY_INLINE void factor_diagonal(double* A) {
  for (std::size_t j = 0; j < 6; ++j) {
    double pivot = A[6 * j + j];
    for (std::size_t k = 0; k < j; ++k) pivot -= A[6 * k + j] * A[6 * k + j];
    const double inverse = 1 / std::sqrt(pivot);
    for (std::size_t i = j + 1; i < 6; ++i) {
      double sum = A[6 * j + i];
      for (std::size_t k = 0; k < j; ++k) sum -= A[6 * k + i] * A[6 * k + j];
      A[6 * j + i] = sum * inverse;
    }
    A[6 * j + j] = inverse;
  }
}

/// B L^-T in place of B.
HWY_INLINE void divide(double* B, const double* L) {
  Column columns[6];
  for (std::size_t j = 0; j < 6; ++j) {
    columns[j] = Column(B + 6 * j);
    for (std::size_t k = 0; k < j; ++k) columns[j].subtract(columns[k], L[6 * k + j]);
    columns[j].scale(L[6 * j + j]);
    columns[j].store(B + 6 * j);
  }
}

/// C - A B^T in place of C. Two columns at once: what is summed stays in registers.
HWY_INLINE void subtract_product(double* C, const double* A, const double* B) {
  for (std::size_t j = 0; j < 6; j += 2) {
    Column first(C + 6 * j);
    Column second(C + 6 * j + 6);
    for (std::size_t k = 0; k < 6; ++k) {
      const Column a(A + 6 * k);
      first.subtract(a, B[6 * k + j]);
      second.subtract(a, B[6 * k + j + 1]);
    }
    first.store(C + 6 * j);
    second.store(C + 6 * j + 6);
  }
}

void factor(const BlockPattern& m, double* values, double* diagonal) {
  for (std::size_t j = 0; j < m.columns; ++j) {
    const double* L = diagonal + 36 * j;
    factor_diagonal(diagonal + 36 * j);
    const std::size_t end = m.begin[j + 1];
    for (std::size_t b = m.begin[j]; b < end; ++b) divide(values + 36 * b, L);
    for (std::size_t b = m.begin[j]; b < end; ++b) {
      const double* B = values + 36 * b;
      const std::size_t column = m.row[b];
      subtract_product(diagonal + 36 * column, B, B);
      std::size_t to = m.begin[column];
      for (std::size_t a = b + 1; a < end; ++a) {
        while (m.row[to] != m.row[a]) ++to;  // the pattern of the column holds all that is left of this one's
        subtract_product(values + 36 * to, values + 36 * a, B);
      }
    }
  }
}

void solve(const BlockPattern& m, const double* values, const double* diagonal, double* x) {
  for (std::size_t j = 0; j < m.columns; ++j) {
    const double* L = diagonal + 36 * j;
    double* y = x + 6 * j;
    for (std::size_t c = 0; c < 6; ++c) {
      y[c] *= L[6 * c + c];
      for (std::size_t r = c + 1; r < 6; ++r) y[r] -= L[6 * c + r] * y[c];
    }
    for (std::size_t b = m.begin[j]; b < m.begin[j + 1]; ++b) {
      double* to = x + 6 * m.row[b];
      Column sum(to);
      for (std::size_t c = 0; c < 6; ++c) sum.subtract(Column(values + 36 * b + 6 * c), y[c]);
      sum.store(to);
    }
  }
  for (std::size_t j = m.columns; j-- > 0;) {
    const double* L = diagonal + 36 * j;
    double* y = x + 6 * j;
    for (std::size_t b = m.begin[j]; b < m.begin[j + 1]; ++b) {
      const double* B = values + 36 * b;
      const double* of_row = x + 6 * m.row[b];
      for (std::size_t c = 0; c < 6; ++c)
        for (std::size_t r = 0; r < 6; ++r) y[c] -= B[6 * c + r] * of_row[r];
    }
    for (std::size_t c = 6; c-- > 0;) {
      for (std::size_t r = c + 1; r < 6; ++r) y[c] -= L[6 * c + r] * y[r];
      y[c] *= L[6 * c + c];
    }
  }
}

}  // namespace verisim::exact::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace verisim::exact {
namespace {
HWY_EXPORT(factor);
HWY_EXPORT(solve);
}  // namespace

void factor_blocks(const BlockPattern& pattern, double* values, double* diagonal) {
  HWY_DYNAMIC_DISPATCH(factor)(pattern, values, diagonal);
}

void solve_blocks(const BlockPattern& pattern, const double* values, const double* diagonal, double* b) {
  HWY_DYNAMIC_DISPATCH(solve)(pattern, values, diagonal, b);
}

}  // namespace verisim::exact
#endif
