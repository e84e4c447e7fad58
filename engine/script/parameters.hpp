// What a scenario declares with params{}, read from its script before anything of its scene is built: names, values,
// units and meanings; and what a text of the command line is as a value of one of them.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/script/scenario.hpp"

namespace verisim {

/// A parameter after `--set`: clearance = parameter(0.005, "m", "on the radius"), or clearance = 0.005.
struct ParameterDeclaration {
  std::string name;
  std::string type;           ///< as Lua names it: "number", "string", "boolean", "table"
  std::string value_json;     ///< what it is, as JSON
  std::string unit, meaning;  ///< empty: the scenario does not say
};

class DeclaredParameters {
 public:
  /// Runs the script up to params{}; all of it if it has none. Error(input) as Scenario has it.
  DeclaredParameters(const ScenarioOptions& options, Inputs& inputs);
  ~DeclaredParameters();

  [[nodiscard]] const std::vector<ParameterDeclaration>& all() const;  ///< by name
  /// What `--set key=text` would make of the parameter, as JSON. Error(input): there is none (lists them), the text is
  /// no value of its type. @param option  where the text stands, for the error: --vary, or a line of a file
  [[nodiscard]] std::string value_of(const std::string& key, const std::string& text,
                                     const std::string& option = "--set");

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// "5mm", "0.5deg", "200us", "1.5 kg": a number with a unit, in SI units (deg: rad); nothing if it is something else.
/// SI prefixes from pico to giga of m, s, N and g; deg and rad have none. The same bits as mm(5).
[[nodiscard]] std::optional<double> number_with_unit(const std::string& text);

}  // namespace verisim
