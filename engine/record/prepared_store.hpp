// What was prepared before, in a folder on disk: parts that the CAD kernel built, faces that were recovered, voxels,
// exact bodies. It saves time and nothing else: a run has the same bits with it, without it, cold or warm.
//
// An entry is found by its kind and by the SHA-256 of all that it was made from: inputs, options, and the program's own
// version. It is checked when it is read (length, key, XXH3-128 of its content). One that is damaged counts as absent,
// is counted, and is written again. Files are written under another name and renamed, so any number of processes may
// share a folder; of two that prepare the same one wins, with the same bytes. When the folder has grown beyond its
// limit, the entries that were used longest ago go; of several processes each knows what it keeps itself, so the limit
// may be passed by what the others keep meanwhile.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace verisim {

class PreparedStore {
 public:
  static constexpr std::uint64_t kBytesMax = std::uint64_t{2} << 30;

  /// @param folder   made when something is kept, for its owner alone
  /// @param version  of all that prepares; entries of another one are not found
  PreparedStore(std::string folder, std::string version, std::uint64_t bytes_max = kBytesMax);

  /// What was kept under that key; nothing if there is none, or none that can be read.
  /// @param kind  a word: letters and dashes
  [[nodiscard]] std::optional<std::string> find(std::string_view kind, std::string_view key);
  /// Keeps it, if the folder can be written and has room: nobody relies on it.
  void keep(std::string_view kind, std::string_view key, std::string_view content);

  struct Size {
    std::size_t entries = 0;
    std::uint64_t bytes = 0;
  };
  /// What a folder holds; nothing if it cannot be read.
  [[nodiscard]] static Size size_of(const std::string& folder);

  [[nodiscard]] const std::string& folder() const { return folder_; }
  [[nodiscard]] std::size_t found() const { return found_; }
  [[nodiscard]] std::size_t missed() const { return asked_ - found_; }
  [[nodiscard]] std::size_t kept() const { return kept_; }
  [[nodiscard]] std::size_t damaged() const { return damaged_; }  ///< entries that were not what was written

 private:
  [[nodiscard]] std::string path_of(std::string_view kind, const std::string& key_hash) const;
  void make_room(std::uint64_t bytes);

  std::string folder_;
  std::string version_;
  std::uint64_t bytes_max_;
  std::optional<std::uint64_t> bytes_there_;  ///< when the folder was last looked through, and kept since
  std::size_t asked_ = 0, found_ = 0, kept_ = 0, damaged_ = 0;
};

}  // namespace verisim
