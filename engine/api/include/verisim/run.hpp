// One simulation of a scenario, in this process: the same bits as `verisim run` with the same scenario, parameters,
// seed and inputs. SI units; poses are of a body's own coordinates in the world's.
//
//   verisim::RunRequest request{.scenario = "scenarios/peg_in_hole.lua", .parameters = {{"clearance", "1mm"}}};
//   const verisim::RunOutcome outcome = verisim::run(request);
//
// Several threads may each have runs of their own.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <verisim/failure.hpp>

namespace verisim {

/// A simulation between two frames. Valid while RunRequest::each_frame is called.
class VERISIM_PUBLIC Frame {
 public:
  struct Implementation;
  explicit Frame(const Implementation& implementation) : implementation_(implementation) {}
  [[nodiscard]] std::uint64_t number() const;  ///< frames computed so far
  [[nodiscard]] double time() const;           ///< s, simulated
  [[nodiscard]] const std::vector<std::string>& bodies() const;
  // Of a body. Failure naming the nearest name if there is none of that name.
  [[nodiscard]] std::array<double, 7> pose(const std::string& body) const;      ///< m; quaternion x y z w
  [[nodiscard]] std::array<double, 6> velocity(const std::string& body) const;  ///< of the centre of mass, m/s, rad/s
  [[nodiscard]] std::array<double, 6> contact_wrench(const std::string& body) const;  ///< of the last frame, N, N m

 private:
  const Implementation& implementation_;
};

struct RunRequest {
  std::string scenario;                                           ///< path of a Lua file
  std::vector<std::pair<std::string, std::string>> parameters{};  ///< as --set takes them: {"clearance", "1mm"}
  std::vector<std::pair<std::string, std::string>> binds{};       ///< as --bind: {"omni", "reach.csv"}
  std::optional<std::uint64_t> seed{};                            ///< else the scenario's
  std::optional<double> duration{};                               ///< s, simulated; else the scenario's
  std::string out{};          ///< run file to write; its folder is made; empty: none is written
  bool force = false;         ///< replace a plain file that is no run file
  bool another_name = false;  ///< while another run writes `out`: OUT-2.h5, OUT-3.h5 …; else that is a Failure
  unsigned threads = 1;       ///< same bits for any number
  bool prepared = true;       ///< use and keep prepared parts (VERISIM_CACHE)
  std::function<void(const std::string&)> print{};  ///< receives what the scenario prints; empty: only /events does
  std::function<bool(const Frame&)> each_frame{};   ///< called after every frame; false ends the run. May be empty
};

struct RunOutcome {
  std::string end;         ///< "done", "diverged" … (`end` of verisim run --json)
  std::string error;       ///< why it did not end by itself; else empty
  std::string outcome;     ///< the scenario's own word
  std::string state_hash;  ///< 16 hex digits: equal for equal runs
  std::uint64_t frames = 0;
  double simulated_s = 0;
  std::map<std::string, double> measures;  ///< measure() of the scenario
  std::vector<std::string> warnings;       ///< what the program says on stderr
  std::string json;                        ///< all that verisim run --json prints
  std::string out;                         ///< the run file; empty if none was asked for
};

/// Loads the scenario and runs it to its end. Nothing is said on stdout or stderr. Failure for bad input, also for a
/// body that is refused when it comes near another, for a path or name that is not one line of UTF-8 (a NUL in it would
/// cut it), and if the file cannot be written. Costs what the program costs: a millisecond of simulated time takes some
/// 10 us.
[[nodiscard]] VERISIM_PUBLIC RunOutcome run(const RunRequest& request);

/// "0.1.0"
[[nodiscard]] VERISIM_PUBLIC std::string version();

}  // namespace verisim
