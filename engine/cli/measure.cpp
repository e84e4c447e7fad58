#include "engine/cli/measure.hpp"
#include "engine/base/json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "engine/base/error.hpp"
#include "engine/base/text.hpp"

namespace verisim::cli {
namespace {

const char* name_of(ruler::Source source) {
  switch (source) {
    case ruler::Source::solids:
      return "solids";
    case ruler::Source::triangles:
      return "triangles";
    case ruler::Source::surfaces:
      break;
  }
  return "surfaces";
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

/// One after the other. What was found holds for a later frame too, but for how far the bodies have moved since.
class Follower {
 public:
  Follower(const MeasuredBody& a, const MeasuredBody& b, bool by_surfaces)
      : a_(a.shape), b_(b.shape), by_surfaces_(by_surfaces) {}

  ruler::Overlap at(const Pose& X_WA, const Pose& X_WB) {
    const Pose X_BA = X_WB.inverse() * X_WA;
    if (is_known_) {
      const double move = ruler::largest_move(a_, X_BA_, X_BA);
      ruler::Overlap found = found_;
      found.depth = std::max(0.0, found_.depth - move);
      found.bound = found_.depth + found_.bound + move - found.depth;
      if (found.bound <= std::max(accuracy_.absolute, accuracy_.relative * found.depth)) return found;
    }
    is_known_ = true;
    X_BA_ = X_BA;
    found_ = by_surfaces_ ? ruler::overlap_of_surfaces(a_, X_WA, b_, X_WB, accuracy_)
                          : ruler::overlap(a_, X_WA, b_, X_WB, accuracy_);
    return found_;
  }

 private:
  const ruler::Shape& a_;
  const ruler::Shape& b_;
  bool by_surfaces_;
  ruler::Accuracy accuracy_;
  bool is_known_ = false;
  Pose X_BA_;
  ruler::Overlap found_;
};

MeasuredPair::Measured measured(const RunFile& file, const MeasuredBody& a, const MeasuredBody& b, bool by_surfaces,
                                const ProgressLine& line) {
  constexpr std::size_t kFramesPerLine = 20;
  const std::vector<Pose> X_WA = poses_of(file, a.name), X_WB = poses_of(file, b.name);
  if (X_WA.size() != file.rows() || X_WB.size() != file.rows())
    fail(ErrorKind::input, "'{}' or '{}' has not a pose in every frame", shown(a.name), shown(b.name));
  MeasuredPair::Measured result;
  Follower follower(a, b, by_surfaces);
  for (std::size_t frame = 0; frame < file.rows(); ++frame) {
    if (line.is_shown() && frame % kFramesPerLine == 0)
      line.say(fmt::format("{:.18} ~ {:.18}: frame {} of {}", shown(a.name), shown(b.name), frame, file.rows()));
    const ruler::Overlap found = follower.at(X_WA[frame], X_WB[frame]);
    result.overlap.push_back(found.depth);
    result.bound.push_back(found.bound);
    result.source = found.source;
  }
  return result;
}

std::size_t largest(const std::vector<double>& values) {
  return static_cast<std::size_t>(std::max_element(values.begin(), values.end()) - values.begin());
}

std::size_t largest_difference(const MeasuredPair& pair, const MeasuredPair::Measured& by) {
  std::size_t worst = 0;
  for (std::size_t i = 1; i < pair.recorded.size(); ++i)
    if (std::abs(pair.difference(by, i)) > std::abs(pair.difference(by, worst))) worst = i;
  return worst;
}
/// The frame of the line at the end: by what the pair was measured first.
std::size_t largest_difference(const MeasuredPair& pair) {
  return largest_difference(pair, pair.measured.front());
}

/// The pair that differs most, or nothing.
const MeasuredPair* worst_of(const std::vector<MeasuredPair>& pairs) {
  const MeasuredPair* worst = nullptr;
  const auto by = [](const MeasuredPair& pair) {
    return std::abs(pair.difference(pair.measured.front(), largest_difference(pair)));
  };
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

double MeasuredPair::difference(const Measured& by, std::size_t frame) const {
  VERISIM_ASSERT(frame < recorded.size());
  const double low = by.overlap[frame], high = by.overlap[frame] + by.bound[frame];
  return recorded[frame] < low ? low - recorded[frame] : std::min(0.0, high - recorded[frame]);
}

std::vector<MeasuredPair> measure_run(const RunFile& file, std::vector<MeasuredBody> bodies, const ProgressLine& line) {
  const auto frames = values_of<std::uint32_t>(file, file.schema().table(), "/state/links/frame");
  const auto numbers = values_of<std::uint32_t>(file, file.schema().table(), "/state/links/pair");
  const auto depths = values_of<double>(file, file.schema().table(), "/state/links/max_penetration");
  const auto body = [&](const std::string& name) -> MeasuredBody& {
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
    MeasuredBody& a = body(first);
    MeasuredBody& b = body(second);
    pair.why_not = ruler::why_not(a.shape, b.shape);
    if (pair.why_not.empty()) {
      pair.measured.push_back(measured(file, a, b, false, line));
      if (ruler::has_surfaces(a.shape, b.shape)) {
        a.shape.lift();
        b.shape.lift();
        pair.measured.push_back(measured(file, a, b, true, line));
      }
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
    const std::size_t recorded = largest(pair.recorded);
    for (const MeasuredPair::Measured& by : pair.measured) {
      const std::size_t deepest = largest(by.overlap), differ = largest_difference(pair, by);
      text += fmt::format("{:<28} {:>9} {:>8.2f} {:>9.2f} {:>6} {:>9.2f} {:>7} {:>9.2f} {:>7}\n", name,
                          name_of(by.source), by.overlap[deepest] * 1e6, by.bound[deepest] * 1e6, deepest,
                          pair.recorded[recorded] * 1e6, recorded, pair.difference(by, differ) * 1e6, differ);
    }
  }
  if (const MeasuredPair* worst = worst_of(pairs)) {
    const std::size_t frame = largest_difference(*worst);
    text += fmt::format("largest difference: {} ~ {}, frame {}: {:.2f} um recorded, {:.2f} um true\n",
                        shown(worst->first), shown(worst->second), frame, worst->recorded[frame] * 1e6,
                        worst->measured.front().overlap[frame] * 1e6);
  }
  return text;
}

Json json_of(const std::vector<MeasuredPair>& pairs) {
  Json json = {{"pairs", Json::array()}};
  for (const MeasuredPair& pair : pairs) {
    Json row = {{"first", pair.first}, {"second", pair.second}};
    if (!pair.why_not.empty()) {
      row["not_measured"] = pair.why_not;
    } else {
      const MeasuredPair::Measured& by = pair.measured.front();
      row["source"] = name_of(by.source);
      row["overlap_m"] = by.overlap;
      row["bound_m"] = by.bound;
      row["recorded_m"] = pair.recorded;
      if (pair.measured.size() > 1)
        row["surfaces"] = {{"overlap_m", pair.measured[1].overlap}, {"bound_m", pair.measured[1].bound}};
    }
    json["pairs"].push_back(std::move(row));
  }
  if (const MeasuredPair* worst = worst_of(pairs)) {
    const std::size_t frame = largest_difference(*worst);
    json["largest_difference"] = {{"first", worst->first},
                                  {"second", worst->second},
                                  {"frame", frame},
                                  {"recorded_m", worst->recorded[frame]},
                                  {"overlap_m", worst->measured.front().overlap[frame]},
                                  {"bound_m", worst->measured.front().bound[frame]},
                                  {"difference_m", worst->difference(worst->measured.front(), frame)}};
  }
  return json;
}

}  // namespace verisim::cli
