// firmware_sim/protocol/table.hpp
// Questions that the compiler answers about the table of messages: ids, lengths, the message behind an id.
// C++14 without standard library, and C++20. Nothing here stays in a program but the numbers it gives.
#pragma once

#include "firmware_sim/protocol/messages.hpp"

namespace verisim {
namespace protocol {

struct PayloadLength {
  uint8_t bytes = 0;
  template <typename Field>
  constexpr void operator()(const Field& /*field*/) {
    static_assert(sizeof(Field) == 2 || sizeof(Field) == 4, "int16 and float32 travel");
    bytes = static_cast<uint8_t>(bytes + sizeof(Field));
  }
};

/// Bytes of a frame around its payload: SOH, id, STX, ETX, EOT, and the checksum if there is one.
constexpr uint8_t envelope_length(Envelope envelope) {
  return envelope == Envelope::basic_checksum ? 6 : 5;
}

template <typename Message>
constexpr uint8_t frame_length(Envelope envelope) {
  Message message{};
  PayloadLength length;
  Message::visit(message, length);
  return static_cast<uint8_t>(envelope_length(envelope) + length.bytes);
}

/// The list of messages of a collection, one by one. `ask(id, Message{})` until one says true; whether one did.
template <Envelope kind, typename Ask>
constexpr bool find_message(const Collection<kind>* /*list*/, Ask& /*ask*/, uint8_t /*first_id*/ = 0) {
  return false;
}

template <Envelope kind, typename First, typename... Rest, typename Ask>
constexpr bool find_message(const Collection<kind, First, Rest...>* /*list*/, Ask& ask, uint8_t first_id = 0) {
  return ask(first_id, First{}) ||
         find_message(static_cast<const Collection<kind, Rest...>*>(nullptr), ask, static_cast<uint8_t>(first_id + 1));
}

/// As above, by the collection's name: find_message<ComputerToRobot>(ask).
template <typename Named, typename Ask>
constexpr bool find_message(Ask& ask) {
  return find_message(static_cast<const Named*>(nullptr), ask);
}

template <typename A, typename B>
struct IsSame {
  static constexpr bool value = false;
};

template <typename A>
struct IsSame<A, A> {
  static constexpr bool value = true;
};

template <typename Wanted>
struct AskForId {
  uint8_t id = 0;
  template <typename Message>
  constexpr bool operator()(uint8_t its_id, const Message& /*message*/) {
    if (IsSame<Message, Wanted>::value) id = its_id;
    return IsSame<Message, Wanted>::value;
  }
};

/// The id of a message in a collection; 255 is no id of any collection and says that it is not there.
template <typename Named, typename Message>
constexpr uint8_t id_of() {
  AskForId<Message> ask;
  return find_message<Named>(ask) ? ask.id : uint8_t{255};
}

struct AskForLength {
  Envelope envelope;
  uint8_t wanted;
  uint8_t length;
  template <typename Message>
  constexpr bool operator()(uint8_t id, const Message& /*message*/) {
    if (id == wanted) length = frame_length<Message>(envelope);
    return id == wanted;
  }
};

/// Length of the frame that an id announces; 0 for an id that the collection does not have.
template <typename Named>
constexpr uint8_t frame_length_of(uint8_t id) {
  AskForLength ask{Named::envelope, id, 0};
  return find_message<Named>(ask) ? ask.length : uint8_t{0};
}

template <typename Named>
constexpr uint8_t longest_frame() {
  uint8_t longest = 0;
  for (uint8_t id = 0; id < Named::count; ++id) {
    const uint8_t length = frame_length_of<Named>(id);
    if (length > longest) longest = length;
  }
  return longest;
}

}  // namespace protocol
}  // namespace verisim
