#include "engine/record/trace.hpp"

#include "engine/base/error.hpp"
#include "engine/record/file_replace.hpp"
#include "engine/record/trace_form.hpp"

namespace verisim {

Trace parse_trace(const std::string& name, const std::string& content, const std::string& expected_kind,
                  const TraceLimits& limits) {
  if (content.empty()) fail(ErrorKind::input, "{}: is empty; record or convert it again", name);
  RowPlace place = [&](std::size_t row) { return fmt::format("{}: row {}", name, row); };
  Trace trace = content.starts_with("\x89HDF") ? read_trace_hdf5(name, content) : read_trace_csv(name, content, place);
  check_trace(trace, name, expected_kind, limits, place);
  return trace;
}

void write_trace(const std::string& path, const Trace& trace) {
  VERISIM_ASSERT(!trace.columns.empty());
  VERISIM_ASSERT(trace.values.size() % trace.columns.size() == 0);
  Replacement file(path, ".part");
  if (path.ends_with(".csv")) {
    file.write(trace_as_csv(trace));
  } else if (path.ends_with(".h5") || path.ends_with(".hdf5")) {
    write_trace_hdf5(file.path(), trace);
  } else {
    fail(ErrorKind::usage, "{}: the format of a trace is told by its name; let it end in .csv or .h5", path);
  }
  file.commit();
}

}  // namespace verisim
