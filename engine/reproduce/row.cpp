#include "engine/reproduce/row.hpp"

#include "engine/base/error.hpp"

namespace verisim::reproduce {

std::optional<double> ratio(const Row& row) {
  const double* published = std::get_if<double>(&row.published);
  const double* here = std::get_if<double>(&row.here);
  if (published == nullptr || here == nullptr || *published == 0) return std::nullopt;
  return *here / *published;
}

double RunFigures::measure(const std::string& name) const {
  for (const auto& [key, value] : measures)
    if (key == name) return value;
  fail(ErrorKind::input, "{}: the scenario measured no '{}'; run it by itself to see what it measures", run_file, name);
}

}  // namespace verisim::reproduce
