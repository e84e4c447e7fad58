// Text in columns, each as wide as what stands in it. What stands there may come from outside: a cell is shown as one
// harmless line (text.hpp), its tabs as \t.
#pragma once

#include <string>
#include <vector>

namespace verisim {

class TextTable {
 public:
  /// @param sides  of each column: < to the left, > to the right; empty: the first and the last to the left
  /// @pre the head has cells; as many sides as it has, or none
  explicit TextTable(std::vector<std::string> head, std::string sides = {});
  /// @pre as many cells as the head has
  void add(std::vector<std::string> cells);
  /// Each line indented by two, without blanks at its end. Characters are counted, not bytes.
  [[nodiscard]] std::string text() const;

 private:
  std::vector<std::vector<std::string>> rows_;
  std::string sides_;
};

}  // namespace verisim
