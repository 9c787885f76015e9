#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "shared/result/result.h"

namespace soffit {

/// A type of the wire contract: as much of IDL as idl/ is written in (modules, final structures,
/// enumerations, bounded and unbounded strings and sequences, arrays).
struct IdlType {
  enum class Kind {
    kInteger,
    kUnsigned,
    kFloating,
    kBoolean,
    kOctet,
    kString,
    kEnum,
    kSequence,
    kArray,
    kStruct
  };
  struct Member {
    std::string name;
    std::shared_ptr<const IdlType> type;
    bool is_key = false;
  };
  Kind kind = Kind::kOctet;
  std::size_t size_bytes = 1;              ///< Of a number.
  std::size_t count = 0;                   ///< Of an array.
  std::shared_ptr<const IdlType> element;  ///< Of a sequence or an array.
  std::vector<std::string> enumerators;
  std::vector<Member> members;

  bool HasKey() const;
};

/// All structures of an IDL file by their full names, as DDS announces them. An error names the line.
using IdlTypes = std::map<std::string, std::shared_ptr<const IdlType>>;
Result<IdlTypes> ReadIdl(const std::string& text);

/// A serialized sample (XCDR1 of either byte order, with its encapsulation header). Long sequences of octets
/// are told by their length alone. An error when the bytes are not of that type.
Result<nlohmann::ordered_json> DecodeSample(const IdlType& type, const std::vector<std::uint8_t>& bytes);

/// The contract that this program was built with: Soffit's own types and ROS 2's.
IdlTypes WireContract();

}  // namespace soffit
