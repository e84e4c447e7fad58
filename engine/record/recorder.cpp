#include <algorithm>
#include <atomic>
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
constexpr std::size_t kRowsAtOnce = 512;  // a backlog is written in pieces, so that each soon is safe
constexpr auto kNap = std::chrono::milliseconds(10);

// The longest beginning of `text` that fits and does not end inside a UTF-8 character.
std::size_t fitting_length(std::string_view text, std::size_t room) {
  if (text.size() <= room) return text.size();
  std::size_t length = room;
  while (length > 0 && (static_cast<unsigned char>(text[length]) & 0xC0) == 0x80) --length;
  return length;
}

template <std::size_t N>
void store(char (&to)[N], std::string_view text) {
  std::memcpy(to, text.data(), fitting_length(text, N - 1));
}

std::size_t ring_rows(const RecorderOptions& options) {
  constexpr std::size_t kEightSeconds = 8192;  // at 1000 Hz
  if (options.ring_rows > 0) return options.ring_rows;
  return options.paced ? kEightSeconds : std::max<std::size_t>(256, options.frames_unflushed);
}

}  // namespace

// A ring of rows and one of events between one producer (the loop) and one consumer (the writer thread). Each counter
// is written by one side only and never decreases; index = counter mod size.
//
//   safe_rows_ <= rows_ <= safe_rows_ + ring     written by the writer / by the loop
//
// Free-running, the loop rings once every half of what may be unsafe, and waits for `progress_` where it must. Paced,
// it makes no system call at all: the writer looks every 10 ms.
struct Recorder::Implementation {
  Implementation(const std::string& path, const Schema& schema, const RunHeader& header, const RecorderOptions& options)
      : options_(options),
        row_bytes_(schema.row_bytes()),
        ring_(ring_rows(options)),
        unsafe_max_(std::clamp<std::size_t>(options.frames_unflushed, 1, ring_)),
        batch_(std::max<std::size_t>(1, unsafe_max_ / 2)),
        rows_buffer_(ring_ * row_bytes_),
        events_buffer_(kEventRing),
        path_(path),
        writer_(path, schema, header) {
    thread_ = std::thread([this] { write_until_stopped(); });
  }

  ~Implementation() { stop(); }

  std::span<std::byte> begin_row() {
    VERISIM_ASSERT(!row_open_);
    VERISIM_ASSERT(thread_.joinable());
    wait_for_room();
    row_open_ = true;
    std::byte* row = &rows_buffer_[(rows_.load(std::memory_order_relaxed) % ring_) * row_bytes_];
    std::memset(row, 0, row_bytes_);
    return {row, row_bytes_};
  }

  void end_row() {
    VERISIM_ASSERT(row_open_);
    row_open_ = false;
    const std::uint64_t count = rows_.load(std::memory_order_relaxed) + 1;
    rows_.store(count, std::memory_order_release);
    // The first row at once: from then on the file has its name.
    if (!options_.paced && (count == 1 || count % batch_ == 0)) ring_the_writer();
  }

  void event(double time, std::string_view kind, std::string_view text) {
    VERISIM_ASSERT(std::isfinite(time));
    VERISIM_ASSERT(!kind.empty());
    if (!event_fits()) {
      ++events_lost_;
      return;
    }
    const std::uint64_t count = events_.load(std::memory_order_relaxed);
    StoredEvent& place = events_buffer_[count % kEventRing];
    place = StoredEvent{};
    place.time = time;
    store(place.kind, kind);
    store(place.text, text);
    last_event_time_ = time;
    events_.store(count + 1, std::memory_order_release);
  }

  void close(const std::map<std::string, Attribute>& summary, const std::map<std::string, Attribute>& root) {
    VERISIM_ASSERT(!row_open_);
    VERISIM_ASSERT(thread_.joinable());
    stop();
    throw_if_failed();
    if (events_lost_ > 0) {
      StoredEvent lost;
      lost.time = last_event_time_;
      store(lost.kind, "events lost");
      store(lost.text, std::to_string(events_lost_) + " events came faster than the file took them");
      writer_.append(&lost, 1);
    }
    writer_.close(summary, root);
  }

 private:
  const RecorderOptions options_;
  const std::size_t row_bytes_, ring_, unsafe_max_, batch_;
  std::vector<std::byte> rows_buffer_;      //  (ring_, row_bytes_)
  std::vector<StoredEvent> events_buffer_;  //  (kEventRing)
  const std::string path_;
  RunWriter writer_;     ///< of the writer thread while that runs
  std::string failure_;  ///< written before failed_ is set
  // The loop's: what it has put into the rings.
  alignas(64) std::atomic<std::uint64_t> rows_{0};
  std::atomic<std::uint64_t> events_{0};
  std::atomic<std::uint32_t> bell_{0};  ///< the writer sleeps on it
  std::atomic<bool> stopping_{false};
  bool row_open_ = false;
  std::uint64_t events_lost_ = 0;
  double last_event_time_ = 0;
  // The writer's: what is safe.
  alignas(64) std::atomic<std::uint64_t> safe_rows_{0};
  std::atomic<std::uint64_t> safe_events_{0};
  std::atomic<std::uint32_t> progress_{0};  ///< the loop sleeps on it
  std::atomic<bool> failed_{false};
  std::thread thread_;

  void ring_the_writer() {
    bell_.fetch_add(1, std::memory_order_release);
    bell_.notify_one();
  }

  void throw_if_failed() const {
    if (failed_.load(std::memory_order_acquire)) throw Error(ErrorKind::io, failure_);
  }

  // Two more than the rows in the ring are lost with a kill: the one about to be filled, and the frame that the loop
  // computes after it.
  void wait_for_room() {
    const std::uint64_t waiting_max = options_.paced ? ring_ - 1 : std::max<std::size_t>(unsafe_max_, 2) - 2;
    for (;;) {
      const std::uint32_t seen = progress_.load(std::memory_order_acquire);
      throw_if_failed();
      if (rows_.load(std::memory_order_relaxed) - safe_rows_.load(std::memory_order_acquire) <= waiting_max) return;
      if (options_.paced) {
        fail(ErrorKind::io,
             "{}: the disk is {} frames behind the paced loop; choose a faster one, or run without --realtime", path_,
             ring_);
      }
      ring_the_writer();
      progress_.wait(seen, std::memory_order_acquire);
    }
  }

  // Free-running, the loop waits: which events a file holds must not depend on the disk.
  bool event_fits() {
    for (;;) {
      const std::uint32_t seen = progress_.load(std::memory_order_acquire);
      throw_if_failed();
      if (events_.load(std::memory_order_relaxed) - safe_events_.load(std::memory_order_acquire) < kEventRing)
        return true;
      if (options_.paced) return false;
      ring_the_writer();
      progress_.wait(seen, std::memory_order_acquire);
    }
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

  // A flush costs the same for one row as for fifty.
  bool worth_a_flush() const {
    const std::uint64_t safe = safe_rows_.load(std::memory_order_relaxed);
    const std::uint64_t waiting = rows_.load(std::memory_order_acquire) - safe;
    const std::uint64_t events = events_.load(std::memory_order_acquire) - safe_events_.load(std::memory_order_relaxed);
    return options_.paced || waiting >= batch_ || (safe == 0 && waiting > 0) || events >= kEventRing / 2;
  }

  // Writes and flushes the waiting rows, at most kRowsAtOnce. False if there were none.
  bool write_waiting() {
    const std::uint64_t rows_from = safe_rows_.load(std::memory_order_relaxed);
    const std::uint64_t rows_to = std::min(rows_.load(std::memory_order_acquire), rows_from + kRowsAtOnce);
    const std::uint64_t events_from = safe_events_.load(std::memory_order_relaxed);
    const std::uint64_t events_to = events_.load(std::memory_order_acquire);
    if (rows_from == rows_to && events_from == events_to) return false;
    writer_.reserve(rows_to - rows_from, events_to - events_from);
    in_pieces(rows_from, rows_to, ring_,
              [&](std::size_t place, std::size_t count) { writer_.append(&rows_buffer_[place * row_bytes_], count); });
    in_pieces(events_from, events_to, kEventRing,
              [&](std::size_t place, std::size_t count) { writer_.append(&events_buffer_[place], count); });
    writer_.flush();
    safe_rows_.store(rows_to, std::memory_order_release);
    safe_events_.store(events_to, std::memory_order_release);
    tell_progress();
    return true;
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

std::span<std::byte> Recorder::begin_row() {
  return implementation_->begin_row();
}
void Recorder::end_row() {
  implementation_->end_row();
}
void Recorder::event(double time, std::string_view kind, std::string_view text) {
  implementation_->event(time, kind, text);
}
void Recorder::close(const std::map<std::string, Attribute>& summary, const std::map<std::string, Attribute>& root) {
  implementation_->close(summary, root);
}

}  // namespace verisim
