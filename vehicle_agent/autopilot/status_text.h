#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "vehicle_agent/mavlink/codec.h"

namespace soffit {

/// A line for the pilot's ground station: one message, or numbered parts of one text when it is longer than
/// 50 bytes.
/// @param id  Differs for texts that follow each other; not 0.
inline std::vector<mavlink::Statustext> MakeStatusTexts(const std::string& text, std::uint8_t severity,
                                                        std::uint16_t id) {
  constexpr std::size_t kPart = 50;
  std::vector<mavlink::Statustext> parts;
  for (std::size_t at = 0; at < text.size(); at += kPart) {
    mavlink::Statustext part;
    part.severity = severity;
    part.text = mavlink::ToTextField<kPart>(std::string_view(text).substr(at));
    part.id = text.size() > kPart ? id : std::uint16_t{0};
    part.chunk_seq = static_cast<std::uint8_t>(at / kPart);
    parts.push_back(part);
  }
  // A text ends with the part that is not full: one of whole parts ends with an empty one.
  if (text.size() > kPart && text.size() % kPart == 0) {
    parts.push_back({severity, {}, id, static_cast<std::uint8_t>(text.size() / kPart)});
  }
  return parts;
}

}  // namespace soffit
