// Distributions from which a batch draws parameters, and the seeds of its runs. A draw depends on the batch's seed, the
// parameter's name and the number of the draw alone (engine/base/random.hpp): the same bits on every machine, whatever
// ran before.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace verisim::batch {

struct Distribution {
  enum class Kind { uniform, normal };
  Kind kind = Kind::uniform;
  double first = 0;   ///< uniform: the lowest value. normal: the mean
  double second = 0;  ///< uniform: the bound above, never drawn. normal: the standard deviation
};

/// A number as the parameter takes it: "5mm", "mm(5)", "0.005". Error names it.
using ReadNumber = std::function<double(const std::string& text)>;

/// "LOW..HIGH" and "uniform:LOW:HIGH"; "normal:MEAN:SD"; "zone:H7:25mm": a diameter, normal, whose ISO zone is six
/// standard deviations wide about its middle. Error(usage) that begins with `what`.
[[nodiscard]] Distribution distribution_from(const std::string& what, const std::string& text, const ReadNumber& read);

/// The draw of that number for the parameter `key`.
[[nodiscard]] double drawn(const Distribution& distribution, std::uint64_t batch_seed, const std::string& key,
                           std::uint64_t number);

/// The seed of a repetition, below 2^53: a table's numbers hold it exactly, in Python and in a spreadsheet, too. Equal
/// in all points of a grid, which are paired by it.
[[nodiscard]] std::uint64_t seed_of_repetition(std::uint64_t batch_seed, std::uint64_t repetition);

}  // namespace verisim::batch
