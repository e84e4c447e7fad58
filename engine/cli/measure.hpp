// `verisim replay --measure`: the recorded penetration of each pair beside its true overlap (engine/ruler).
#pragma once

#include <string>
#include <vector>

#include "engine/base/json.hpp"
#include "engine/record/run_file.hpp"
#include "engine/ruler/ruler.hpp"
#include "engine/session/progress_line.hpp"
#include "engine/simulation/scene.hpp"

namespace verisim::cli {

/// What the ruler needs of a body.
struct MeasuredBody {
  std::string name;
  ruler::Shape shape;
};
[[nodiscard]] std::vector<MeasuredBody> measured_bodies(const Scene& scene);

/// A pair of bodies over all frames of a run. Lengths in m.
///
/// max_penetration of a row is of the poses with which its step began: those of the row before. So the recorded value
/// that stands beside the overlap of frame i is that of row i + 1; the last frame has none.
struct MeasuredPair {
  std::string first, second;
  std::string why_not;           ///< it cannot be measured; the rest is then empty
  std::vector<double> recorded;  ///< 0 where the pair was not near; one frame less

  /// By what it was measured; a value per frame. The true overlap is in [overlap, overlap + bound].
  struct Measured {
    ruler::Source source = ruler::Source::solids;
    std::vector<double> overlap, bound;
  };
  /// One; and a second one by the surfaces that the faces of triangles were recognized or recovered as.
  std::vector<Measured> measured;

  /// How far the recorded value is outside of [overlap, overlap + bound]; above 0: the record says too little.
  [[nodiscard]] double difference(const Measured& by, std::size_t frame) const;
};

/// Every pair of /state/pairs, in its order, from /state/body/*/pose. Error(input) for a file without such pairs
/// (format 1) or of other bodies. A frame in which nothing moved by more than the ruler may miss takes the answer of
/// the one before, its bound widened by that.
[[nodiscard]] std::vector<MeasuredPair> measure_run(const RunFile& file, std::vector<MeasuredBody> bodies,
                                                    const ProgressLine& line);

[[nodiscard]] std::string table_of(const std::vector<MeasuredPair>& pairs);
[[nodiscard]] Json json_of(const std::vector<MeasuredPair>& pairs);

}  // namespace verisim::cli
