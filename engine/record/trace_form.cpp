#include "engine/record/trace_form.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/base/error.hpp"

namespace verisim {
namespace {

/// s: by so much the difference of two times that are written in decimals may be longer than it is meant to be.
constexpr double kSame = 1e-9;

// Three decimals, as people write times, unless that would hide the difference.
std::string seconds(double t) {
  return std::abs(t * 1000 - std::round(t * 1000)) < 1e-6 ? fmt::format("{:.3f}", t) : fmt::format("{}", t);
}

void check_columns(const Trace& trace, const std::string& name) {
  if (trace.columns.empty() || trace.columns.front() != "t") {
    fail(ErrorKind::input, "{}: the first column must be 't' (s)", name);
  }
  for (std::size_t i = 0; i < trace.columns.size(); ++i) {
    if (trace.column(trace.columns[i]) != static_cast<int>(i)) {
      fail(ErrorKind::input, "{}: there are two columns '{}'; rename one", name, trace.columns[i]);
    }
  }
  for (const ColumnGroup& group : column_groups(name, trace.kind)) {
    std::string missing;
    for (const std::string& column : group.columns) {
      if (trace.column(column) < 0) missing += " " + column;
    }
    const bool all_missing =
        std::none_of(group.columns.begin(), group.columns.end(), [&](const auto& c) { return trace.column(c) >= 0; });
    if (missing.empty() || (all_missing && !group.required)) continue;
    fail(ErrorKind::input, "{}: a {} trace needs the columns{} too; add them", name, trace.kind, missing);
  }
}

/// Sorts rows by time, those of one time in the order in which they were; gives where each row was before.
std::vector<std::size_t> sort_by_time(Trace& trace) {
  std::vector<std::size_t> order(trace.rows());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return trace.at(a, 0) < trace.at(b, 0); });
  std::vector<double> sorted;
  sorted.reserve(trace.values.size());
  const auto width = static_cast<std::ptrdiff_t>(trace.columns.size());
  for (const std::size_t row : order) {
    const auto from = trace.values.begin() + static_cast<std::ptrdiff_t>(row) * width;
    sorted.insert(sorted.end(), from, from + width);
  }
  trace.values = std::move(sorted);
  return order;
}

void check_finite(const Trace& trace, const RowPlace& place) {
  const auto bad = std::find_if(trace.values.begin(), trace.values.end(), [](double v) { return !std::isfinite(v); });
  if (bad == trace.values.end()) return;
  const auto at = static_cast<std::size_t>(bad - trace.values.begin());
  fail(ErrorKind::input, "{}: column '{}' is {}; remove the row or repair it", place(at / trace.columns.size()),
       trace.columns[at % trace.columns.size()], *bad);
}

void check_times(const Trace& trace, const TraceLimits& limits, const RowPlace& place) {
  for (std::size_t row = 1; row < trace.rows(); ++row) {
    const double before = trace.at(row - 1, 0), now = trace.at(row, 0);
    if (now < before) {
      fail(ErrorKind::input, "{}: time goes backwards ({} after {}); sort the trace or use --resort", place(row),
           seconds(now), seconds(before));
    }
    if (now == before)
      fail(ErrorKind::input, "{}: time repeats ({}); remove one of the two rows", place(row), seconds(now));
    if (!limits.allow_gaps && now - before > limits.max_gap + kSame) {
      fail(ErrorKind::input, "{}: a gap of {:.6g} s ({} after {}) is longer than {:g} s; fill it or allow gaps",
           place(row), now - before, seconds(now), seconds(before), limits.max_gap);
    }
  }
}

void normalise_quaternions(Trace& trace, const RowPlace& place) {
  const int first = trace.column("qx");
  if (first < 0) return;
  const std::size_t at[4] = {static_cast<std::size_t>(first), static_cast<std::size_t>(trace.column("qy")),
                             static_cast<std::size_t>(trace.column("qz")),
                             static_cast<std::size_t>(trace.column("qw"))};
  for (std::size_t row = 0; row < trace.rows(); ++row) {
    double* values = &trace.values[row * trace.columns.size()];
    double squared = 0;
    for (const std::size_t i : at) squared += values[i] * values[i];
    if (std::abs(squared - 1) <= 1e-14) continue;  // as unit as rounding lets it be: reading must not change it
    const double length = std::sqrt(squared);
    if (!(length >= 0.5 && length <= 2)) {
      fail(ErrorKind::input, "{}: the quaternion's length is {:.6g} where 1 is meant; repair or remove the row",
           place(row), length);
    }
    for (const std::size_t i : at) values[i] /= length;
  }
}

}  // namespace

int Trace::column(const std::string& name) const {
  const auto found = std::find(columns.begin(), columns.end(), name);
  return found == columns.end() ? -1 : static_cast<int>(found - columns.begin());
}

const std::vector<ColumnGroup>& column_groups(const std::string& name, const std::string& kind) {
  static const std::map<std::string, std::vector<ColumnGroup>> groups = {
      {"haptic",
       {{{"px", "py", "pz"}, true},
        {{"qx", "qy", "qz", "qw"}, true},
        {{"fx", "fy", "fz"}},
        {{"tx", "ty", "tz"}},
        {{"button"}}}},
      {"wii",
       {{{"battery"}, true},
        {{"gx", "gy", "gz"}, true},
        {{"x1", "y1", "s1", "x2", "y2", "s2", "x3", "y3", "s3", "x4", "y4", "s4"}, true},
        {{"px", "py", "pz", "qx", "qy", "qz", "qw"}}}},
      {"encoder", {{{"e0", "e1", "e2", "e3"}, true}, {{"vx", "vy", "omega"}}, {{"x", "y", "theta"}}}}};
  const auto found = groups.find(kind);
  if (found != groups.end()) return found->second;
  if (kind.empty()) fail(ErrorKind::input, "{}: does not say its kind; add '# kind: haptic' (or wii, encoder)", name);
  fail(ErrorKind::input, "{}: unknown kind '{}'; known are haptic, wii and encoder", name, kind);
}

std::vector<std::string> known_columns(const std::string& name, const std::string& kind) {
  std::vector<std::string> known;
  for (const ColumnGroup& group : column_groups(name, kind)) {
    known.insert(known.end(), group.columns.begin(), group.columns.end());
  }
  return known;
}

void check_trace(Trace& trace, const std::string& name, const std::string& expected_kind, const TraceLimits& limits,
                 const RowPlace& place) {
  check_columns(trace, name);
  if (!expected_kind.empty() && trace.kind != expected_kind) {
    fail(ErrorKind::input, "{}: is a {} trace where a {} trace is needed; name another", name, trace.kind,
         expected_kind);
  }
  if (trace.rows() == 0) fail(ErrorKind::input, "{}: holds no samples; record or convert it again", name);
  check_finite(trace, place);
  if (!limits.resort) {
    check_times(trace, limits, place);
    normalise_quaternions(trace, place);
  } else {
    const std::vector<std::size_t> origin = sort_by_time(trace);
    const RowPlace origin_place = [&](std::size_t row) { return place(origin[row]); };
    check_times(trace, limits, origin_place);
    normalise_quaternions(trace, origin_place);
  }
  if (trace.rate_hz == 0 && trace.rows() > 1) {
    trace.rate_hz = static_cast<double>(trace.rows() - 1) / (trace.at(trace.rows() - 1, 0) - trace.at(0, 0));
  }
  if (!std::isfinite(trace.rate_hz) || trace.rate_hz < 0) {
    fail(ErrorKind::input, "{}: rate_hz is {} but must be above 0; correct it", name, trace.rate_hz);
  }
}

}  // namespace verisim
