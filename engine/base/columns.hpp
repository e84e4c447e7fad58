// What is recorded of every frame. One declaration per fact: path, shape, unit, meaning and where the value comes from
// stand in one place, and who stores, hashes, compares or documents a fact reads it from there.
//
//     columns.add("/state/time", "s", "simulated time at the end of the frame", [&] { return world.time(); });
//
// Type and shape follow from what the getter returns (Recorded below). Rows are packed without padding: first all that
// stands under /state, so that the state of a frame is one run of bytes, then all else, each in the order of adding.
//
// What is added between begin_part() and end_part() is a part of the state: of one subject, a body. Who knows which
// subjects are as they were writes only the others' parts into the row of the frame before.
//
// Besides the row of every frame there is one table whose rows come and go: as many in a frame as there are subjects
// worth one (pairs of bodies that are near each other).
#pragma once

#include <array>
#include <concepts>
#include <cstring>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/named_array.hpp"
#include "engine/base/pose.hpp"

namespace verisim {

/// One dataset that grows with the frames.
struct Column {
  std::string path;  ///< "/state/body/pin/pose"
  Dtype dtype = Dtype::f64;
  std::size_t width = 1;  ///< 1: dataset of shape [N]; else [N, width]
  std::string units;
  std::string description;
  std::size_t offset = 0;  ///< bytes from the start of the row; set by Schema::add
  /// u8 of width 1: value i means enum_names[i] (an HDF5 enum). Otherwise names of the components (stages of /timing).
  std::vector<std::string> enum_names;
  /// Empty: every frame adds a row. Else the path of a u32 column of the same schema: only frames where that is not 0
  /// add a row to this one (what runs at a rate of its own).
  std::string due = {};
  /// Not empty: a column of the table. A u32 column of the same schema says how many rows each frame adds.
  std::string rows_in_frame = {};
  bool may_be_nan = false;  ///< f64: NaN where the value is not known. All others are finite, or the run has diverged
  static constexpr std::size_t kNoPart = static_cast<std::size_t>(-1);
  std::size_t part = kNoPart;  ///< of the state (Columns::begin_part); kNoPart: of none
  /// Not empty: what the column says while its part is at rest, bytes() of it. A row that says so costs nothing: the
  /// dataset is made to say it where nothing is written. @pre it is of a part; 256 bytes at most
  std::vector<std::byte> rest = {};
  [[nodiscard]] std::size_t bytes() const { return size_of(dtype) * width; }
};

/// Values go to a row one behind the other.
template <typename T>
void put_value(std::byte*& at, const T& value) {
  std::memcpy(at, &value, sizeof value);
  at += sizeof value;
}

/// How a type is stored: number type, how many of them, and writing them.
template <typename T>
struct Recorded {
  static constexpr Dtype kType = dtype_of<T>();
  static constexpr std::size_t kWidth = 1;
  static void put(std::byte*& at, const T& value) { put_value(at, value); }
};
template <>
struct Recorded<bool> {
  static constexpr Dtype kType = Dtype::u8;
  static constexpr std::size_t kWidth = 1;
  static void put(std::byte*& at, bool value) { put_value(at, static_cast<std::uint8_t>(value)); }
};
template <typename T, std::size_t N>
struct Recorded<std::array<T, N>> {
  static constexpr Dtype kType = dtype_of<T>();
  static constexpr std::size_t kWidth = N;
  static void put(std::byte*& at, const std::array<T, N>& values) { put_value(at, values); }
};
template <>
struct Recorded<Pose> {  ///< position, quaternion x y z w
  static constexpr Dtype kType = Dtype::f64;
  static constexpr std::size_t kWidth = 7;
  static void put(std::byte*& at, const Pose& X) {
    const Quaterniond& q = X.rotation;
    put_value(at, std::array{X.position.x(), X.position.y(), X.position.z(), q.x(), q.y(), q.z(), q.w()});
  }
};
template <>
struct Recorded<Twist> {  ///< linear, angular
  static constexpr Dtype kType = Dtype::f64;
  static constexpr std::size_t kWidth = 6;
  static void put(std::byte*& at, const Twist& v) {
    for (const Vector3d* part : {&v.linear, &v.angular}) put_value(at, std::array{part->x(), part->y(), part->z()});
  }
};
template <>
struct Recorded<Wrench> {  ///< force, torque
  static constexpr Dtype kType = Dtype::f64;
  static constexpr std::size_t kWidth = 6;
  static void put(std::byte*& at, const Wrench& w) {
    for (const Vector3d* part : {&w.force, &w.torque}) put_value(at, std::array{part->x(), part->y(), part->z()});
  }
};

class Columns {
 public:
  /// Declares a fact; what is returned may be added to until the next one. `get` is called once a frame when the row is
  /// filled; it must not allocate. `names`: of an enum's values or of the components (Column::enum_names). `due`:
  /// Column::due.
  template <std::invocable Get>
  Column& add(std::string path, std::string units, std::string description, Get get,
              std::vector<std::string> names = {}, std::string due = {}) {
    using Value = std::remove_cvref_t<std::invoke_result_t<Get>>;
    Column column{std::move(path),  Recorded<Value>::kType, Recorded<Value>::kWidth,
                  std::move(units), std::move(description), 0,
                  std::move(names), std::move(due)};
    const bool is_state = column.path.starts_with("/state/");
    if (is_state) {
      if (in_part_) column.part = parts_.size() - 1;
      add_to_run(column);
    }
    return (is_state ? state_ : other_).add(std::move(column), [get = std::move(get)](std::byte*& at) {
      Recorded<Value>::put(at, get());
    });
  }

  /// Declares a fact of the table's rows. `get` is called with the subject of each row. `rows_in_frame`: see Column.
  template <std::invocable<std::size_t> Get>
  void add_to_table(std::string path, std::string units, std::string description, Get get, std::string rows_in_frame,
                    std::vector<std::string> names = {}) {
    using Value = std::remove_cvref_t<std::invoke_result_t<Get, std::size_t>>;
    Column column{std::move(path),         Recorded<Value>::kType,
                  Recorded<Value>::kWidth, std::move(units),
                  std::move(description),  0,
                  std::move(names),        {},
                  std::move(rows_in_frame)};
    table_.add(std::move(column),
               [get = std::move(get)](std::byte*& at, std::size_t subject) { Recorded<Value>::put(at, get(subject)); });
  }

  /// Parts are numbered from 0, in their order; none is within another.
  void begin_part() {
    VERISIM_ASSERT(!in_part_);
    in_part_ = true;
    parts_.push_back({state_.put.size(), 0, state_.bytes, 0});
  }
  void end_part() {
    VERISIM_ASSERT(in_part_);
    in_part_ = false;
  }

  [[nodiscard]] const std::vector<Column>& state() const { return state_.columns; }
  [[nodiscard]] const std::vector<Column>& other() const { return other_.columns; }
  [[nodiscard]] const std::vector<Column>& table() const { return table_.columns; }
  [[nodiscard]] std::size_t state_bytes() const { return state_.bytes; }
  [[nodiscard]] std::size_t other_bytes() const { return other_.bytes; }
  [[nodiscard]] std::size_t table_bytes() const { return table_.bytes; }  ///< of one row

  /// Writes state_bytes(), other_bytes() or table_bytes() from `at` on. No allocation. About 3 ns a fact.
  void put_state(std::byte* at) const { state_.put_all(at); }
  /// Writes what belongs to no part, and these parts; the other bytes stay.
  void put_state(std::byte* at, std::span<const std::size_t> parts) const {
    each_run(parts, [&](const Run& run) { state_.put_run(at, run.first, run.facts, run.offset); });
  }
  /// Calls f(offset, bytes) for all that put_state(at, parts) writes.
  template <typename F>
  void each_written(std::span<const std::size_t> parts, const F& f) const {
    each_run(parts, [&](const Run& run) { f(run.offset, run.bytes); });
  }
  [[nodiscard]] std::size_t part_count() const { return parts_.size(); }
  /// Where the facts of a part lie in the state: f(offset, bytes).
  template <typename F>
  void of_part(std::size_t part, const F& f) const {
    VERISIM_ASSERT(part < parts_.size());
    f(parts_[part].offset, parts_[part].bytes);
  }
  void put_other(std::byte* at) const { other_.put_all(at); }
  void put_table_row(std::byte* at, std::size_t subject) const { table_.put_all(at, subject); }

 private:
  template <typename... Subject>
  struct Facts {
    std::vector<Column> columns;
    std::vector<std::function<void(std::byte*&, Subject...)>> put;
    std::size_t bytes = 0;
    Column& add(Column column, std::function<void(std::byte*&, Subject...)> put_value) {
      bytes += column.bytes();
      columns.push_back(std::move(column));
      put.push_back(std::move(put_value));
      return columns.back();
    }
    void put_run(std::byte* at, std::size_t first, std::size_t count, std::size_t offset, Subject... subject) const {
      at += offset;
      for (std::size_t i = first; i < first + count; ++i) put[i](at, subject...);
    }
    void put_all(std::byte* at, Subject... subject) const {
      const std::byte* const end = at + bytes;
      for (const auto& put_next : put) put_next(at, subject...);
      VERISIM_ASSERT(at == end);
    }
  };
  /// Facts of the state that lie together.
  struct Run {
    std::size_t first, facts, offset, bytes;
  };
  template <typename F>
  void each_run(std::span<const std::size_t> parts, const F& f) const {
    for (const Run& run : rest_) f(run);
    for (const std::size_t i : parts) {
      VERISIM_ASSERT(i < parts_.size());
      f(parts_[i]);
    }
  }
  void add_to_run(const Column& column) {
    if (!in_part_ && (rest_.empty() || rest_.back().offset + rest_.back().bytes != state_.bytes))
      rest_.push_back({state_.put.size(), 0, state_.bytes, 0});
    Run& run = in_part_ ? parts_.back() : rest_.back();
    ++run.facts;
    run.bytes += column.bytes();
  }

  std::vector<Run> parts_, rest_;
  bool in_part_ = false;
  Facts<> state_, other_;
  Facts<std::size_t> table_;
};

}  // namespace verisim
