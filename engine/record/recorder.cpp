#include <algorithm>
#include <atomic>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstring>
#include <thread>

#include "engine/base/error.hpp"
#include "engine/record/run_file.hpp"
#include "engine/record/run_writer.hpp"

namespace verisim {
namespace {

constexpr std::size_t kEventRing = 1024;
constexpr std::size_t kPairRing = 4096;
constexpr std::size_t kRingBytes = 64 << 20;
constexpr std::size_t kRowsAtOnce = 512;  // a backlog is written in pieces, so that each soon is safe
constexpr auto kNap = std::chrono::milliseconds(10);

std::size_t ring_rows(const RecorderOptions& options, std::size_t row_bytes) {
  constexpr std::size_t kEightSeconds = 8192;  // at 1000 Hz
  if (options.ring_rows > 0) return options.ring_rows;
  const std::size_t wanted = options.paced ? kEightSeconds : std::max<std::size_t>(256, options.frames_unflushed);
  return std::clamp<std::size_t>(kRingBytes / std::max<std::size_t>(1, row_bytes), 4, wanted);
}

}  // namespace

// Rings between one producer (the loop) and one consumer (the writer thread): of rows, of the table's rows, of events
// and of pairs. Each counter is written by one side only and never decreases; index = counter mod size.
//
//   safe <= put <= safe + size     written by the writer / by the loop
//
// A row carries the table's counter at its end: the table's rows become the writer's with the row that they belong to.
//
// Free-running, the loop rings once every half of what may be unsafe, and waits for `progress_` where it must. What the
// writer takes at once ends at the same rows however fast it is (but where another ring is full), for where a file
// has its chunks hangs on that: the same run is the same bytes. Paced, the loop makes no system call at all: the writer
// looks every 10 ms.
struct Recorder::Implementation {
  Implementation(const std::string& path, const Schema& schema, const RunHeader& header, const RecorderOptions& options)
      : options_(options),
        row_bytes_(schema.row_bytes()),
        table_row_bytes_(schema.table_row_bytes()),
        ring_(ring_rows(options, schema.row_bytes())),
        unsafe_max_(std::clamp<std::size_t>(options.frames_unflushed, 1, ring_)),
        batch_(std::max<std::size_t>(1, unsafe_max_ / 2)),
        rows_buffer_(ring_ * row_bytes_),
        ends_(ring_),
        events_buffer_(kEventRing),
        pairs_buffer_(kPairRing),
        path_(path),
        writer_(path, schema, header, options.frames_planned),
        awake_words_(writer_.awake_words()),
        awake_(ring_ * awake_words_),
        ever_awake_(awake_words_),
        zeroed_(schema.without_rest()) {
    if (table_row_bytes_ > 0) resize_table(std::max<std::size_t>(options.table_rows, ring_));
    thread_ = std::thread([this] { write_until_stopped(); });
  }

  ~Implementation() { stop(); }

  std::span<std::byte> begin_row(std::span<const std::size_t> awake) {
    VERISIM_ASSERT(!row_open_);
    VERISIM_ASSERT(thread_.joinable());
    wait_for_room();
    row_open_ = true;
    const std::size_t place = rows_.mine() % ring_;
    std::byte* row = &rows_buffer_[place * row_bytes_];
    for (const auto& [offset, bytes] : zeroed_) std::memset(row + offset, 0, bytes);
    if (awake_words_ == 0) return {row, row_bytes_};
    std::uint64_t* const words = &awake_[place * awake_words_];
    std::fill_n(words, awake_words_, 0);
    for (const std::size_t part : awake) {
      VERISIM_ASSERT(part / kPartsInWord < awake_words_);
      words[part / kPartsInWord] |= std::uint64_t{1} << part % kPartsInWord;
    }
    return {row, row_bytes_};
  }

  void add_table_rows(std::span<const std::byte> rows) {
    VERISIM_ASSERT(row_open_);
    if (rows.empty()) return;
    VERISIM_ASSERT(table_row_bytes_ > 0 && rows.size() % table_row_bytes_ == 0);
    const std::size_t count = rows.size() / table_row_bytes_;
    VERISIM_ASSERT(2 * count <= table_size_);  // so that the rows before are worth a flush if these find no room
    if (!fits(table_, table_size_, count)) refuse_to_fall_behind();
    const std::byte* from = rows.data();
    in_pieces(table_.mine(), table_.mine() + count, table_size_, [&](std::size_t place, std::size_t n) {
      std::memcpy(&table_buffer_[place * table_row_bytes_], from, n * table_row_bytes_);
      from += n * table_row_bytes_;
    });
    table_.put.store(table_.mine() + count, std::memory_order_release);
  }

  void end_row() {
    VERISIM_ASSERT(row_open_);
    row_open_ = false;
    ends_[rows_.mine() % ring_] = {table_.mine(), events_.mine(), pairs_.mine()};
    const std::uint64_t count = rows_.mine() + 1;
    rows_.put.store(count, std::memory_order_release);
    // The first row at once: from then on the file has its name.
    if (!options_.paced && (count == 1 || count % batch_ == 0)) ring_the_writer();
  }

  void make_room(std::size_t rows_in_a_frame) {
    VERISIM_ASSERT(!row_open_);
    if (table_row_bytes_ == 0) return;
    // As many frames as wait in the ring of rows, so that the table is no reason to flush more often.
    const std::size_t frames = options_.paced ? ring_ : unsafe_max_;
    const std::size_t wanted =
        std::max(2 * rows_in_a_frame, std::min(kRingBytes / table_row_bytes_, frames * rows_in_a_frame));
    if (wanted <= table_size_) return;
    wait_until([&] { return rows_.unsafe() == 0; }, true);
    resize_table(wanted);
  }

  void pair(BodyPair pair) {
    VERISIM_ASSERT(!row_open_);
    wait_until([&] { return pairs_.unsafe() < kPairRing; }, true);
    pairs_buffer_[pairs_.mine() % kPairRing] = pair;
    pairs_.put.store(pairs_.mine() + 1, std::memory_order_release);
  }

  void event(double time, std::string_view kind, std::string_view text) {
    VERISIM_ASSERT(std::isfinite(time));
    VERISIM_ASSERT(!kind.empty());
    if (!fits(events_, kEventRing, 1)) {
      ++events_lost_;
      return;
    }
    events_buffer_[events_.mine() % kEventRing] = stored_event(time, kind, text);
    last_event_time_ = time;
    events_.put.store(events_.mine() + 1, std::memory_order_release);
  }

  void close(const std::map<std::string, Attribute>& summary, const std::map<std::string, Attribute>& root) {
    VERISIM_ASSERT(!row_open_);
    VERISIM_ASSERT(thread_.joinable());
    stop();
    throw_if_failed();
    if (events_lost_ > 0) {
      const StoredEvent lost = stored_event(
          last_event_time_, kEventsLost, std::to_string(events_lost_) + " events came faster than the file took them");
      writer_.append(&lost, 1);
    }
    writer_.close(summary, root);
  }

 private:
  /// How many things the loop has put into a ring, and how many of them are safe.
  struct Counters {
    alignas(64) std::atomic<std::uint64_t> put{0};                                            ///< the loop writes it
    alignas(64) std::atomic<std::uint64_t> safe{0};                                           ///< the writer writes it
    [[nodiscard]] std::uint64_t mine() const { return put.load(std::memory_order_relaxed); }  ///< for the loop
    [[nodiscard]] std::uint64_t unsafe() const {
      return put.load(std::memory_order_acquire) - safe.load(std::memory_order_acquire);
    }
  };

  const RecorderOptions options_;
  const std::size_t row_bytes_, table_row_bytes_, ring_, unsafe_max_, batch_;
  std::size_t table_size_ = 0;           ///< changes only while the writer has nothing to do
  std::vector<std::byte> rows_buffer_;   //  (ring_, row_bytes_)
  std::vector<std::byte> table_buffer_;  //  (table_size_, table_row_bytes_)
  struct Ends {
    std::uint64_t table, events, pairs;  ///< the loop's counters when the row was put
  };
  std::vector<Ends> ends_;                  //  (ring_)
  std::vector<StoredEvent> events_buffer_;  //  (kEventRing)
  std::vector<BodyPair> pairs_buffer_;      //  (kPairRing)
  const std::string path_;
  RunWriter writer_;  ///< of the writer thread while that runs
  const std::size_t awake_words_;
  std::vector<std::uint64_t> awake_;       //  (ring_, awake_words_)
  std::vector<std::uint64_t> ever_awake_;  ///< the writer's
  const std::vector<ByteRange> zeroed_;    ///< of a row: what no part at rest has
  std::string failure_;                    ///< written before failed_ is set
  Counters rows_, table_, events_, pairs_;
  // The loop's.
  alignas(64) std::atomic<std::uint32_t> bell_{0};  ///< the writer sleeps on it
  std::atomic<bool> stopping_{false};
  std::atomic<bool> hurry_{false};  ///< whatever waits is to be written
  bool row_open_ = false;
  std::uint64_t events_lost_ = 0;
  double last_event_time_ = 0;
  // The writer's.
  alignas(64) std::atomic<std::uint32_t> progress_{0};  ///< the loop sleeps on it
  std::atomic<bool> failed_{false};
  std::thread thread_;

  void resize_table(std::size_t rows) {
    table_size_ = std::bit_ceil(rows);
    table_buffer_.assign(table_size_ * table_row_bytes_, std::byte{0});
  }

  void ring_the_writer() {
    bell_.fetch_add(1, std::memory_order_release);
    bell_.notify_one();
  }

  void throw_if_failed() const {
    if (failed_.load(std::memory_order_acquire)) throw Error(ErrorKind::io, failure_);
  }

  [[noreturn]] void refuse_to_fall_behind() const {
    fail(ErrorKind::io,
         "{}: the disk is {} frames behind the paced loop; choose a faster one, or run without --realtime", path_,
         rows_.unsafe());
  }

  /// Sleeps until the writer has made it true.
  template <typename Condition>
  void wait_until(Condition condition, bool hurry) {
    for (;;) {
      const std::uint32_t seen = progress_.load(std::memory_order_acquire);
      throw_if_failed();
      if (condition()) break;
      hurry_.store(hurry, std::memory_order_release);
      ring_the_writer();
      progress_.wait(seen, std::memory_order_acquire);
    }
    hurry_.store(false, std::memory_order_release);
  }

  // Two more than the rows in the ring are lost with a kill: the one about to be filled, and the frame that the loop
  // computes after it.
  void wait_for_room() {
    const std::uint64_t waiting_max = options_.paced ? ring_ - 1 : std::max<std::size_t>(unsafe_max_, 2) - 2;
    const auto has_room = [&] { return rows_.unsafe() <= waiting_max; };
    if (!options_.paced) return wait_until(has_room, false);
    throw_if_failed();
    if (!has_room()) refuse_to_fall_behind();
  }

  // Free-running, the loop waits for room: what a file holds must not depend on the disk.
  bool fits(const Counters& ring, std::size_t size, std::size_t count) {
    const auto has_room = [&] { return ring.unsafe() + count <= size; };
    if (!options_.paced) wait_until(has_room, true);
    throw_if_failed();
    return has_room();
  }

  void stop() {
    if (!thread_.joinable()) return;
    stopping_.store(true, std::memory_order_release);
    ring_the_writer();
    thread_.join();
  }

  // ---- the writer thread ----

  void write_until_stopped() {
    try {
      for (;;) {
        const std::uint32_t seen = bell_.load(std::memory_order_acquire);
        const bool stopping = stopping_.load(std::memory_order_acquire);
        const bool wrote = (stopping || worth_a_flush()) && write_waiting();
        if (stopping && !wrote) return;
        if (stopping || (wrote && !options_.paced)) continue;
        if (options_.paced) {
          std::this_thread::sleep_for(kNap);
        } else {
          bell_.wait(seen, std::memory_order_acquire);
        }
      }
    } catch (const std::exception& e) {
      failure_ = e.what();
      failed_.store(true, std::memory_order_release);
      tell_progress();
    }
  }

  /// Where what the writer takes at once ends, free-running: behind the first row, then behind whole batches.
  [[nodiscard]] std::uint64_t end_of_batch(std::uint64_t from) const {
    return from == 0 ? 1 : (from / batch_ + 1) * batch_;
  }

  // A flush costs the same for one row as for fifty.
  [[nodiscard]] bool worth_a_flush() const {
    const bool batch_is_there =
        rows_.put.load(std::memory_order_acquire) >= end_of_batch(rows_.safe.load(std::memory_order_relaxed));
    return options_.paced || hurry_.load(std::memory_order_acquire) || batch_is_there;
  }

  // Writes and flushes what waits, at most a batch, or paced kRowsAtOnce rows. False if there was nothing.
  bool write_waiting() {
    const std::uint64_t rows_from = rows_.safe.load(std::memory_order_relaxed);
    const std::uint64_t rows_put = rows_.put.load(std::memory_order_acquire);
    const std::uint64_t batch_to = options_.paced ? rows_from + kRowsAtOnce : end_of_batch(rows_from);
    const std::uint64_t rows_to = std::min(rows_put, batch_to);
    const bool is_batch = !options_.paced && rows_to == batch_to;
    const std::uint64_t table_from = table_.safe.load(std::memory_order_relaxed);
    const std::uint64_t table_to = rows_to > rows_from ? ends_[(rows_to - 1) % ring_].table : table_from;
    const std::uint64_t events_from = events_.safe.load(std::memory_order_relaxed);
    const std::uint64_t events_to = is_batch ? std::max(events_from, ends_[(rows_to - 1) % ring_].events)
                                             : events_.put.load(std::memory_order_acquire);
    const std::uint64_t pairs_from = pairs_.safe.load(std::memory_order_relaxed);
    const std::uint64_t pairs_to = is_batch ? std::max(pairs_from, ends_[(rows_to - 1) % ring_].pairs)
                                            : pairs_.put.load(std::memory_order_acquire);
    if (rows_from == rows_to && events_from == events_to && pairs_from == pairs_to) return false;
    writer_.reserve({rows_to - rows_from, table_to - table_from, events_to - events_from, pairs_to - pairs_from,
                     count_awake(rows_from, rows_to)});
    in_pieces(pairs_from, pairs_to, kPairRing,
              [&](std::size_t place, std::size_t count) { writer_.append(&pairs_buffer_[place], count); });
    in_pieces(table_from, table_to, table_size_, [&](std::size_t place, std::size_t count) {
      writer_.append_to_table(&table_buffer_[place * table_row_bytes_], count);
    });
    in_pieces(rows_from, rows_to, ring_, [&](std::size_t place, std::size_t count) {
      writer_.append(&rows_buffer_[place * row_bytes_], awake_.data() + place * awake_words_, count);
    });
    in_pieces(events_from, events_to, kEventRing,
              [&](std::size_t place, std::size_t count) { writer_.append(&events_buffer_[place], count); });
    writer_.flush();
    table_.safe.store(table_to, std::memory_order_release);
    events_.safe.store(events_to, std::memory_order_release);
    pairs_.safe.store(pairs_to, std::memory_order_release);
    rows_.safe.store(rows_to, std::memory_order_release);
    tell_progress();
    return true;
  }

  /// Parts that are so in any of the rows.
  std::size_t count_awake(std::uint64_t from, std::uint64_t to) {
    std::fill(ever_awake_.begin(), ever_awake_.end(), 0);
    in_pieces(from, to, ring_, [&](std::size_t place, std::size_t count) {
      for (std::size_t i = 0; i < count * awake_words_; ++i)
        ever_awake_[i % awake_words_] |= awake_[place * awake_words_ + i];
    });
    std::size_t parts = 0;
    for (const std::uint64_t word : ever_awake_) parts += static_cast<std::size_t>(std::popcount(word));
    return parts;
  }

  // A stretch of a ring is at most two stretches of memory.
  template <typename Write>
  static void in_pieces(std::uint64_t from, std::uint64_t to, std::size_t size, Write write) {
    while (from < to) {
      const std::size_t place = from % size;
      const std::size_t count = std::min<std::size_t>(to - from, size - place);
      write(place, count);
      from += count;
    }
  }

  void tell_progress() {
    progress_.fetch_add(1, std::memory_order_release);
    progress_.notify_one();
  }
};

Recorder::Recorder(const std::string& path, const Schema& schema, const RunHeader& header,
                   const RecorderOptions& options)
    : implementation_(std::make_unique<Implementation>(path, schema, header, options)) {}
Recorder::~Recorder() = default;

std::span<std::byte> Recorder::begin_row(std::span<const std::size_t> awake) {
  return implementation_->begin_row(awake);
}
void Recorder::add_table_rows(std::span<const std::byte> rows) {
  implementation_->add_table_rows(rows);
}
void Recorder::end_row() {
  implementation_->end_row();
}
void Recorder::make_room(std::size_t table_rows_in_a_frame) {
  implementation_->make_room(table_rows_in_a_frame);
}
void Recorder::pair(BodyPair pair) {
  implementation_->pair(pair);
}
void Recorder::event(double time, std::string_view kind, std::string_view text) {
  implementation_->event(time, kind, text);
}
void Recorder::close(const std::map<std::string, Attribute>& summary, const std::map<std::string, Attribute>& root) {
  implementation_->close(summary, root);
}

}  // namespace verisim
