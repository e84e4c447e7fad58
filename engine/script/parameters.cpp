#include "engine/script/parameters.hpp"

#include <array>
#include <charconv>
#include <cmath>

#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"
#include "engine/script/script_state.hpp"

namespace verisim {
namespace {

struct Prefix {
  const char* text;
  int exponent;
};
constexpr std::array kPrefixes = {Prefix{"p", -12}, Prefix{"n", -9}, Prefix{"u", -6}, Prefix{"µ", -6},
                                  Prefix{"m", -3},  Prefix{"c", -2}, Prefix{"d", -1}, Prefix{"", 0},
                                  Prefix{"k", 3},   Prefix{"M", 6},  Prefix{"G", 9}};

/// Exact up to 10^22, so that a power of ten costs one rounding.
double power_of_ten(int exponent) {
  double power = 1;
  for (int i = 0; i < exponent; ++i) power *= 10;
  return power;
}

double scaled(double value, int exponent) {
  return exponent < 0 ? value / power_of_ten(-exponent) : value * power_of_ten(exponent);
}

/// The unit without its prefix, and the power of ten to which it is the SI unit: g is 10^-3 kg.
struct BaseUnit {
  const char* text;
  int exponent;
};
constexpr std::array kBaseUnits = {BaseUnit{"m", 0}, BaseUnit{"s", 0}, BaseUnit{"N", 0}, BaseUnit{"g", -3}};

}  // namespace

std::optional<double> number_with_unit(const std::string& text) {
  double value = 0;
  const char* begin = text.data();
  const char* end = begin + text.size();
  if (begin != end && *begin == '+') ++begin;
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (error != std::errc() || stop == begin || !std::isfinite(value)) return {};
  std::string unit(stop, end);
  unit.erase(0, unit.find_first_not_of(' '));
  if (unit == "rad") return value;
  if (unit == "deg") return value * (pinned::kPi / 180);
  for (const BaseUnit& base : kBaseUnits)
    for (const Prefix& prefix : kPrefixes)
      if (unit == std::string(prefix.text) + base.text) return scaled(value, prefix.exponent + base.exponent);
  return {};
}

struct DeclaredParameters::Implementation {
  Implementation(const ScenarioOptions& options, Inputs& inputs) : state(options, inputs) {}
  script::ScriptState state;
};

DeclaredParameters::DeclaredParameters(const ScenarioOptions& options, Inputs& inputs)
    : implementation_(std::make_unique<Implementation>(options, inputs)) {
  script::ScriptState& state = implementation_->state;
  state.parameters_only = true;
  lua_State* L = state.lua();
  state.allow(options.instruction_limit);
  auto failure = state.load(L, state.name(), inputs.read(state.name()));
  if (!failure) failure = state.call(L, 0, 0);
  if (failure && !state.parameters_known) throw Error(ErrorKind::input, failure->text);
  if (!state.parameters_known) state.check_sets();
}

DeclaredParameters::~DeclaredParameters() = default;

const std::vector<ParameterDeclaration>& DeclaredParameters::all() const {
  return implementation_->state.parameters;
}

std::string DeclaredParameters::value_of(const std::string& key, const std::string& text, const std::string& option) {
  script::ScriptState& state = implementation_->state;
  constexpr std::uint64_t kValueWork = 1'000'000;
  state.allow(kValueWork);
  state.set_option = option;
  return script::read_set_value(state, key, text);
}

}  // namespace verisim
