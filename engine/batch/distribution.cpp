#include "engine/batch/distribution.hpp"

#include <cmath>
#include <vector>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"
#include "engine/batch/design_text.hpp"
#include "engine/batch/iso286.hpp"

namespace verisim::batch {
namespace {

constexpr const char* kForms = "write LOW..HIGH, uniform:LOW:HIGH, normal:MEAN:SD or zone:H7:25mm";

Distribution uniform(const std::string& what, double low, double high) {
  if (!(low < high)) fail(ErrorKind::usage, "{}: {} is not below {}; write LOW..HIGH", what, low, high);
  if (!std::isfinite(high - low)) fail(ErrorKind::usage, "{}: {} to {} is too wide for a number", what, low, high);
  return {Distribution::Kind::uniform, low, high};
}

Distribution normal(const std::string& what, double mean, double sd) {
  if (!(sd >= 0)) fail(ErrorKind::usage, "{}: a standard deviation of {}; it must not be below 0", what, sd);
  constexpr double kFarthest = 40;  // standard deviations: no double's draw is beyond
  if (!std::isfinite(mean + kFarthest * sd) || !std::isfinite(mean - kFarthest * sd))
    fail(ErrorKind::usage, "{}: draws about {} with a standard deviation of {} are beyond all numbers", what, mean, sd);
  return {Distribution::Kind::normal, mean, sd};
}

Distribution zone(const std::string& what, const std::string& name, double nominal) {
  const Deviations d = deviations(what, name, nominal);
  constexpr double kSigmas = 6;  // the zone's width in standard deviations
  return {Distribution::Kind::normal, nominal + (d.lower + d.upper) / 2, (d.upper - d.lower) / kSigmas};
}

}  // namespace

Distribution distribution_from(const std::string& what, const std::string& text, const ReadNumber& read) {
  const std::vector<std::string> words = split_outside_brackets(text, ':');
  const std::string& kind = words.front();
  if (kind == "uniform" || kind == "normal" || kind == "zone") {
    if (words.size() != 3) fail(ErrorKind::usage, "{}: '{}' has two figures behind it; {}", what, kind, kForms);
    if (kind == "zone") return zone(what, words[1], read(words[2]));
    const double first = read(words[1]), second = read(words[2]);
    return kind == "uniform" ? uniform(what, first, second) : normal(what, first, second);
  }
  const std::size_t dots = text.find("..");
  if (dots == std::string::npos || dots == 0 || dots + 2 >= text.size())
    fail(ErrorKind::usage, "{}: '{}' is no distribution; {}", what, text, kForms);
  const double first = read(text.substr(0, dots)),
               second = read(text.substr(dots + 2));  // the first error is the first's
  return uniform(what, first, second);
}

double drawn(const Distribution& distribution, std::uint64_t batch_seed, const std::string& key, std::uint64_t number) {
  const RandomStream stream(batch_seed, "batch parameter " + key);
  if (distribution.kind == Distribution::Kind::normal)
    return distribution.first + distribution.second * stream.normal(number);
  const double value = distribution.first + (distribution.second - distribution.first) * stream.uniform(number);
  return value < distribution.second ? value : std::nextafter(distribution.second, distribution.first);
}

std::uint64_t seed_of_repetition(std::uint64_t batch_seed, std::uint64_t repetition) {
  constexpr int kBits = 53;
  return RandomStream(batch_seed, "batch repetition").bits(repetition) >> (64 - kBits);
}

}  // namespace verisim::batch
