// What the runs of a batch say on stderr and come to their end: each line once, with the run that said it first.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace verisim::cli {

class RunWords {
 public:
  /// The lines that no run said before: "warning: run 3 (clearance=0.001, seed 7): …". Of very many the first.
  [[nodiscard]] std::vector<std::string> take(std::uint64_t run, const std::string& name, const std::string& words);
  /// Of each line that several runs said, how many more.
  [[nodiscard]] std::vector<std::string> rest() const;

 private:
  struct Said {
    std::uint64_t first = 0, more = 0;
  };
  std::map<std::string, Said> said_;
  bool is_full_ = false;
};

}  // namespace verisim::cli
