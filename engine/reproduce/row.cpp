#include "engine/reproduce/row.hpp"

#include "engine/base/error.hpp"

namespace verisim::reproduce {

std::optional<double> ratio(const Row& row) {
  const double* published = std::get_if<double>(&row.published);
  const double* here = std::get_if<double>(&row.here);
  if (published == nullptr || here == nullptr || *published == 0) return std::nullopt;
  return *here / *published;
}

}  // namespace verisim::reproduce
