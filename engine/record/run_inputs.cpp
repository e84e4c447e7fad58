#include "engine/record/run_inputs.hpp"

#include <algorithm>

#include "engine/record/hdf5_wrapper.hpp"

namespace verisim {
namespace {

using hdf5::Handle;
using hdf5::Shape;

void write_file(hid_t group, std::size_t number, const InputFile& file) {
  const Handle dataset = hdf5::write_array(group, std::to_string(number), Dtype::u8, {file.content.size()},
                                           file.content.data(), "1", "Bytes of a file that the run read, as it was");
  hdf5::write_attribute(dataset, "name", file.name);
  hdf5::write_attribute(dataset, "sha256", file.sha256);
  hdf5::write_attribute(dataset, "embedded", std::int64_t{file.embedded});
}

void write_model(hid_t models, std::size_t number, const StoredModel& model) {
  const Handle group = hdf5::create_group(models, std::to_string(number));
  hdf5::write_attribute(group, "key", model.key);
  for (std::size_t j = 0; j < model.parts.size(); ++j) {
    const auto& [name, tables] = model.parts[j];
    const Handle part = hdf5::create_group(group, std::to_string(j));
    hdf5::write_attribute(part, "name", name);
    for (std::size_t k = 0; k < tables.size(); ++k) {
      const NamedArray& a = tables[k];
      const Handle dataset = hdf5::write_array(part, a.name, a.dtype, Shape(a.shape.begin(), a.shape.end()),
                                               a.bytes.data(), a.units, a.description);
      hdf5::write_attribute(dataset, "order", static_cast<std::int64_t>(k));
    }
  }
}

std::vector<std::byte> read_bytes(hid_t dataset, Dtype dtype, const Shape& shape) {
  std::size_t count = 1;
  for (const hsize_t n : shape) count *= n;
  std::vector<std::byte> bytes(count * size_of(dtype));
  if (!bytes.empty()) {
    hdf5::check_status(H5Dread(dataset, hdf5::memory_type(dtype), H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()),
                       "inputs");
  }
  return bytes;
}

Dtype stored_dtype(hid_t dataset) {
  return hdf5::dtype_of_stored(Handle(hdf5::check(H5Dget_type(dataset), "type"), H5Tclose));
}

// Tables below one part, with the place that they had; a table's name may lead through groups.
void collect_tables(hid_t group, const std::string& prefix, std::vector<std::pair<std::int64_t, NamedArray>>& found) {
  for (const std::string& name : hdf5::children(group)) {
    const Handle object(hdf5::check(H5Oopen(group, name.c_str(), H5P_DEFAULT), name.c_str()), H5Oclose);
    if (H5Iget_type(object) == H5I_GROUP) {
      collect_tables(object, prefix + name + "/", found);
      continue;
    }
    NamedArray a;
    a.name = prefix + name;
    a.dtype = stored_dtype(object);
    const Shape shape = hdf5::checked_shape(object, size_of(a.dtype));
    a.shape.assign(shape.begin(), shape.end());
    a.bytes = read_bytes(object, a.dtype, shape);
    a.units = hdf5::read_string(object, "units");
    a.description = hdf5::read_string(object, "description");
    found.emplace_back(hdf5::read_integer(object, "order"), std::move(a));
  }
}

std::vector<NamedArray> read_tables(hid_t part) {
  std::vector<std::pair<std::int64_t, NamedArray>> found;
  collect_tables(part, "", found);
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<NamedArray> tables;
  for (auto& [order, table] : found) tables.push_back(std::move(table));
  return tables;
}

}  // namespace

void write_inputs(hid_t file, const std::vector<InputFile>& files, const std::vector<StoredModel>& models) {
  const Handle file_group = hdf5::create_group(file, "/inputs/files");
  for (std::size_t i = 0; i < files.size(); ++i) write_file(file_group, i, files[i]);
  const Handle model_group = hdf5::create_group(file, "/inputs/models");
  for (std::size_t i = 0; i < models.size(); ++i) write_model(model_group, i, models[i]);
}

std::vector<InputFile> read_input_files(hid_t file) {
  const Handle group = hdf5::open_group(file, "/inputs/files");
  const std::size_t count = hdf5::children(group).size();
  std::vector<InputFile> files;
  for (std::size_t i = 0; i < count; ++i) {
    const Handle dataset = hdf5::open_dataset(group, std::to_string(i));
    const std::vector<std::byte> bytes = read_bytes(dataset, Dtype::u8, hdf5::checked_shape(dataset, 1));
    files.push_back({.name = hdf5::read_string(dataset, "name"),
                     .sha256 = hdf5::read_string(dataset, "sha256"),
                     .content = std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()),
                     .embedded = hdf5::read_integer(dataset, "embedded") != 0});
  }
  return files;
}

std::vector<StoredModel> read_input_models(hid_t file) {
  const Handle group = hdf5::open_group(file, "/inputs/models");
  const std::size_t count = hdf5::children(group).size();
  std::vector<StoredModel> models;
  for (std::size_t i = 0; i < count; ++i) {
    const Handle model = hdf5::open_group(group, std::to_string(i));
    StoredModel stored{.key = hdf5::read_string(model, "key"), .parts = {}};
    const std::size_t parts = hdf5::children(model).size();
    for (std::size_t j = 0; j < parts; ++j) {
      const Handle part = hdf5::open_group(model, std::to_string(j));
      stored.parts.emplace_back(hdf5::read_string(part, "name"), read_tables(part));
    }
    models.push_back(std::move(stored));
  }
  return models;
}

}  // namespace verisim
