// firmware_sim/protocol/frame.hpp
// Frames of the serial line: SOH id STX payload ETX [checksum] EOT, byte for byte as the published tuple-transmission
// (revision 84ee1a5, 2012-12-05) sends and accepts them. Checksum: sum modulo 256 of all bytes before it. int16 and
// float32 little-endian, the bits of a float unchanged (NaN passes). C++14 without standard library, and C++20.
// No allocation; a receiver holds three longest frames, as the original does.
#pragma once

#include "firmware_sim/protocol/table.hpp"

namespace verisim {
namespace protocol {

constexpr uint8_t kSoh = 0x01, kStx = 0x02, kEtx = 0x03, kEot = 0x04;

struct FieldWriter {
  uint8_t* at;
  void operator()(int16_t field) { little_endian(static_cast<uint16_t>(field), 2); }
  void operator()(const float& field) {  // by reference: a copy in a register of the 387 would quieten a NaN
    uint32_t bits;
    static_assert(sizeof bits == sizeof field, "float32");
    __builtin_memcpy(&bits, &field, sizeof bits);
    little_endian(bits, 4);
  }
  void little_endian(uint32_t bits, uint8_t bytes) {
    for (; bytes > 0; --bytes, bits >>= 8) *at++ = static_cast<uint8_t>(bits);
  }
};

struct FieldReader {
  const uint8_t* at;
  void operator()(int16_t& field) {
    const auto bits = static_cast<uint16_t>(little_endian(2));
    __builtin_memcpy(&field, &bits, sizeof field);
  }
  void operator()(float& field) {
    const uint32_t bits = little_endian(4);
    __builtin_memcpy(&field, &bits, sizeof field);
  }
  uint32_t little_endian(uint8_t bytes) {
    uint32_t bits = 0;
    for (uint8_t i = 0; i < bytes; ++i) bits |= static_cast<uint32_t>(*at++) << (8 * i);
    return bits;
  }
};

inline uint8_t checksum(const uint8_t* bytes, uint8_t count) {
  uint8_t sum = 0;
  for (uint8_t i = 0; i < count; ++i) sum = static_cast<uint8_t>(sum + bytes[i]);
  return sum;
}

/// Writes the frame of `message` and gives its length: encode<ComputerToRobot>(StartControl{}, buffer).
/// @pre `buffer` holds longest_frame<Named>() bytes, or at least this message's frame
template <typename Named, typename Message>
uint8_t encode(const Message& message, uint8_t* buffer) {
  constexpr uint8_t id = id_of<Named, Message>();
  static_assert(id != 255, "a message of this collection");
  buffer[0] = kSoh;
  buffer[1] = id;
  buffer[2] = kStx;
  FieldWriter writer{buffer + 3};
  Message::visit(message, writer);
  *writer.at++ = kEtx;
  if (Named::envelope == Envelope::basic_checksum) {
    const uint8_t sum = checksum(buffer, static_cast<uint8_t>(writer.at - buffer));
    *writer.at++ = sum;
  }
  *writer.at++ = kEot;
  return static_cast<uint8_t>(writer.at - buffer);
}

/// What a receiver has met since it was made.
struct Received {
  uint32_t accepted = 0;   ///< frames handed over
  uint32_t rejected = 0;   ///< SOH that began no frame: wrong id, STX, ETX, EOT or checksum. One byte each
  uint32_t discarded = 0;  ///< bytes that were skipped because they were no SOH
};

/// Finds frames in a stream of bytes. What it calls depends on the stream alone, not on how it is cut into pieces.
/// There is no timeout: a truncated frame holds back what follows until the length that it announced is there.
template <typename Named>
class Receiver {
 public:
  static constexpr uint8_t kCapacity = 3 * longest_frame<Named>();

  /// Takes what fits and says how much that was. After process() two longest frames always fit.
  uint8_t append(const uint8_t* bytes, uint8_t count) {
    const auto space = static_cast<uint8_t>(kCapacity - buffered_);
    const uint8_t taken = count < space ? count : space;
    if (taken > 0) __builtin_memcpy(buffer_ + buffered_, bytes, taken);  // nothing may stand at a null pointer
    buffered_ = static_cast<uint8_t>(buffered_ + taken);
    return taken;
  }

  /// Calls `handler(message)` for each complete frame in the order of the stream; gives how many there were.
  template <typename Handler>
  uint8_t process(Handler&& handler) {
    uint8_t front = 0;
    uint8_t calls = 0;
    for (Step step = Step::reject; step != Step::wait;) {
      step = step_at(front);
      if (step == Step::reject) ++front;
      if (step == Step::accept) {
        front = static_cast<uint8_t>(front + deliver(buffer_ + front, handler));
        ++calls;
      }
    }
    buffered_ = static_cast<uint8_t>(buffered_ - front);
    if (front > 0) __builtin_memmove(buffer_, buffer_ + front, buffered_);
    return calls;
  }

  /// Appends and processes a piece of any length.
  template <typename Handler>
  void feed(const uint8_t* bytes, uint32_t count, Handler&& handler) {
    while (count > 0) {
      const uint8_t taken = append(bytes, count < kCapacity ? static_cast<uint8_t>(count) : kCapacity);
      bytes += taken;
      count -= taken;
      (void)process(handler);
    }
  }

  uint8_t buffered() const { return buffered_; }  ///< bytes that wait for others
  const Received& received() const { return received_; }

 private:
  enum class Step : uint8_t { wait, reject, accept };

  /// The published rule, once. Moves `front` to the next SOH; `reject` and `accept` speak of what begins there.
  Step step_at(uint8_t& front) {
    while (front < buffered_ && buffer_[front] != kSoh) {
      ++front;
      ++received_.discarded;
    }
    const uint8_t* frame = buffer_ + front;
    const auto there = static_cast<uint8_t>(buffered_ - front);
    if (there < 2) return Step::wait;
    const uint8_t length = frame_length_of<Named>(frame[1]);
    if (length == 0) return reject();
    if (there < 3) return Step::wait;
    if (frame[2] != kStx) return reject();
    if (there < length) return Step::wait;
    const bool has_sum = Named::envelope == Envelope::basic_checksum;
    const auto end = static_cast<uint8_t>(length - (has_sum ? 3 : 2));  // where ETX stands
    if (frame[end] != kEtx || frame[length - 1] != kEot) return reject();
    if (has_sum && checksum(frame, static_cast<uint8_t>(end + 1)) != frame[end + 1]) return reject();
    ++received_.accepted;
    return Step::accept;
  }

  Step reject() {
    ++received_.rejected;
    return Step::reject;
  }

  template <typename Handler>
  struct Deliver {
    const uint8_t* frame;
    Handler& handler;
    uint8_t length;
    template <typename Message>
    bool operator()(uint8_t id, const Message& /*message*/) {
      if (id != frame[1]) return false;
      Message message{};
      FieldReader reader{frame + 3};
      Message::visit(message, reader);
      length = frame_length<Message>(Named::envelope);
      handler(static_cast<const Message&>(message));
      return true;
    }
  };

  template <typename Handler>
  static uint8_t deliver(const uint8_t* frame, Handler& handler) {
    Deliver<Handler> ask{frame, handler, 0};
    (void)find_message<Named>(ask);
    return ask.length;
  }

  uint8_t buffer_[kCapacity];
  uint8_t buffered_ = 0;
  Received received_;
};

template <typename Named>
constexpr uint8_t Receiver<Named>::kCapacity;

}  // namespace protocol
}  // namespace verisim
