// README's table "What does accuracy cost?": the trial of scenarios/peg_in_hole.lua at three clearances under four
// answers to contact, for hands that misjudge the hole each in another way. Markdown on stdout, progress on stderr.
//
//   accuracy_table [--seeds N] [--rounds N] [--duration SECONDS] [--every FRAMES] [--clearance METRES] [--answer NAME]
//
// The hand of seed s, 1 to N: how far beside the hole it aims is drawn evenly over a disc of 3 mm, its tilt evenly from
// 0 to 1 degree, towards where it aims or away from it, its tremor by the scenario's own stream. Every row has the
// same hands. A figure is the median over the seeds, with the least and the greatest behind it. Recorded: the deepest
// penetration that the run tells of. True: the largest overlap that engine/ruler finds from the poses, every
// so many frames. Each run is repeated, bit for bit, and each frame keeps its least time: a neighbour on the machine
// can only add.
#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bench/played_scenario.hpp"
#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"
#include "engine/base/quantile.hpp"
#include "engine/base/random.hpp"
#include "engine/ruler/ruler.hpp"
#include "tests/support/paths.hpp"

namespace verisim::bench {
namespace {

constexpr double kBeside = 0.003, kTilt = pinned::kFullTurn / 360;  // m, rad: the most that a hand misjudges

struct Answer {
  const char *name, *hybrid, *contact;
};
constexpr std::array kAnswers = {Answer{"off", "off", "voxmap"}, Answer{"off, `contact=fcl`", "off", "fcl"},
                                 Answer{"restore", "restore", "voxmap"}, Answer{"exact", "exact", "voxmap"}};

struct Options {
  std::uint64_t seeds = 10, rounds = 2, every = 10;
  double duration = 10;
  std::vector<double> clearances = {0.005, 0.001, 0.0001};  // m
  std::string answer;                                       // empty: all
};

/// Of one run.
struct Figures {
  double passes = 0, recorded = 0, overlap = 0, bound = 0;  ///< m
  std::vector<double> frame_us;                             ///< of frames with contact
};

ScenarioOptions options_of(const Options& options, const Answer& answer, double clearance, std::uint64_t seed) {
  const RandomStream hand(seed, "accuracy table");
  const double side = hand.uniform(2) < 0.5 ? -1 : 1;
  const double beside = side * kBeside * std::sqrt(hand.uniform(0)), tilt = kTilt * hand.uniform(1);
  ScenarioOptions all;
  all.path = paths::in_sources("scenarios/peg_in_hole.lua");
  all.sets = {{"clearance", fmt::format("{:.17g}", clearance)},
              {"hybrid", answer.hybrid},
              {"contact", answer.contact},
              {"approach", fmt::format("{:.17g}", beside)},
              {"tilt", fmt::format("{:.17g}", tilt)}};
  all.seed = seed;
  all.duration = options.duration;
  return all;
}

ruler::Shape shape_of(const BodyDescription& body) {
  std::vector<ruler::PartData> parts;
  for (const Part& part : body.parts) parts.push_back({part.name, part.solid, to_tables(part)});
  return ruler::Shape(parts);
}

/// The largest overlap of the two bodies over the poses that it is shown.
class TrueOverlap {
 public:
  explicit TrueOverlap(const Scene& scene) : block_(shape_of(scene.bodies.at(0))), pin_(shape_of(scene.bodies.at(1))) {}
  void look(const Simulation& simulation, Figures& figures) {
    const Pose X_WA = simulation.body_pose(0), X_WB = simulation.body_pose(1), X_AB = X_WA.inverse() * X_WB;
    // What was found last says that it cannot be deeper now than it has been: the usual case once it has been deep.
    if (is_known_ && last_.depth + last_.bound + ruler::largest_move(pin_, X_AB_, X_AB) <= figures.overlap) return;
    is_known_ = true;
    X_AB_ = X_AB;
    last_ = ruler::overlap(pin_, X_WB, block_, X_WA, {.absolute = 5e-7, .relative = 0.02, .pieces_max = 1500});
    figures.overlap = std::max(figures.overlap, last_.depth);
    figures.bound = std::max(figures.bound, last_.depth + last_.bound);
  }

 private:
  ruler::Shape block_, pin_;
  bool is_known_ = false;
  Pose X_AB_;
  ruler::Overlap last_;
};

/// Runs the scenario once.
void play_once(const ScenarioOptions& all, std::uint64_t every, std::vector<double>& frame_us, Figures& figures,
               bool measures) {
  std::optional<TrueOverlap> overlap;
  play(
      all, frame_us, [&](const Scene& scene) { overlap.emplace(scene); },
      [&](const Simulation& simulation) {
        if (measures && simulation.frame() % every == 0) overlap->look(simulation, figures);
      },
      [&](const Simulation& simulation, const Scenario& scenario) {
        for (const Measure& measure : scenario.measures())
          if (measure.name == "passes") figures.passes = measure.value;
        figures.recorded = simulation.totals().penetration_max;
      });
}

Figures run(const Options& options, const Answer& answer, double clearance, std::uint64_t seed) {
  const ScenarioOptions all = options_of(options, answer, clearance, seed);
  Figures figures;
  for (std::uint64_t round = 0; round < options.rounds; ++round)
    play_once(all, options.every, figures.frame_us, figures, /*measures=*/round == 0);
  std::erase(figures.frame_us, 0);
  return figures;
}

/// "median (least to greatest)" of the seeds' values.
std::string spread(std::vector<double> values, double unit, int digits) {
  if (values.empty()) return "";
  for (double& value : values) value /= unit;
  const double least = quantile(values, 0), middle = quantile(values, 0.5), most = quantile(values, 1);
  return fmt::format("{1:.{0}f} ({2:.{0}f} to {3:.{0}f})", digits, middle, least, most);
}

std::string row(const Options& options, const Answer& answer, double clearance) {
  std::vector<double> passes, recorded, overlap, median, late;
  std::uint64_t through = 0;
  double bound = 0;
  for (std::uint64_t seed = 1; seed <= options.seeds; ++seed) {
    std::fprintf(stderr, "%g mm, %s: hand %d of %d\n", 1e3 * clearance, answer.name, static_cast<int>(seed),
                 static_cast<int>(options.seeds));
    Figures figures = run(options, answer, clearance, seed);
    passes.push_back(figures.passes);
    through += figures.passes > 0 ? 1 : 0;
    recorded.push_back(figures.recorded);
    overlap.push_back(figures.overlap);
    bound = std::max(bound, figures.bound);
    if (figures.frame_us.empty()) continue;
    median.push_back(quantile(figures.frame_us, 0.5));
    late.push_back(quantile(figures.frame_us, 0.99));
  }
  std::fprintf(stderr, "  no overlap was above %.3g mm\n", 1e3 * bound);
  const double share = 100.0 * static_cast<double>(through) / static_cast<double>(options.seeds);
  return fmt::format("| {:g} mm | {} | {:.0f} % | {} | {} | {} | {} | {} |\n", 1e3 * clearance, answer.name, share,
                     spread(passes, 1, 0), median.empty() ? "no contact" : spread(recorded, 1e-3, 4),
                     spread(overlap, 1e-3, 4), spread(median, 1, 0), spread(late, 1, 0));
}

Options options_from(int argc, char** argv) {
  Options options;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string_view name = argv[i];
    const char* value = argv[i + 1];
    if (name == "--seeds") {
      options.seeds = std::strtoull(value, nullptr, 10);
    } else if (name == "--rounds") {
      options.rounds = std::strtoull(value, nullptr, 10);
    } else if (name == "--every") {
      options.every = std::strtoull(value, nullptr, 10);
    } else if (name == "--duration") {
      options.duration = std::strtod(value, nullptr);
    } else if (name == "--clearance") {
      options.clearances = {std::strtod(value, nullptr)};
    } else if (name == "--answer") {
      options.answer = value;
    } else {
      fail(ErrorKind::usage, "no option {}; the head of bench/accuracy_table.cpp lists them", name);
    }
  }
  if (argc % 2 == 0) fail(ErrorKind::usage, "{} has no value", argv[argc - 1]);
  if (options.seeds == 0 || options.rounds == 0 || options.every == 0)
    fail(ErrorKind::usage, "--seeds, --rounds and --every are at least 1");
  return options;
}

void print_table(const Options& options) {
  std::fputs(
      "| clearance | `hybrid` | went through | passes | recorded, mm | true overlap, mm | frame with contact, us | "
      "99 %, us |\n|---:|---|---:|---:|---:|---:|---:|---:|\n",
      stdout);
  for (const double clearance : options.clearances) {
    for (const Answer& answer : kAnswers) {
      if (!options.answer.empty() && options.answer != answer.name) continue;
      std::fputs(row(options, answer, clearance).c_str(), stdout);
      std::fflush(stdout);
    }
  }
}

}  // namespace
}  // namespace verisim::bench

int main(int argc, char** argv) {
  try {
    verisim::bench::print_table(verisim::bench::options_from(argc, argv));
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 2;
  }
}
