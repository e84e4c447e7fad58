#include "engine/script/wii_recording.hpp"

#include <array>
#include <cmath>
#include <cstdlib>

#include "engine/base/error.hpp"

namespace verisim {
namespace {

constexpr std::array kChannelColumns = {"battery", "gx", "gy", "gz", "x1", "y1", "s1", "x2",
                                        "y2",      "s2", "x3", "y3", "s3", "x4", "y4", "s4"};
constexpr std::array kPoseColumns = {"px", "py", "pz", "qx", "qy", "qz", "qw"};

/// The numbers of a header value, separated by blanks or commas.
std::vector<double> numbers(const std::string& file, const std::string& key, const std::string& text) {
  std::vector<double> values;
  const char* at = text.c_str();
  while (*at != '\0') {
    if (*at == ' ' || *at == ',' || *at == '\t') {
      ++at;
      continue;
    }
    char* end = nullptr;
    const double value = std::strtod(at, &end);
    if (end == at || !std::isfinite(value))
      fail(ErrorKind::input,
           "{}: '# {}: {}' has something at '{}' that is no number; write numbers with blanks between", file, key, text,
           at);
    values.push_back(value);
    at = end;
  }
  return values;
}

void require_count(const std::string& file, const std::string& key, std::size_t found, std::size_t wanted) {
  if (found != wanted)
    fail(ErrorKind::input, "{}: '# {}:' has {} numbers but must have {}; see the trace format", file, key, found,
         wanted);
}

wii::LedLayout leds_of(const std::string& file, const std::string& text) {
  wii::LedLayout leds;
  leds.count = 0;
  std::size_t begin = 0;
  while (begin <= text.size()) {
    const std::size_t end = std::min(text.find(';', begin), text.size());
    const std::vector<double> p = numbers(file, "leds", text.substr(begin, end - begin));
    begin = end + 1;
    if (p.empty() && begin > text.size()) break;  // a trailing semicolon
    require_count(file, "leds", p.size(), 3);
    if (leds.count == wii::kLedsMax)
      fail(ErrorKind::input, "{}: '# leds:' names more than {} LEDs, but a remote sees no more; leave some out", file,
           wii::kLedsMax);
    leds.p_H[static_cast<std::size_t>(leds.count++)] = {p[0], p[1], p[2]};
  }
  return leds;
}

Pose pose_of(const std::string& file, const std::vector<double>& p) {
  Pose pose{{p[0], p[1], p[2]}, {p[6], p[3], p[4], p[5]}};
  if (!(pose.rotation.norm() > 0.5 && pose.rotation.norm() < 2))
    fail(ErrorKind::input, "{}: '# remote_pose:' has a quaternion of length {}; write px py pz qx qy qz qw", file,
         pose.rotation.norm());
  pose.rotation.normalize();
  return pose;
}

}  // namespace

std::vector<std::string> wii_trace_columns() {
  std::vector<std::string> columns = {"t"};
  columns.insert(columns.end(), kChannelColumns.begin(), kChannelColumns.end());
  return columns;
}

wii::SetUp wii_set_up_of(const std::string& name, const std::map<std::string, std::string>& header) {
  wii::SetUp set_up;
  for (const auto& [key, text] : header) {
    if (key == "leds") set_up.leds = leds_of(name, text);
    if (key == "fov_deg") {
      const std::vector<double> fov = numbers(name, key, text);
      require_count(name, key, fov.size(), 2);
      set_up.fov = wii::FieldOfView{fov[0] * wii::kDegree, fov[1] * wii::kDegree};
    }
    if (key == "remote_pose") {
      const std::vector<double> p = numbers(name, key, text);
      require_count(name, key, p.size(), 7);
      set_up.X_WR = pose_of(name, p);
    }
  }
  return set_up;
}

std::map<std::string, std::string> wii_header_of(const wii::SetUp& set_up) {
  std::map<std::string, std::string> header;
  if (set_up.leds) {
    std::string& text = header["leds"];
    for (int i = 0; i < set_up.leds->count; ++i) {
      const Vector3d& p = set_up.leds->p_H[static_cast<std::size_t>(i)];
      text += fmt::format("{}{} {} {}", i == 0 ? "" : "; ", p.x(), p.y(), p.z());
    }
  }
  if (set_up.fov)
    header["fov_deg"] =
        fmt::format("{:.12g} {:.12g}", set_up.fov->horizontal / wii::kDegree, set_up.fov->vertical / wii::kDegree);
  if (set_up.X_WR) {
    const Vector3d& p = set_up.X_WR->position;
    const auto& q = set_up.X_WR->rotation.coeffs();
    header["remote_pose"] = fmt::format("{} {} {} {} {} {} {}", p.x(), p.y(), p.z(), q[0], q[1], q[2], q[3]);
  }
  return header;
}

wii::TrackerSettings wii_settings_of(const std::string& name, const Trace& trace) {
  const wii::SetUp set_up = wii_set_up_of(name, trace.extra);
  wii::TrackerSettings settings;
  settings.leds = set_up.leds.value_or(settings.leds);
  settings.fov = set_up.fov.value_or(settings.fov);
  return settings;
}

wii::Recording read_wii_recording(Inputs& inputs, const std::string& name, const TraceLimits& limits) {
  return wii_recording_of(name, parse_trace(name, inputs.read(name), "wii", limits));
}

std::vector<Pose> trace_poses(const Trace& trace) {
  std::array<std::size_t, kPoseColumns.size()> columns{};
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const int column = trace.column(kPoseColumns[i]);
    if (column < 0) return {};
    columns[i] = static_cast<std::size_t>(column);
  }
  std::vector<Pose> poses;
  for (std::size_t row = 0; row < trace.rows(); ++row) {
    const auto at = [&](std::size_t i) { return trace.at(row, columns[i]); };
    poses.push_back({{at(0), at(1), at(2)}, Quaterniond(at(6), at(3), at(4), at(5)).normalized()});
  }
  return poses;
}

wii::Recording wii_recording_of(const std::string& file, const Trace& trace) {
  wii::Recording recording;
  recording.settings = wii_settings_of(file, trace);
  const wii::SetUp set_up = wii_set_up_of(file, trace.extra);
  recording.X_WR = set_up.X_WR.value_or(recording.X_WR);
  recording.placed = set_up.X_WR.has_value();

  std::array<std::size_t, kChannelColumns.size()> channel{};
  for (std::size_t i = 0; i < channel.size(); ++i) {
    const int column = trace.column(kChannelColumns[i]);
    if (column < 0)
      fail(ErrorKind::input, "{}: column '{}' is missing; a wii trace has all 16", file, kChannelColumns[i]);
    channel[i] = static_cast<std::size_t>(column);
  }
  recording.truth = trace_poses(trace);
  for (std::size_t row = 0; row < trace.rows(); ++row) {
    recording.t.push_back(trace.at(row, 0));
    wii::Channels& channels = recording.channels.emplace_back();
    for (std::size_t i = 0; i < channel.size(); ++i) channels[i] = trace.at(row, channel[i]);
  }
  return recording;
}

}  // namespace verisim
