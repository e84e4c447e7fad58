#include "engine/robot/serial_line.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"

namespace verisim::robot {

namespace {

constexpr std::uint64_t kBit = 16'000'000;  // one bit of the sender, in units
constexpr std::uint64_t kByte = 10 * kBit;

const SerialLineSettings& checked(const SerialLineSettings& s, std::string_view name) {
  const auto refuse = [name](const char* what, double is, const char* range) {
    fail(ErrorKind::input, "serial line '{}': {} is {} but must be {}", name, what, is, range);
  };
  for (const std::uint32_t baud : {s.baud, s.receiver_baud})
    if (baud < 1200 || baud > 2'000'000) refuse("baud", baud, "from 1200 to 2000000; 115200 is usual");
  if (!(s.latency >= 0 && s.latency <= 1)) refuse("latency", s.latency, "from 0 to 1 s");
  if (!is_fraction(s.loss)) refuse("loss", s.loss, "from 0 to 1, a fraction of the bytes");
  if (!is_fraction(s.corruption)) refuse("corruption", s.corruption, "from 0 to 1, a fraction of the bits");
  if (s.buffer < 1 || s.buffer > 65'536) refuse("buffer", s.buffer, "from 1 to 65536 bytes");
  return s;
}

}  // namespace

SerialLine::SerialLine(const SerialLineSettings& settings, std::uint64_t seed, std::string_view name)
    : settings_(checked(settings, name)),
      losses_(seed, std::string(name) + "/loss"),
      flips_(seed, std::string(name) + "/corruption"),
      unit_per_cycle_(settings.baud),
      latency_(static_cast<std::uint64_t>(std::llround(settings.latency * 16e6)) * settings.baud),
      half_bit_(kBit * settings.baud / (2 * std::uint64_t{settings.receiver_baud})) {
  // Bytes at once in the ring: buffered, in the latency, of this millisecond, and under one byte of the receiver.
  const std::uint64_t under_way = (latency_ + firmware::kCyclesPerMs * unit_per_cycle_ + 20 * half_bit_) / kByte;
  wave_.resize(std::bit_ceil(settings.buffer + under_way + 4));
  received_.reserve(settings.receiver_baud / 9000 + 4);
}

void SerialLine::send(std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t value : bytes) put(now_, value);
}

void SerialLine::send(std::span<const TimedByte> bytes) {
  for (const TimedByte& byte : bytes) put(now_ + byte.cycle * unit_per_cycle_, byte.value);
}

void SerialLine::put(std::uint64_t at, std::uint8_t value) {
  const std::uint64_t number = counts_.sent++;
  const std::uint64_t held = free_ > at ? (free_ - at + kByte - 1) / kByte : 0;
  if (held >= settings_.buffer) {
    ++counts_.overflowed;
    return;
  }
  const std::uint64_t start = std::max(free_, at);
  free_ = start + kByte;
  if (!is_plugged_ || losses_.uniform(number) < settings_.loss) {
    ++counts_.lost;  // its time on the wire passes in silence
    return;
  }
  const std::uint32_t whole = (std::uint32_t{value} << 1) | 0x200;
  std::uint32_t bits = whole;
  if (settings_.corruption > 0)
    for (std::uint32_t i = 0; i < 10; ++i)
      if (flips_.uniform(10 * number + i) < settings_.corruption) bits ^= 1U << i;
  if (bits != whole) ++counts_.damaged;
  VERISIM_ASSERT(count_ < wave_.size());
  wave_[(first_ + count_++) & (wave_.size() - 1)] = {start + latency_, bits};
}

void SerialLine::pop() {
  passed_until_ = sent(0).start + kByte;
  passed_low_ = (sent(0).bits & 0x200) == 0;
  first_ = (first_ + 1) & (wave_.size() - 1);
  --count_;
}

/// Where the level falls next, not before listen_.
bool SerialLine::find_edge(std::uint64_t& edge) const {
  bool is_low = passed_low_;
  std::uint64_t until = passed_until_;
  for (std::size_t i = 0; i < count_; ++i) {
    const auto& [start, bits] = sent(i);
    if (start > until) is_low = false;  // an idle wire is high
    until = start + kByte;
    for (std::uint32_t k = 0; k < 10; ++k) {
      const std::uint64_t at = start + k * kBit;
      const bool was_low = is_low;
      is_low = ((bits >> k) & 1) == 0;
      if (at < listen_ || was_low || !is_low) continue;
      edge = at;
      return true;
    }
  }
  return false;
}

bool SerialLine::level(std::uint64_t at) const {
  for (std::size_t i = 0; i < count_; ++i) {
    const auto& [start, bits] = sent(i);
    if (at < start) return true;
    if (at < start + kByte) return ((bits >> ((at - start) / kBit)) & 1) != 0;
  }
  return true;
}

/// The receiver's UART, up to the end of one byte; false if that is not before the horizon.
bool SerialLine::take_byte(std::uint64_t horizon) {
  std::uint64_t edge = 0;
  const bool is_edge = find_edge(edge);
  if (!is_edge) listen_ = std::max(listen_, horizon);
  while (count_ > 0 && sent(0).start + kByte <= listen_) pop();
  if (!is_edge) return false;
  if (edge + 19 * half_bit_ >= horizon) return false;
  if (level(edge + half_bit_)) {  // no start bit: the line was low for less than half a bit of the receiver's
    ++counts_.framing_errors;
    listen_ = edge + half_bit_;
    return true;
  }
  std::uint32_t value = 0;
  for (std::uint32_t k = 0; k < 8; ++k) value |= std::uint32_t{level(edge + (2 * k + 3) * half_bit_)} << k;
  listen_ = edge + 19 * half_bit_;
  if (!level(listen_)) {
    ++counts_.framing_errors;
    return true;
  }
  ++counts_.received;
  received_.push_back(
      {static_cast<std::uint32_t>((listen_ - now_) / unit_per_cycle_), static_cast<std::uint8_t>(value)});
  return true;
}

std::span<const TimedByte> SerialLine::advance() {
  received_.clear();
  const std::uint64_t horizon = now_ + firmware::kCyclesPerMs * unit_per_cycle_;
  while (take_byte(horizon)) {
  }
  now_ = horizon;
  const std::uint64_t losses = counts_.overflowed + counts_.lost + counts_.framing_errors;
  losing_.see(losses > losses_seen_, ++millisecond_);
  losses_seen_ = losses;
  return received_;
}

}  // namespace verisim::robot
