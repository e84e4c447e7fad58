// The firmware as plain functions. Time passes for edges, bytes and the transmitter; the code itself takes none.
#include <cassert>
#include <optional>

#include "firmware_sim/board.hpp"
#include "firmware_sim/firmware/firmware.hpp"

namespace verisim::firmware {
namespace {

/// The controller's transmitter: a byte that is being shifted out and one that waits behind it.
class Transmitter {
 public:
  /// The firmware has looked whether there is something to send, as it does once a millisecond.
  void wake(Firmware& firmware) {
    refill(firmware);
    if (!shifted_ && waiting_) shift(firmware, 0);
  }

  /// Sends for a millisecond; gives how many bytes left.
  std::size_t run(Firmware& firmware, std::span<TimedByte> sent) {
    std::size_t count = 0;
    while (shifted_ && end_ < kCyclesPerMs) {
      sent[count++] = {end_, *shifted_};
      shifted_.reset();
      if (waiting_) shift(firmware, end_);
    }
    if (shifted_) end_ -= kCyclesPerMs;
    return count;
  }

 private:
  void refill(Firmware& firmware) {
    std::uint8_t byte = 0;
    if (!waiting_ && firmware.next_byte(byte)) waiting_ = byte;
  }

  void shift(Firmware& firmware, std::uint32_t begin) {
    shifted_ = waiting_;
    waiting_.reset();
    end_ = begin + kCyclesPerByte;
    refill(firmware);
  }

  std::optional<std::uint8_t> shifted_, waiting_;
  std::uint32_t end_ = 0;  ///< when the shifted byte has left
};

/// What the reset button clears.
struct Memory {
  Encoder encoders[kWheels];
  Firmware firmware{encoders};
  Transmitter transmitter;
  bool timer_has_run = false;  ///< the first tick comes a millisecond after the start
};

class HostBoard final : public Board {
 public:
  HostBoard() { boot(); }

  const char* described() const override { return "host: the firmware as plain functions"; }

  void advance(std::span<const EncoderEdge> edges, std::span<const TimedByte> in) override {
    sent_count_ = 0;
    if (memory_) run(edges, in);
    for (const EncoderEdge& edge : edges) levels_[edge.wheel] = edge.levels;
  }

  std::span<const TimedByte> sent() const override { return {sent_.data(), sent_count_}; }
  const std::array<std::int16_t, 4>& duty() const override { return duty_; }
  const BoardLoad& load() const override { return load_; }

  void reset() override {
    if (memory_) boot();
  }

  void set_powered(bool on) override {
    if (on == memory_.has_value()) return;
    if (on)
      boot();
    else
      memory_.reset();
    duty_ = {};
  }

 private:
  void boot() {
    memory_.emplace();
    for (std::size_t wheel = 0; wheel < kWheels; ++wheel) memory_->encoders[wheel].levels = levels_[wheel];
    duty_ = {};
    sent_count_ = 0;
    since_sample_ms_ = 0;
    has_sampled_ = false;
  }

  void run(std::span<const EncoderEdge> edges, std::span<const TimedByte> in) {
    Firmware& firmware = memory_->firmware;
    if (memory_->timer_has_run) begin_millisecond(firmware);
    memory_->timer_has_run = true;
    for (const EncoderEdge& edge : edges) {
      assert(edge.wheel < kWheels && edge.cycle < kCyclesPerMs);
      Encoder& encoder = memory_->encoders[edge.wheel];
      const std::uint16_t illegal = encoder.illegal;
      encoder.edge(edge.levels, firmware.now_ms(), static_cast<std::uint8_t>(edge.cycle * kTicksPerMs / kCyclesPerMs));
      if (encoder.illegal != illegal) load_.edges_lost += 2;
    }
    load_.edges_seen += edges.size();
    for (const TimedByte& byte : in)
      if (!firmware.byte_arrived(byte.value)) ++load_.bytes_lost;
    sent_count_ = memory_->transmitter.run(firmware, sent_);
    load_.cycles += kCyclesPerMs;
  }

  void begin_millisecond(Firmware& firmware) {
    firmware.tick();
    memory_->transmitter.wake(firmware);
    ++since_sample_ms_;
    for (std::size_t wheel = 0; wheel < kWheels; ++wheel) duty_[wheel] = firmware.duty()[wheel];
    const bool is_sample = firmware.work();
    firmware.report();
    if (!is_sample) return;
    const std::uint32_t period = since_sample_ms_ * kCyclesPerMs;
    if (has_sampled_) load_.control_period_min = load_.control_period_max = period;
    has_sampled_ = true;
    since_sample_ms_ = 0;
  }

  std::optional<Memory> memory_;  ///< none while it is off
  std::array<std::uint8_t, kWheels> levels_{};
  std::array<TimedByte, kCyclesPerMs / kCyclesPerByte + 1> sent_{};
  std::size_t sent_count_ = 0;
  std::array<std::int16_t, 4> duty_{};
  BoardLoad load_;
  std::uint32_t since_sample_ms_ = 0;
  bool has_sampled_ = false;
};

}  // namespace

std::unique_ptr<Board> make_host_board() {
  return std::make_unique<HostBoard>();
}

}  // namespace verisim::firmware
