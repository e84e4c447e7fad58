#include <algorithm>

#include "engine/base/error.hpp"
#include "engine/record/file_replace.hpp"
#include "engine/record/hdf5_wrapper.hpp"
#include "engine/record/heap_check.hpp"
#include "engine/record/object_walk.hpp"
#include "engine/record/trace_form.hpp"

namespace verisim {
namespace {

using hdf5::check;
using hdf5::check_status;
using hdf5::Handle;

/// An HDF5 file in memory, opened for reading.
Handle open_image(const std::string& content) {
  check_text_heaps_of(content);
  const Handle access(check(H5Pcreate(H5P_FILE_ACCESS), "access"), H5Pclose);
  check_status(H5Pset_fclose_degree(access, H5F_CLOSE_STRONG), "access");
  check_status(H5Pset_fapl_core(access, std::size_t{1} << 16, false), "access");
  // HDF5 copies the image and writes nothing to it; its signature only lacks the const.
  check_status(H5Pset_file_image(access, const_cast<char*>(content.data()), content.size()), "image");
  return {check(H5Fopen("trace", H5F_ACC_RDONLY, access), "open"), H5Fclose};
}

double as_number(const Attribute& value) {
  return std::visit(
      [](const auto& v) {
        if constexpr (std::is_arithmetic_v<std::decay_t<decltype(v)>>) return static_cast<double>(v);
        return 0.0;
      },
      value);
}

std::string as_text(const Attribute& value) {
  return std::visit([](const auto& v) { return fmt::format("{}", v); }, value);
}

void read_keys(const std::string& name, hid_t file, Trace& trace) {
  for (const auto& [key, value] : hdf5::read_attributes(file)) {
    if (key == "kind") {
      trace.kind = as_text(value);
    } else if (key == "source") {
      trace.source = as_text(value);
    } else if (key == "rate_hz") {
      if (std::holds_alternative<std::string>(value))
        fail(ErrorKind::input, "{}: rate_hz is text; make it a number", name);
      trace.rate_hz = as_number(value);
    } else {
      trace.extra[key] = as_text(value);
    }
  }
}

std::vector<double> read_numbers(const std::string& name, hid_t file, const std::string& column) {
  const Handle dataset = hdf5::open_dataset(file, column);
  const Handle type(check(H5Dget_type(dataset), "type"), H5Tclose);
  const H5T_class_t kind = H5Tget_class(type);
  const hdf5::Shape shape = hdf5::checked_shape(dataset, H5Tget_size(type));
  if (shape.size() != 1 || (kind != H5T_FLOAT && kind != H5T_INTEGER)) {
    fail(ErrorKind::input, "{}: column '{}' is not a list of numbers; store it with shape [N]", name, column);
  }
  std::vector<double> values(shape[0]);
  if (!values.empty()) {
    check_status(H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), column.c_str());
  }
  return values;
}

bool is_dataset(hid_t file, const std::string& name) {
  const Handle object(H5Oopen(file, name.c_str(), H5P_DEFAULT), H5Oclose);
  return object >= 0 && H5Iget_type(object) == H5I_DATASET;
}

}  // namespace

Trace read_trace_hdf5(const std::string& name, const std::string& content) {
  const hdf5::Session session;
  try {
    const Handle file = open_image(content);
    check_objects(file, content.size(), SoftLinks::left_alone);
    Trace trace;
    read_keys(name, file, trace);
    std::vector<std::vector<double>> columns;
    for (const std::string& column : hdf5::children(file)) {
      if (!is_dataset(file, column)) continue;
      trace.columns.push_back(column);
      columns.push_back(read_numbers(name, file, column));
    }
    const auto t = std::find(trace.columns.begin(), trace.columns.end(), "t");
    if (t == trace.columns.end()) fail(ErrorKind::input, "{}: has no dataset 't' (s); is it a trace?", name);
    std::rotate(columns.begin(), columns.begin() + (t - trace.columns.begin()),
                columns.begin() + (t - trace.columns.begin()) + 1);
    std::rotate(trace.columns.begin(), t, t + 1);
    const std::size_t rows = columns.front().size();
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (columns[i].size() == rows) continue;
      fail(ErrorKind::input, "{}: column '{}' has {} values, 't' has {}; give every column as many", name,
           trace.columns[i], columns[i].size(), rows);
    }
    trace.values.reserve(rows * columns.size());
    for (std::size_t row = 0; row < rows; ++row) {
      for (const std::vector<double>& column : columns) trace.values.push_back(column[row]);
    }
    return trace;
  } catch (const hdf5::Failure& failure) {
    fail(ErrorKind::input, "{}: is damaged or no trace ({}); record or convert it again", name, failure.what());
  }
}

void write_trace_hdf5(const std::string& path, const Trace& trace) {
  const hdf5::Session session;
  try {
    Handle file = hdf5::create_file(path);
    hdf5::write_attribute(file, "kind", trace.kind);
    if (trace.rate_hz > 0) hdf5::write_attribute(file, "rate_hz", trace.rate_hz);
    hdf5::write_attribute(file, "source", trace.source);
    for (const auto& [key, value] : trace.extra) hdf5::write_attribute(file, key, value);
    std::vector<double> values(trace.rows());
    for (std::size_t i = 0; i < trace.columns.size(); ++i) {
      for (std::size_t row = 0; row < values.size(); ++row) values[row] = trace.at(row, i);
      hdf5::write_array(file, trace.columns[i], Dtype::f64, {values.size()}, values.data(), i == 0 ? "s" : "SI",
                        "Column of a " + trace.kind + " trace");
    }
    check_status(H5Fclose(file.release()), path.c_str());
  } catch (const hdf5::Failure& failure) {
    refuse_write(path, failure.what());
  }
}

}  // namespace verisim
