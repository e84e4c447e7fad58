// What a run file (HDF5) holds, field by field. Nothing is read before it is asked for.
//
//   const verisim::Run run("runs/peg_in_hole.h5");
//   const verisim::Values pose = run.read("/state/body/pin/pose");  // shape {frames, 7}
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <verisim/failure.hpp>

namespace verisim {

/// What a field is; all a run file says of it.
struct Field {
  std::string path;                ///< "/state/body/pin/pose"
  std::string type;                ///< as NumPy writes it: "f8", "f4", "u8", "u4", "u2", "u1", "i4", "i1"
  std::size_t width = 1;           ///< 1: shape {rows}; else {rows, width}
  std::string units;               ///< "m", "1" …
  std::string meaning;             ///< one sentence
  std::vector<std::string> names;  ///< of the components; of a "u1" of width 1: what value i means
  bool of_frames = true;           ///< a row for every frame. Else: for what is not there in every one of them
};

/// The values of a field, row by row.
struct VERISIM_PUBLIC Values {
  Field field;
  std::vector<std::size_t> shape;
  std::vector<std::byte> bytes;  ///< native byte order

  /// One number, whatever the type. Failure outside of the shape.
  [[nodiscard]] double at(std::size_t row, std::size_t component = 0) const;
};

struct RunEvent {
  double time = 0;  ///< s, simulated
  std::string kind, text;
};

/// A run file, opened for reading. The file of a run that was killed is closed first, as every command does.
class VERISIM_PUBLIC Run {
 public:
  using Attribute = std::variant<std::string, double, std::int64_t, std::uint64_t>;

  /// Failure: it is not there, no run file, damaged; the path is not one line of UTF-8.
  explicit Run(const std::string& path);
  ~Run();
  Run(Run&&) noexcept;
  Run& operator=(Run&&) noexcept;

  [[nodiscard]] const std::string& path() const;
  [[nodiscard]] std::size_t frames() const;
  [[nodiscard]] const std::map<std::string, Attribute>& attributes() const;  ///< of the file: scenario, seed, dt …
  [[nodiscard]] const std::map<std::string, Attribute>& summary() const;     ///< empty if the run was killed
  [[nodiscard]] std::vector<Field> fields() const;                           ///< in the order of the file
  /// Failure naming the nearest path if there is no such field.
  [[nodiscard]] Values read(const std::string& path) const;
  [[nodiscard]] std::vector<RunEvent> events() const;
  /// Names of the pairs of bodies that met: what /state/links/pair counts.
  [[nodiscard]] std::vector<std::pair<std::string, std::string>> pairs() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace verisim
