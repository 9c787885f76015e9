#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <random>
#include <string_view>
#include <tuple>
#include <type_traits>

#include "vehicle_agent/mavlink/codec.h"

namespace soffit::mavlink {

/// Visitor that fills every field of a message with something that a text format keeps exactly.
struct RandomFiller {
  std::mt19937_64& random;

  void Extensions() {}
  template <class T>
  void operator()(std::string_view, T& value) {
    Fill(value);
  }
  template <class T, std::size_t N>
  void Fill(std::array<T, N>& values) {
    for (T& value : values) Fill(value);
  }
  void Fill(float& value) {
    value = static_cast<float>(static_cast<int>(random() % 2000001) - 1000000) / 64.0F;
  }
  void Fill(char& value) { value = static_cast<char>('A' + random() % 26); }
  template <class T>
  requires std::is_integral_v<T>
  void Fill(T& value) { value = static_cast<T>(random()); }
};

template <class Message>
Message RandomMessage(std::mt19937_64& random) {
  Message message;
  Message::Visit(message, RandomFiller{random});
  return message;
}

/// Calls `visit(std::type_identity<Message>{})` for every message type.
template <class Visit>
void ForEachMessageType(Visit&& visit) {
  [&]<class... Messages>(std::type_identity<std::tuple<Messages...>>) {
    (visit(std::type_identity<Messages>{}), ...);
  }(std::type_identity<AllMessages>{});
}

}  // namespace soffit::mavlink
