// params{} and --set, and the small words around them.
#include <gtest/gtest.h>

#include <tuple>

#include "engine/base/pinned_math.hpp"
#include "engine/script/parameters.hpp"
#include "tests/script/written_scenario.hpp"

namespace verisim::parameters_test {
namespace {

std::string resolved(const std::string& declaration, std::vector<std::pair<std::string, std::string>> sets) {
  WrittenScenario written("params" + declaration);
  written.options.sets = std::move(sets);
  const std::string refusal = written.refusal();
  return refusal.empty() ? written.scenario->parameters_json() : refusal;
}

TEST(Parameters, KeepTheirDefaults) {
  EXPECT_EQ(resolved("{clearance = 0.005, fit = 'H7', half = true, axis = {0, 0, 1}}", {}),
            R"({"axis":[0.0,0.0,1.0],"clearance":0.005,"fit":"H7","half":true})");
}

TEST(Parameters, TakeValuesThatAreLuaExpressions) {
  EXPECT_EQ(resolved("{clearance = 0.005}", {{"clearance", "mm(3) + 1/8"}}), R"({"clearance":0.128})");
  EXPECT_EQ(resolved("{half = false}", {{"half", "true"}}), R"({"half":true})");
  EXPECT_EQ(resolved("{axis = {0, 0, 1}}", {{"axis", "{1,0,0}"}}), R"({"axis":[1.0,0.0,0.0]})");
}

TEST(Parameters, TakeBareWordsAsTexts) {
  EXPECT_EQ(resolved("{fit = ''}", {{"fit", "H7/g6"}}), R"({"fit":"H7/g6"})");
  EXPECT_EQ(resolved("{fit = ''}", {{"fit", "../models/a b.step"}}), R"({"fit":"../models/a b.step"})");
  EXPECT_EQ(resolved("{fit = ''}", {{"fit", "'H7/g6'"}}), R"({"fit":"H7/g6"})");
}

TEST(Parameters, ReachTheScriptByNameAndAsResult) {
  WrittenScenario written(
      "local p = params{clearance = 0.005} assert(p.clearance == 0.25) assert(params.clearance == 0.25)");
  written.options.sets = {{"clearance", "0.25"}};
  EXPECT_EQ(written.refusal(), "");
}

TEST(Parameters, ThatWereNeverDeclaredAreRefusedWithTheNearestAndAll) {
  EXPECT_EQ(resolved("{clearance = 0.005, tilt = 0, voxelsize = 0.003}", {{"clerance", "0.004"}}),
            "--set clerance=0.004: pin.lua has no parameter 'clerance'; did you mean 'clearance'? (clearance, tilt, "
            "voxelsize)");
}

TEST(Parameters, OfAScriptWithoutAnyAreRefused) {
  WrittenScenario written("x = 1");
  written.options.sets = {{"clearance", "1"}};
  EXPECT_EQ(written.refusal(), "--set clearance=1: pin.lua declares no parameters; add params{ clearance = … } to it");
}

TEST(Parameters, KeepTheTypeOfTheirDefault) {
  const std::string refusal = resolved("{clearance = 0.005}", {{"clearance", "wide"}});
  EXPECT_EQ(refusal,
            "--set clearance=wide: 'clearance' must be a number, as its default at pin.lua:1 is, not a text ('wide')");
  EXPECT_NE(resolved("{half = true}", {{"half", "1"}}).find("must be a boolean"), std::string::npos);
}

TEST(Parameters, ThatAreNoExpressionsOrFailAreRefused) {
  EXPECT_NE(resolved("{clearance = 0.005}", {{"clearance", "(1"}}).find("this is no Lua expression"),
            std::string::npos);
  EXPECT_NE(resolved("{clearance = 0.005}", {{"clearance", "nil + 1"}}), "");
  EXPECT_NE(resolved("{clearance = 0.005}", {{"clearance", "0/0"}}).find("must be finite"), std::string::npos);
}

TEST(Parameters, ThatHoldThemselvesAreRefused) {
  EXPECT_NE(refusal_of("local t = {} t[1] = t params{a = t}").find("nested more than 8 deep"), std::string::npos);
}

TEST(Parameters, AreDeclaredInOnePlace) {
  EXPECT_EQ(refusal_of("params{a = 1}\nparams{b = 1}"),
            "pin.lua:2: params was declared at pin.lua:1 already; put all parameters there");
}

TEST(Parameters, ThatAreReadUnderAWrongNameSuggestTheRightOne) {
  EXPECT_EQ(refusal_of("local p = params{tilt = 1}\nprint(p.tlt)"),
            "pin.lua:2: there is no parameter 'tlt'; did you mean 'tilt'? (tilt)");
}

TEST(Units, AreMetresAndRadians) {
  EXPECT_EQ(refusal_of("assert(mm(3) == 0.003) assert(math.abs(deg(180) - math.pi) < 1e-15)"), "");
  EXPECT_EQ(refusal_of("mm('3')"), "pin.lua:1: mm: the length must be a number, not a text ('3')");
}

TEST(Units, OfTheCommandLineAreThoseOfTheWords) {
  EXPECT_EQ(number_with_unit("5mm"), 5 / 1000.0);
  EXPECT_EQ(number_with_unit("0.5 deg"), 0.5 * (pinned::kPi / 180));
  EXPECT_EQ(number_with_unit("200us"), 200 / 1e6);
  EXPECT_EQ(number_with_unit("200µs"), 200 / 1e6);
  EXPECT_EQ(number_with_unit("1.5kN"), 1500.0);
  EXPECT_EQ(number_with_unit("-3e-2m"), -0.03);
  EXPECT_EQ(number_with_unit("+2kg"), 2.0);
  EXPECT_EQ(number_with_unit("20g"), 0.02);
  EXPECT_EQ(number_with_unit("3mg"), 3 / 1e6);
  EXPECT_EQ(number_with_unit("7cm"), 7 / 100.0);
  EXPECT_EQ(number_with_unit("1rad"), 1.0);
  for (const char* text :
       {"", "5", "mm", "5 apples", "5mm2", "5mm+1", "5min", "inf m", "nan s", "1e999m", "5kdeg", "0x5m"})
    EXPECT_EQ(number_with_unit(text), std::nullopt) << text;
  EXPECT_EQ(resolved("{clearance = 0.005, word = ''}", {{"clearance", "3mm"}, {"word", "3mm"}}),
            R"({"clearance":0.003,"word":"3mm"})");
}

TEST(Parameters, MaySayTheirUnitAndMeaning) {
  EXPECT_EQ(resolved("{clearance = parameter(0.005, 'm', 'on the radius'), fit = parameter('H7'), half = true}",
                     {{"clearance", "1mm"}}),
            R"({"clearance":0.001,"fit":"H7","half":true})");
  EXPECT_EQ(resolved("{a = parameter()}", {}),
            R"(pin.lua:1: parameter: its default is nothing; write parameter(0.005, "m", "on the radius"))");
  EXPECT_EQ(resolved("{a = {parameter(1, 'm')}}", {}),
            "pin.lua:1: params: a[1]: parameter(…) is a whole default, not part of one");
  EXPECT_EQ(resolved("{a = parameter(parameter(1))}", {}),
            "pin.lua:1: params: a: parameter(…) is a whole default, not part of one");
  EXPECT_NE(resolved("{a = parameter(1, {})}", {}).find("parameter: the unit"), std::string::npos);
}

TEST(DeclaredParameters, AreReadWithoutTheScene) {
  WrittenScenario written(
      "local p = params{b = 1, a = parameter(0.005, 'm', 'on the radius'), w = 'x', f = false} error('too far')");
  written.options.sets = {{"b", "2"}};
  Inputs inputs = Inputs::live(written.folder().string(), {});
  DeclaredParameters parameters(written.options, inputs);
  ASSERT_EQ(parameters.all().size(), 4u);
  const ParameterDeclaration& a = parameters.all()[0];
  EXPECT_EQ(a.name + a.type + a.value_json + a.unit + a.meaning, "anumber0.005mon the radius");
  EXPECT_EQ(parameters.all()[1].value_json, "2.0");
  EXPECT_EQ(parameters.value_of("a", "mm(3)"), "0.003");
  EXPECT_EQ(parameters.value_of("a", "3mm"), "0.003");
  EXPECT_EQ(parameters.value_of("w", "H7/g6"), R"("H7/g6")");
  EXPECT_EQ(parameters.value_of("f", "true"), "true");
  for (const auto& [key, text, words] : {std::tuple{"c", "1", "has no parameter 'c'"},
                                         {"a", "fast", "must be a number"},
                                         {"a", "1 +", "no Lua expression"},
                                         {"f", "1", "must be a boolean"},
                                         {"a", "(function() while true do end end)()", "units of work"}}) {
    try {
      (void)parameters.value_of(key, text);
      ADD_FAILURE() << key << "=" << text;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  }
  EXPECT_EQ(parameters.value_of("a", "1"), "1.0") << "what failed leaves nothing behind";
}

TEST(DeclaredParameters, OfAScriptWithoutAnyAreNone) {
  WrittenScenario written("measure('x', 1)");
  Inputs inputs = Inputs::live(written.folder().string(), {});
  DeclaredParameters parameters(written.options, inputs);
  EXPECT_TRUE(parameters.all().empty());
  EXPECT_THROW((void)parameters.value_of("a", "1"), Error);
}

TEST(Measures, KeepTheLastValueOfEachName) {
  WrittenScenario written(
      "measure('depth', 0.1, 'm') measure('passes', 2) measure('depth', 0.2, 'm') outcome('inserted')");
  ASSERT_EQ(written.refusal(), "");
  ASSERT_EQ(written.scenario->measures().size(), 2u);
  EXPECT_EQ(written.scenario->measures()[0].value, 0.2);
  EXPECT_EQ(written.scenario->measures()[1].unit, "1");
  EXPECT_EQ(written.scenario->outcome(), "inserted");
  EXPECT_FALSE(written.scenario->finished());
}

TEST(Outcome, CanStopTheRun) {
  WrittenScenario written("outcome('inserted', {stop = true})");
  ASSERT_EQ(written.refusal(), "");
  EXPECT_TRUE(written.scenario->finished());
}

TEST(Scenario, EndsALoopThatNeverEndsWithFileAndLine) {
  WrittenScenario written("local i = 0\nwhile true do\n  pcall(function() i = i + 1 end)\nend");
  written.options.instruction_limit = 1'000'000;
  EXPECT_NE(written.refusal().find("without coming to an end"), std::string::npos);
}

TEST(Scenario, EndsAScriptThatEatsMemory) {
  WrittenScenario written("local t = {}\nfor i = 1, 1e8 do t[i] = {} end");
  written.options.memory_limit = std::size_t{8} << 20;
  EXPECT_NE(written.refusal().find("needs more than 8 MiB of memory"), std::string::npos);
}

}  // namespace
}  // namespace verisim::parameters_test
