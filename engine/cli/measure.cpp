#include "engine/cli/measure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "engine/base/error.hpp"
#include "engine/base/text.hpp"

namespace verisim::cli {
namespace {

using nlohmann::ordered_json;

const char* name_of(ruler::Source source) {
  return source == ruler::Source::solids ? "solids" : "triangles";
}

template <typename T>
std::vector<T> values_of(const RunFile& file, const std::vector<Column>& columns, const std::string& path) {
  const auto found = std::find_if(columns.begin(), columns.end(), [&](const Column& c) { return c.path == path; });
  if (found == columns.end())
    fail(ErrorKind::input, "the run file has no {}; only files of format 2 and later can be measured", path);
  if (found->dtype != dtype_of<T>()) fail(ErrorKind::input, "{} holds another number type than expected", path);
  const std::vector<std::byte> bytes = file.column(*found);
  std::vector<T> values(bytes.size() / sizeof(T));
  if (!values.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
  return values;
}

std::vector<Pose> poses_of(const RunFile& file, const std::string& body) {
  const auto flat = values_of<double>(file, file.schema().columns(), "/state/body/" + body + "/pose");
  std::vector<Pose> poses(flat.size() / 7);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const double* row = flat.data() + 7 * i;
    poses[i].position = {row[0], row[1], row[2]};
    poses[i].rotation.coeffs() = Eigen::Vector4d(row[3], row[4], row[5], row[6]);
  }
  return poses;
}

void measure_pair(const RunFile& file, const MeasuredBody& a, const MeasuredBody& b, MeasuredPair& pair) {
  const std::vector<Pose> X_WA = poses_of(file, a.name), X_WB = poses_of(file, b.name);
  for (std::size_t frame = 0; frame < file.rows(); ++frame) {
    const ruler::Overlap found = ruler::overlap(a.shape, X_WA[frame], b.shape, X_WB[frame]);
    pair.overlap.push_back(found.depth);
    pair.bound.push_back(found.bound);
    pair.source = found.source;
  }
}

std::size_t largest(const std::vector<double>& values) {
  return static_cast<std::size_t>(std::max_element(values.begin(), values.end()) - values.begin());
}

std::size_t largest_difference(const MeasuredPair& pair) {
  std::size_t worst = 0;
  for (std::size_t i = 1; i < pair.recorded.size(); ++i)
    if (std::abs(pair.difference(i)) > std::abs(pair.difference(worst))) worst = i;
  return worst;
}

/// The pair that differs most, or nothing.
const MeasuredPair* worst_of(const std::vector<MeasuredPair>& pairs) {
  const MeasuredPair* worst = nullptr;
  const auto by = [](const MeasuredPair& pair) { return std::abs(pair.difference(largest_difference(pair))); };
  for (const MeasuredPair& pair : pairs)
    if (!pair.recorded.empty() && (worst == nullptr || by(pair) > by(*worst))) worst = &pair;
  return worst;
}

}  // namespace

std::vector<MeasuredBody> measured_bodies(const Scene& scene) {
  std::vector<MeasuredBody> bodies;
  for (const BodyDescription& body : scene.bodies) {
    std::vector<ruler::PartData> parts;
    for (const Part& part : body.parts) parts.push_back({part.name, part.solid, to_tables(part)});
    bodies.push_back({body.name, ruler::Shape(parts)});
  }
  return bodies;
}

double MeasuredPair::difference(std::size_t frame) const {
  VERISIM_ASSERT(frame < recorded.size());
  const double low = overlap[frame], high = overlap[frame] + bound[frame];
  return recorded[frame] < low ? low - recorded[frame] : std::min(0.0, high - recorded[frame]);
}

std::vector<MeasuredPair> measure_run(const RunFile& file, const std::vector<MeasuredBody>& bodies) {
  const auto frames = values_of<std::uint32_t>(file, file.schema().table(), "/state/links/frame");
  const auto numbers = values_of<std::uint32_t>(file, file.schema().table(), "/state/links/pair");
  const auto depths = values_of<double>(file, file.schema().table(), "/state/links/max_penetration");
  const auto body = [&](const std::string& name) -> const MeasuredBody& {
    const auto found =
        std::find_if(bodies.begin(), bodies.end(), [&](const MeasuredBody& b) { return b.name == name; });
    if (found == bodies.end())
      fail(ErrorKind::input, "/state/pairs names a body '{}' that the scenario does not have", shown(name));
    return *found;
  };
  std::vector<MeasuredPair> pairs;
  for (const auto& [first, second] : file.pairs()) {
    MeasuredPair pair;
    pair.first = first;
    pair.second = second;
    const MeasuredBody& a = body(first);
    const MeasuredBody& b = body(second);
    pair.why_not = ruler::why_not(a.shape, b.shape);
    if (pair.why_not.empty()) {
      measure_pair(file, a, b, pair);
      pair.recorded.assign(file.rows() > 0 ? file.rows() - 1 : 0, 0);
    }
    pairs.push_back(std::move(pair));
  }
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (numbers[i] >= pairs.size())
      fail(ErrorKind::input, "/state/links/pair[{}] is a row that /state/pairs does not have", i);
    std::vector<double>& recorded = pairs[numbers[i]].recorded;
    if (frames[i] > 0 && frames[i] <= recorded.size()) recorded[frames[i] - 1] = depths[i];
  }
  return pairs;
}

std::string table_of(const std::vector<MeasuredPair>& pairs) {
  if (pairs.empty()) return "no two bodies came near each other: nothing to measure\n";
  std::string text = fmt::format("{:<28} {:>9} {:>8} {:>8} {:>7} {:>9} {:>7} {:>9} {:>7}\n", "true overlap, um",
                                 "measured", "largest", "+ at most", "frame", "recorded", "frame", "differ", "frame");
  for (const MeasuredPair& pair : pairs) {
    const std::string name = shown(pair.first) + " ~ " + shown(pair.second);
    if (!pair.why_not.empty()) {
      text += fmt::format("{:<28} not measured: {}\n", name, shown(pair.why_not));
      continue;
    }
    if (pair.recorded.empty()) {
      text += fmt::format("{:<28} not measured: the run has fewer than two frames\n", name);
      continue;
    }
    const std::size_t deepest = largest(pair.overlap), recorded = largest(pair.recorded),
                      differ = largest_difference(pair);
    text += fmt::format("{:<28} {:>9} {:>8.2f} {:>9.2f} {:>6} {:>9.2f} {:>7} {:>9.2f} {:>7}\n", name,
                        name_of(pair.source), pair.overlap[deepest] * 1e6, pair.bound[deepest] * 1e6, deepest,
                        pair.recorded[recorded] * 1e6, recorded, pair.difference(differ) * 1e6, differ);
  }
  if (const MeasuredPair* worst = worst_of(pairs)) {
    const std::size_t frame = largest_difference(*worst);
    text +=
        fmt::format("largest difference: {} ~ {}, frame {}: {:.2f} um recorded, {:.2f} um true\n", shown(worst->first),
                    shown(worst->second), frame, worst->recorded[frame] * 1e6, worst->overlap[frame] * 1e6);
  }
  return text;
}

ordered_json json_of(const std::vector<MeasuredPair>& pairs) {
  ordered_json json = {{"pairs", ordered_json::array()}};
  for (const MeasuredPair& pair : pairs) {
    ordered_json row = {{"first", pair.first}, {"second", pair.second}};
    if (!pair.why_not.empty()) {
      row["not_measured"] = pair.why_not;
    } else {
      row["source"] = name_of(pair.source);
      row["overlap_m"] = pair.overlap;
      row["bound_m"] = pair.bound;
      row["recorded_m"] = pair.recorded;
    }
    json["pairs"].push_back(std::move(row));
  }
  if (const MeasuredPair* worst = worst_of(pairs)) {
    const std::size_t frame = largest_difference(*worst);
    json["largest_difference"] = {{"first", worst->first},
                                  {"second", worst->second},
                                  {"frame", frame},
                                  {"recorded_m", worst->recorded[frame]},
                                  {"overlap_m", worst->overlap[frame]},
                                  {"bound_m", worst->bound[frame]},
                                  {"difference_m", worst->difference(frame)}};
  }
  return json;
}

}  // namespace verisim::cli
