#include "engine/cli/wii_poses.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>

#include "engine/base/csv.hpp"
#include "engine/base/error.hpp"
#include "engine/base/text.hpp"
#include "engine/cli/wii_commands.hpp"
#include "engine/simulation/inputs.hpp"

namespace verisim::cli {
namespace {

constexpr std::array kPose = {"t", "px", "py", "pz", "qx", "qy", "qz", "qw"};
constexpr std::array kVariances = {"cpx", "cpy", "cpz", "crx", "cry", "crz"};

std::string full_name(int i, int j) {
  return fmt::format("c{}{}", i, j);
}

double number_at(const std::string& where, const std::string& what, std::string text) {
  text.erase(0, text.find_first_not_of(" \t"));
  text.erase(text.find_last_not_of(" \t\r") + 1);
  double value = 0;
  const char* const begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const auto [end, failure] = std::from_chars(begin, text.data() + text.size(), value);
  if (text.empty() || failure != std::errc() || end != text.data() + text.size())
    fail(ErrorKind::input, "{}: {} is '{}', not a number; correct the row", where, what, shown(text));
  return value;
}

/// A row by the names of its columns.
class ReportRow {
 public:
  ReportRow(std::string where, const std::map<std::string, std::size_t>& columns,
            const std::vector<std::string>& fields)
      : where_(std::move(where)), columns_(columns), fields_(fields) {}

  [[nodiscard]] bool has(const std::string& name) const { return columns_.contains(name); }
  [[nodiscard]] double at(const std::string& name) const {
    const std::size_t i = columns_.at(name);
    if (i >= fields_.size())
      fail(ErrorKind::input, "{}: has {} fields, but '{}' is number {}; complete the row", where_, fields_.size(), name,
           i + 1);
    return number_at(where_, name, fields_[i]);
  }
  [[nodiscard]] wii::Report report() const {
    wii::Report r;
    r.t = at("t");
    if (!std::isfinite(r.t)) fail(ErrorKind::input, "{}: t is {}, not a finite time; correct the row", where_, r.t);
    r.valid = !has("valid") || at("valid") != 0;
    r.reacquired = has("reacquired") && at("reacquired") != 0;
    r.news = true;
    r.covariance.setConstant(std::numeric_limits<double>::quiet_NaN());
    if (!r.valid) return r;
    r.pose = {{at("px"), at("py"), at("pz")}, {at("qw"), at("qx"), at("qy"), at("qz")}};
    const double length = r.pose.rotation.norm();
    if (!r.pose.position.allFinite() || !(length > 0.5 && length < 2))
      fail(ErrorKind::input,
           "{}: the pose is not finite or its quaternion has the length {}; say valid = 0 where there is none", where_,
           length);
    if (std::abs(length - 1) > 1e-14) r.pose.rotation.normalize();
    read_covariance(r.covariance);
    return r;
  }

 private:
  void read_covariance(Matrix6d& c) const {
    if (has("c00")) {
      for (int i = 0; i < 6; ++i)
        for (int j = 0; j < 6; ++j) c(i, j) = at(full_name(i, j));
    } else if (has("cpx")) {
      c.setZero();
      for (int i = 0; i < 6; ++i) c(i, i) = at(kVariances[static_cast<std::size_t>(i)]);
    }
  }

  std::string where_;
  const std::map<std::string, std::size_t>& columns_;
  const std::vector<std::string>& fields_;
};

std::vector<std::string> split(const std::string& text, const char* separators) {
  std::vector<std::string> parts;
  for (std::size_t at = text.find_first_not_of(separators); at != std::string::npos;) {
    const std::size_t end = text.find_first_of(separators, at);
    parts.push_back(text.substr(at, end - at));
    at = text.find_first_not_of(separators, end);
  }
  return parts;
}

/// "t=time px=x": ours to the file's.
std::map<std::string, std::string> renamed(const std::string& columns) {
  std::map<std::string, std::string> names;
  for (const std::string& pair : split(columns, " ,")) {
    const std::size_t at = pair.find('=');
    if (at == std::string::npos || at == 0 || at + 1 == pair.size())
      fail(ErrorKind::usage, "--columns: '{}' is not OURS=THEIRS; write t=time px=x …", pair);
    names[pair.substr(0, at)] = pair.substr(at + 1);
  }
  return names;
}

/// Where each of our columns is. Error(input) for one that must be there.
std::map<std::string, std::size_t> find_columns(const std::string& file, const std::vector<std::string>& header,
                                                const std::string& columns) {
  std::map<std::string, std::size_t> there;
  for (std::size_t i = 0; i < header.size(); ++i) there.emplace(header[i], i);
  for (const auto& [ours, theirs] : renamed(columns)) {
    const auto found = std::find(header.begin(), header.end(), theirs);
    if (found == header.end()) {
      const std::string near = nearest_name(theirs, header);
      fail(ErrorKind::usage, "--columns {}={}: {} has no column of that name{}", ours, theirs, file,
           near.empty() ? "" : "; did you mean '" + near + "'?");
    }
    there[ours] = static_cast<std::size_t>(found - header.begin());
  }
  for (const char* name : kPose)
    if (!there.contains(name))
      fail(ErrorKind::input,
           "{}: no column '{}'; a file of poses is wii track's, TUM's (t x y z qx qy qz qw), or a CSV whose columns "
           "--columns names: t=… px=… py=… pz=… qx=… qy=… qz=… qw=…",
           file, name);
  return there;
}

std::vector<wii::Report> read_tum(const std::string& file, const std::string& content) {
  static const std::map<std::string, std::size_t> kColumns = {{"t", 0},  {"px", 1}, {"py", 2}, {"pz", 3},
                                                              {"qx", 4}, {"qy", 5}, {"qz", 6}, {"qw", 7}};
  std::vector<wii::Report> reports;
  std::size_t line_number = 0;
  for (std::size_t begin = 0; begin < content.size();) {
    const std::size_t end = std::min(content.find('\n', begin), content.size());
    const std::string line = content.substr(begin, end - begin);
    begin = end + 1;
    ++line_number;
    const std::vector<std::string> fields = split(line, " \t\r");
    if (fields.empty() || fields.front().starts_with('#')) continue;
    const std::string where = fmt::format("{}:{}", file, line_number);
    if (fields.size() != kColumns.size())
      fail(ErrorKind::input, "{}: has {} numbers, but TUM's form has 8: t x y z qx qy qz qw", where, fields.size());
    reports.push_back(ReportRow(where, kColumns, fields).report());
  }
  return reports;
}

/// The first line with something on it that is no comment.
std::string first_line(const std::string& content) {
  for (std::size_t begin = 0; begin < content.size();) {
    const std::size_t end = std::min(content.find('\n', begin), content.size());
    std::string line = content.substr(begin, end - begin);
    begin = end + 1;
    const std::size_t text = line.find_first_not_of(" \t\r");
    if (text != std::string::npos && line[text] != '#') return line;
  }
  return "";
}

/// Without lines that begin with '#', line numbers kept.
std::string without_comments(const std::string& content) {
  std::string text;
  for (std::size_t begin = 0; begin < content.size();) {
    const std::size_t end = std::min(content.find('\n', begin), content.size());
    if (content[begin] != '#') text.append(content, begin, end - begin);
    text += '\n';
    begin = end + 1;
  }
  return text;
}

}  // namespace

std::vector<wii::Report> read_poses(const std::string& file, const std::string& columns,
                                    std::vector<FileIdentity>& opened) {
  Inputs inputs = Inputs::live(".", {file});
  const std::string& content = inputs.read(file);
  opened.insert(opened.end(), inputs.opened().begin(), inputs.opened().end());
  if (columns.empty() && first_line(content).find(',') == std::string::npos) {
    std::vector<wii::Report> reports = read_tum(file, content);
    if (reports.empty()) fail(ErrorKind::input, "{}: holds no pose", file);
    return reports;
  }
  const std::vector<CsvRow> rows = read_csv(file, without_comments(content));
  if (rows.size() < 2) fail(ErrorKind::input, "{}: holds no pose below its column names", file);
  const std::map<std::string, std::size_t> where = find_columns(file, rows.front().fields, columns);
  std::vector<wii::Report> reports;
  for (std::size_t i = 1; i < rows.size(); ++i)
    reports.push_back(ReportRow(fmt::format("{}:{}", file, rows[i].line), where, rows[i].fields).report());
  return reports;
}

wii::Report parse_pose_line(const std::string& where, const std::string& line) {
  static const std::map<std::string, std::size_t> kColumns = [] {
    std::map<std::string, std::size_t> columns;
    const std::vector<std::string> names = split(kPoseHeader, ",\n");
    for (std::size_t i = 0; i < 9; ++i) columns[names[i]] = i;  // t, valid, px … qw; what follows is not asked for
    return columns;
  }();
  std::vector<std::string> fields;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    fields.push_back(line.substr(begin, end - begin));
    begin = end + 1;
  }
  return ReportRow(where, kColumns, fields).report();
}

}  // namespace verisim::cli
