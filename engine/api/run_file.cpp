#include <verisim/run_file.hpp>

#include <cstring>

#include "engine/api/failures.hpp"
#include "engine/record/run_file.hpp"

namespace verisim {
namespace {

const char* name_of(Dtype type) {
  switch (type) {
    case Dtype::f64:
      return "f8";
    case Dtype::f32:
      return "f4";
    case Dtype::u64:
      return "u8";
    case Dtype::u32:
      return "u4";
    case Dtype::u16:
      return "u2";
    case Dtype::u8:
      return "u1";
    case Dtype::i32:
      return "i4";
    case Dtype::i8:
      return "i1";
  }
  return "";
}

Field field_of(const Column& column) {
  return {.path = column.path,
          .type = name_of(column.dtype),
          .width = column.width,
          .units = column.units,
          .meaning = column.description,
          .names = column.enum_names,
          .of_frames = column.due.empty() && column.rows_in_frame.empty()};
}

template <typename T>
double number_at(const std::vector<std::byte>& bytes, std::size_t index) {
  T value;
  std::memcpy(&value, bytes.data() + index * sizeof value, sizeof value);
  return static_cast<double>(value);
}

}  // namespace

double Values::at(std::size_t row, std::size_t component) const {
  if (row >= shape.front() || component >= field.width)
    throw Failure(static_cast<int>(ErrorKind::usage),
                  fmt::format("{}: has {} rows of {}; there is no value {}, {}", field.path, shape.front(), field.width,
                              row, component));
  const std::size_t i = row * field.width + component;
  if (field.type == "f8") return number_at<double>(bytes, i);
  if (field.type == "f4") return number_at<float>(bytes, i);
  if (field.type == "u8") return number_at<std::uint64_t>(bytes, i);
  if (field.type == "u4") return number_at<std::uint32_t>(bytes, i);
  if (field.type == "u2") return number_at<std::uint16_t>(bytes, i);
  if (field.type == "u1") return number_at<std::uint8_t>(bytes, i);
  if (field.type == "i4") return number_at<std::int32_t>(bytes, i);
  return number_at<std::int8_t>(bytes, i);
}

struct Run::Implementation {
  std::string path;
  RunFile file;

  explicit Implementation(const std::string& path_) : path(path_), file(path_) {}
  /// Error(usage) with the nearest path if there is none.
  [[nodiscard]] const Column& column(const std::string& wanted) const {
    std::vector<std::string> known;
    for (const auto* columns : {&file.schema().columns(), &file.schema().table()})
      for (const Column& column : *columns) {
        if (column.path == wanted) return column;
        known.push_back(column.path);
      }
    fail(ErrorKind::usage, "{}: {}", path, unknown_name("field", wanted, known));
  }
};

Run::Run(const std::string& path)
    : implementation_(with_failures([&] {
        check_line("path", path);
        return std::make_unique<Implementation>(path);
      })) {}
Run::~Run() = default;
Run::Run(Run&&) noexcept = default;
Run& Run::operator=(Run&&) noexcept = default;

const std::string& Run::path() const {
  return implementation_->path;
}
std::size_t Run::frames() const {
  return implementation_->file.rows();
}
const std::map<std::string, Run::Attribute>& Run::attributes() const {
  return implementation_->file.header().attributes;
}
const std::map<std::string, Run::Attribute>& Run::summary() const {
  return implementation_->file.summary();
}

std::vector<Field> Run::fields() const {
  std::vector<Field> fields;
  for (const auto* columns : {&implementation_->file.schema().columns(), &implementation_->file.schema().table()})
    for (const Column& column : *columns) fields.push_back(field_of(column));
  return fields;
}

Values Run::read(const std::string& path) const {
  return with_failures([&] {
    const Column& column = implementation_->column(path);
    Values values{field_of(column), {}, implementation_->file.column(column)};
    values.shape = {values.bytes.size() / column.bytes()};
    if (column.width > 1) values.shape.push_back(column.width);
    return values;
  });
}

std::vector<RunEvent> Run::events() const {
  return with_failures([&] {
    std::vector<RunEvent> events;
    for (const Event& event : implementation_->file.events()) events.push_back({event.time, event.kind, event.text});
    return events;
  });
}

std::vector<std::pair<std::string, std::string>> Run::pairs() const {
  return with_failures([&] { return implementation_->file.pairs(); });
}

}  // namespace verisim
