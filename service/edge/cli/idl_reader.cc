#include "service/edge/cli/idl_reader.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <cstring>
#include <stdexcept>

#include "idl_text.h"

namespace soffit {
namespace {

using nlohmann::ordered_json;
using Kind = IdlType::Kind;
using TypePtr = std::shared_ptr<const IdlType>;

constexpr std::size_t kShownOctets = 32;

class Malformed : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

// ---- IDL ----

struct Token {
  std::string text;
  int line;
};

std::vector<Token> Tokenize(const std::string& text) {
  std::vector<Token> tokens;
  const auto is_of_name = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  int line = 1;
  for (std::size_t i = 0; i < text.size();) {
    std::size_t end = i + 1;
    if (text.compare(i, 2, "//") == 0) {
      end = std::min(text.find('\n', i), text.size());
    } else if (is_of_name(text[i])) {
      while (end < text.size() && (is_of_name(text[end]) || text.compare(end, 2, "::") == 0)) {
        end += text[end] == ':' ? 2 : 1;
      }
      tokens.push_back({text.substr(i, end - i), line});
    } else if (std::isspace(static_cast<unsigned char>(text[i])) == 0) {
      tokens.push_back({text.substr(i, 1), line});
    }
    line += text[i] == '\n' ? 1 : 0;
    i = end;
  }
  return tokens;
}

class IdlParser {
 public:
  explicit IdlParser(const std::string& text) : tokens_(Tokenize(text)) {}

  IdlTypes Parse() {
    while (at_ < tokens_.size()) ParseDefinition("");
    IdlTypes structures;
    for (const auto& [name, type] : types_) {
      if (type->kind == Kind::kStruct) structures[name] = type;
    }
    return structures;
  }

 private:
  const std::string& Peek() const {
    if (at_ >= tokens_.size()) throw Malformed("the IDL ends too soon");
    return tokens_[at_].text;
  }
  std::string Take() {
    Peek();
    return tokens_[at_++].text;
  }
  int Line() const {
    Peek();
    return tokens_[at_].line;
  }
  void Take(const std::string& wanted) {
    const int line = Line();
    if (Take() != wanted)
      throw Malformed("IDL, line " + std::to_string(line) + ": '" + wanted + "' is missing");
  }
  bool TakeIf(const std::string& wanted) {
    if (Peek() != wanted) return false;
    ++at_;
    return true;
  }

  void ParseDefinition(const std::string& scope) {
    while (TakeIf("@")) Take();
    const int line = Line();
    const std::string what = Take();
    if (what == "const") {
      while (Take() != ";") continue;
      return;
    }
    const std::string name = scope + Take();
    Take("{");
    if (what == "module") {
      while (Peek() != "}") ParseDefinition(name + "::");
    } else if (what == "struct") {
      types_[name] = ParseStruct();
    } else if (what == "enum") {
      types_[name] = ParseEnum();
    } else {
      throw Malformed("IDL, line " + std::to_string(line) + ": '" + what + "' is not read");
    }
    Take("}");
    Take(";");
  }

  TypePtr ParseStruct() {
    IdlType type;
    type.kind = Kind::kStruct;
    while (Peek() != "}") {
      IdlType::Member member;
      while (TakeIf("@")) member.is_key = Take() == "key" || member.is_key;
      member.type = ParseType();
      member.name = Take();
      while (TakeIf("[")) {
        IdlType array;
        array.kind = Kind::kArray;
        array.element = member.type;
        array.count = std::stoul(Take());
        member.type = std::make_shared<IdlType>(array);
        Take("]");
      }
      Take(";");
      type.members.push_back(std::move(member));
    }
    return std::make_shared<IdlType>(type);
  }

  TypePtr ParseEnum() {
    IdlType type;
    type.kind = Kind::kEnum;
    type.size_bytes = 4;
    while (Peek() != "}") {
      type.enumerators.push_back(Take());
      TakeIf(",");
    }
    return std::make_shared<IdlType>(type);
  }

  TypePtr ParseType() {
    const int line = Line();
    IdlType type;
    std::string name = Take();
    if (name == "sequence") {
      type.kind = Kind::kSequence;
      Take("<");
      type.element = ParseType();
      if (TakeIf(",")) Take();
      Take(">");
      return std::make_shared<IdlType>(type);
    }
    if (name == "string") {
      type.kind = Kind::kString;
      if (TakeIf("<")) {
        Take();
        Take(">");
      }
      return std::make_shared<IdlType>(type);
    }
    const bool is_unsigned = name == "unsigned";
    if (is_unsigned) name = Take();
    if (name == "long" && TakeIf("long")) name = "long long";
    static const std::map<std::string, std::pair<Kind, std::size_t>> kNumbers = {
        {"octet", {Kind::kOctet, 1}},    {"boolean", {Kind::kBoolean, 1}},   {"short", {Kind::kInteger, 2}},
        {"long", {Kind::kInteger, 4}},   {"long long", {Kind::kInteger, 8}}, {"float", {Kind::kFloating, 4}},
        {"double", {Kind::kFloating, 8}}};
    const auto number = kNumbers.find(name);
    if (number != kNumbers.end()) {
      type.kind = is_unsigned ? Kind::kUnsigned : number->second.first;
      type.size_bytes = number->second.second;
      return std::make_shared<IdlType>(type);
    }
    const auto known = types_.find(name);
    if (known == types_.end())
      throw Malformed("IDL, line " + std::to_string(line) + ": the type " + name + " is not known");
    return known->second;
  }

  std::vector<Token> tokens_;
  std::size_t at_ = 0;
  IdlTypes types_;
};

// ---- Samples ----

class CdrReader {
 public:
  explicit CdrReader(const std::vector<std::uint8_t>& bytes) : bytes_(bytes) {
    if (bytes_.size() < kHeader || bytes_[0] != 0 || bytes_[1] > 1) throw Malformed("it is not plain CDR");
    is_little_ = bytes_[1] == 1;
  }

  ordered_json Read(const IdlType& type) {
    switch (type.kind) {
      case Kind::kInteger:
        return ReadInteger(type.size_bytes);
      case Kind::kUnsigned:
        return ReadUnsigned(type.size_bytes);
      case Kind::kFloating:
        return ReadFloating(type.size_bytes);
      case Kind::kBoolean:
        return ReadUnsigned(1) != 0;
      case Kind::kOctet:
        return ReadUnsigned(1);
      case Kind::kString:
        return ReadString();
      case Kind::kEnum:
        return ReadEnum(type);
      case Kind::kSequence:
        return ReadItems(*type.element, ReadUnsigned(4));
      case Kind::kArray:
        return ReadItems(*type.element, type.count);
      case Kind::kStruct:
        break;
    }
    ordered_json all = ordered_json::object();
    for (const IdlType::Member& member : type.members) all[member.name] = Read(*member.type);
    return all;
  }

 private:
  static constexpr std::size_t kHeader = 4;

  const std::uint8_t* TakeBytes(std::size_t count) {
    if (count > bytes_.size() - at_) throw Malformed("it ends too soon");
    const std::uint8_t* taken = bytes_.data() + at_;
    at_ += count;
    return taken;
  }
  std::uint64_t ReadUnsigned(std::size_t size) {
    at_ = std::min(kHeader + (at_ - kHeader + size - 1) / size * size, bytes_.size());
    const std::uint8_t* taken = TakeBytes(size);
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size; ++i) {
      value |= static_cast<std::uint64_t>(taken[i]) << 8 * (is_little_ ? i : size - 1 - i);
    }
    return value;
  }
  std::int64_t ReadInteger(std::size_t size) {
    const std::uint64_t value = ReadUnsigned(size);
    if (size == 2) return static_cast<std::int16_t>(value);
    if (size == 4) return static_cast<std::int32_t>(value);
    return static_cast<std::int64_t>(value);
  }
  double ReadFloating(std::size_t size) {
    const std::uint64_t value = ReadUnsigned(size);
    if (size == 4) return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(value)));
    return std::bit_cast<double>(value);
  }
  std::string ReadString() {
    const std::size_t length = ReadUnsigned(4);
    if (length == 0) throw Malformed("a string has no end");
    const std::uint8_t* taken = TakeBytes(length);
    return {reinterpret_cast<const char*>(taken), length - 1};
  }
  ordered_json ReadEnum(const IdlType& type) {
    const std::uint64_t value = ReadUnsigned(4);
    if (value < type.enumerators.size()) return type.enumerators[value];
    return value;
  }
  ordered_json ReadItems(const IdlType& element, std::size_t count) {
    if (count > bytes_.size() - at_) throw Malformed("it says that it has more items than bytes");
    if (element.kind == Kind::kOctet && count > kShownOctets) {
      TakeBytes(count);
      return std::to_string(count) + " octets";
    }
    ordered_json all = ordered_json::array();
    for (std::size_t i = 0; i < count; ++i) all.push_back(Read(element));
    return all;
  }

  const std::vector<std::uint8_t>& bytes_;
  std::size_t at_ = kHeader;
  bool is_little_ = true;
};

}  // namespace

bool IdlType::HasKey() const {
  return std::any_of(members.begin(), members.end(), [](const Member& member) { return member.is_key; });
}

Result<IdlTypes> ReadIdl(const std::string& text) try {
  return IdlParser(text).Parse();
} catch (const std::exception& problem) {
  return InvalidInput(problem.what());
}

Result<ordered_json> DecodeSample(const IdlType& type, const std::vector<std::uint8_t>& bytes) try {
  return CdrReader(bytes).Read(type);
} catch (const std::exception& problem) {
  return InvalidInput(problem.what());
}

IdlTypes WireContract() {
  IdlTypes all = ReadIdl(kSoffitIdl).value();
  all.merge(ReadIdl(kRos2Idl).value());
  return all;
}

}  // namespace soffit
