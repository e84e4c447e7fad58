// R8: what the firmware has to bear at the motors' recommended top speed (section 5.3.2: 7000 RPM x 12 x 4 x 4 = 22,400
// interrupts a second "handled"), on the simulated ATmega328P, and the robot's top speed (section 5.3.1: 0.57 m/s).
#include <array>
#include <cmath>
#include <vector>

#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"
#include "engine/base/random.hpp"
#include "engine/record/output_place.hpp"
#include "engine/reproduce/reproductions.hpp"
#include "engine/robot/boards.hpp"
#include "engine/robot/robot.hpp"

namespace verisim::reproduce {
namespace {

constexpr double kRate = 22'400;  // edges a second, all four wheels
constexpr const char* kBoard = "ATmega328P at 16 MHz under simavr";

/// Edges of four wheels that turn at one speed, each edge misplaced by up to half of its period at random: a
/// steady phase would hide losses.
class JitteredEdges {
 public:
  explicit JitteredEdges(double edges_per_second) : period_(4 * firmware::kClockHz / edges_per_second) {
    for (std::size_t wheel = 0; wheel < 4; ++wheel) next_[wheel] = period_ * (0.25 * static_cast<double>(wheel) + 0.1);
  }
  const std::vector<firmware::EncoderEdge>& millisecond() {
    edges_.clear();
    static constexpr std::array<std::uint8_t, 4> kGray{0, 1, 3, 2};
    for (std::size_t wheel = 0; wheel < 4; ++wheel)
      for (double at = jittered(wheel); at < firmware::kCyclesPerMs; at = jittered(wheel)) {
        edges_.push_back({static_cast<std::uint32_t>(std::max(at, 0.0)), static_cast<std::uint8_t>(wheel),
                          kGray[++count_[wheel] & 3]});
        next_[wheel] += period_;
      }
    for (double& next : next_) next -= firmware::kCyclesPerMs;
    std::stable_sort(edges_.begin(), edges_.end(), [](const auto& a, const auto& b) { return a.cycle < b.cycle; });
    return edges_;
  }

 private:
  [[nodiscard]] double jittered(std::size_t wheel) const {
    return next_[wheel] + 0.5 * period_ * random_.uniform(4 * std::uint64_t{count_[wheel]} + wheel);
  }

  double period_;  ///< of one wheel's edges, cycles
  std::array<double, 4> next_{};
  std::array<std::uint32_t, 4> count_{};
  std::vector<firmware::EncoderEdge> edges_;
  RandomStream random_{1, "encoder edges"};
};

firmware::BoardLoad load_at(double edges_per_second, int ms) {
  const std::unique_ptr<firmware::Board> board = robot::make_board("avr");
  JitteredEdges edges(edges_per_second);
  for (int i = 0; i < 100; ++i) board->advance({}, {});  // it boots
  for (int i = 0; i < ms; ++i) board->advance(edges.millisecond(), {});
  for (int i = 0; i < 10; ++i) board->advance({}, {});  // the last ones are counted
  return board->load();
}

double percent(std::uint64_t part, std::uint64_t whole) {
  return 100 * static_cast<double>(part) / static_cast<double>(whole);
}

/// The first of these rates at which an edge is lost.
double first_loss(int ms, std::string& csv) {
  for (double rate = 20'000; rate <= 200'000; rate += 5'000) {
    const firmware::BoardLoad load = load_at(rate, ms);
    csv += fmt::format("{},{},{},{}\n", rate, load.edges_seen, load.edges_lost, percent(load.busy_cycles, load.cycles));
    if (load.edges_lost > 0) return rate;
  }
  return NAN;
}

std::vector<Row> board_rows(const Workshop& workshop) {
  const std::string file = workshop.file("r8_firmware.csv");
  std::string csv = "edges_per_second,edges,lost,cycles_percent\n";
  const firmware::BoardLoad load = load_at(kRate, workshop.quick ? 1000 : 10'000);
  csv += fmt::format("{},{},{},{}\n", kRate, load.edges_seen, load.edges_lost, percent(load.busy_cycles, load.cycles));
  const double lost_at = first_loss(workshop.quick ? 200 : 1000, csv);
  write_text(file, csv, workshop.force);
  const double handled = kRate * (1 - static_cast<double>(load.edges_lost) / static_cast<double>(load.edges_seen));
  std::vector<Row> rows;
  rows.push_back({"R8",
                  "encoder interrupts handled at 7000 RPM",
                  "1/s",
                  kRate,
                  handled,
                  {},
                  fmt::format("{}, jittered edges; {} of {} lost, {:.1f} % of the cycles used, {:.1f} % in interrupts",
                              kBoard, load.edges_lost, load.edges_seen, percent(load.busy_cycles, load.cycles),
                              percent(load.interrupt_cycles, load.cycles)),
                  {file}});
  rows.push_back({"R8",
                  "first rate at which an edge is lost",
                  "1/s",
                  std::string("not reported"),
                  lost_at,
                  {},
                  "in steps of 5,000 a second, jittered, a second of each",
                  {file}});
  return rows;
}

/// Greatest speed straight ahead, after 3 s of all that the server asks for.
double top_speed(double volts) {
  robot::RobotSettings settings;
  settings.plant.supply.voltage = volts;
  robot::Robot base(settings, robot::make_board("host"));
  for (int ms = 1; ms <= 3000; ++ms) {
    base.follow(1, 0);
    base.advance(ms * robot::kMillisecond);
  }
  return base.plant().state().twist.vx;
}

}  // namespace

std::vector<Row> r8_firmware(const Workshop& workshop) {
  const double at_16 = top_speed(16), at_12 = top_speed(12);
  const std::string file = workshop.file("r8_top_speed.csv");
  write_text(file, fmt::format("supply_V,speed_m_s\n16,{}\n12,{}\n", at_16, at_12), workshop.force);
  std::vector<Row> rows;
  try {
    rows = board_rows(workshop);
  } catch (const Error& error) {  // without verisim-avr
    Row row{"R8", "encoder interrupts handled at 7000 RPM", "1/s", kRate, std::string("not measured"), {}, {}, {file}};
    row.why = error.what();
    rows.push_back(row);
  }
  Row row{"R8", "top speed of the robot", "m/s", 0.57, at_16, {}, {}, {file}};
  row.why = "the firmware holds the motors at 7000 RPM, by the wheels 0.5727 m/s; 16 V, so that they reach it";
  rows.push_back(row);
  row.what += " at 12 V";
  row.published = std::string("not reported");
  row.here = at_12;
  row.why = "12 V less the L298's drop and the battery's, against bearings, gears and rollers, do not reach 7000 RPM";
  rows.push_back(row);
  return rows;
}

}  // namespace verisim::reproduce
